"""The sections of the page: what exists is listed here, in their order.

A section is one file: `parts(page)` gives its HTML; `lines(run)`, where it has something to say in the summary, and
`QUANTITIES`, what of a run answers to the published numbers of that name.
"""

from parsim.report.sections import (
    about,
    bodies,
    counts,
    energy,
    flow,
    front,
    gauges,
    loads,
    outcome,
    pictures,
    profiles,
    published,
    river,
    sensors,
    speed,
)

SECTIONS = (
    outcome,
    river,
    published,
    pictures,
    bodies,
    profiles,
    flow,
    front,
    energy,
    counts,
    gauges,
    sensors,
    loads,
    speed,
    about,
)
