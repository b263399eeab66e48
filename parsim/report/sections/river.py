"""A river with ice: levels, ice, jam, blocks at a cover, piers; only for cases with a table `measure`."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from parsim.errors import InputError
from parsim.output.frames import write_text
from parsim.report.measures import MANY, asked, columns, moments
from parsim.report.page import listing, section, table
from parsim.report.river import balance, long_section, pier_forces, plan, time_distance
from parsim.river import tables
from parsim.river.arches import arches, at_pier
from parsim.river.reader import river_of
from parsim.river.verdicts import blocks, pairs, verdict

if TYPE_CHECKING:
    from parsim.output.reader import Run
    from parsim.report.build import Page
    from parsim.river.reader import River
    from parsim.river.verdicts import Verdict

_LASTS = {"held": "it held", "transient": "it let go", "open": "the run ends before it is known whether it holds"}


def parts(page: Page) -> str:
    """Its pictures and tables; the tables of numbers stand beside the page as CSV."""
    run = page.run
    if not run.case.get("measure") or not len(run.times("water")):
        return ""
    try:
        river, times = river_of(run), run.times("water")
    except InputError as error:  # a file of a body or of the bed is gone, or another one
        return section("River", listing(error.messages))
    ends = [float(times[k]) for k in moments(times, asked(run, "profiles", ()))]
    icy, last = river.loose.any() and columns(run, "bodies") is not None and len(river.tracks.time) > 0, ends[-1]
    found = verdict(river) if icy else None
    told = {"river": tables.profiles_table(river, ends), "reach": tables.reach_table(river, ends)}
    told |= {"ice_balance": tables.balance_table(river)} if icy else {}
    told |= {"jam": tables.jam_table(found)} if found else {}
    told |= {"blocks": tables.blocks_table(river)} if river.measure.cover and icy else {}
    told |= {"piers": tables.piers_table(river)} if columns(run, "peaks") is not None else {}
    for name, text in told.items():
        write_text(page.folder / f"{name}.csv", text)
    return section(
        "River",
        listing([*_jam(found), *_beside_piers(river, last)]),
        _reach(river, ends),
        _blocks(river) if icy else "",
        page.figure(
            "river_section",
            long_section(river, last),
            "Long section of bed, level, ice and velocities.",
            "Long section: means across the channel.",
        ),
        page.figure(
            "river_plan",
            plan(river, last),
            "Plan of the floes, their concentration and thickness.",
            "Floes by speed, concentration and jam thickness; black: what is fixed, dashed: control planes.",
        ),
        page.figure(
            "river_speed",
            time_distance(river),
            "Speed of the ice over distance and time.",
            "Speed of the ice, mean across the channel; white: no ice.",
        ),
        page.figure(
            "river_balance",
            balance(river) if icy else None,
            "Curves of the ice in the box and through planes.",
            "Ice that is there, and that has passed.",
        ),
        page.figure(
            "river_piers",
            pier_forces(river),
            "Curves of the forces on piers with their percentiles.",
            "Forces on piers along the flow: means of the rows, and from the least to the largest of all steps. Right: "
            "maximum (dot), 99.9, 99 and 95 % of the amounts of running means; of 0 ms those of the rows' extremes; "
            "windows shorter than the rows are left out, give output.series.",
        ),
        f"<p>Beside this page: {', '.join(f'{name}.csv' for name in told)}.</p>",
    )


def lines(run: Run) -> list[str]:
    """The jam, for the summary."""
    if not (run.case.get("measure") or {}).get("jam") or columns(run, "bodies") is None:
        return []
    try:
        return _jam(verdict(river_of(run))) if len(run.times("water")) else []
    except InputError:  # the section tells of it
        return []


def _jam(found: Verdict | None) -> list[str]:
    if found is None:
        return []
    if not np.isfinite(found.window):
        return ["Whether there is a jam is not known: before it no water flows down the reach; see measure.before."]
    if found.jam is None and found.kind == "unknown":
        return [f"Whether there is a jam is not known: the run is shorter than the {found.window:.4g} s that make one."]
    if found.jam is None:
        return ["No ice jam."]
    place = f", {found.head:.4g} to {found.toe:.4g} m" if np.isfinite(found.head) else ""
    thick = f", {found.layers:.2g} floes thick" if np.isfinite(found.layers) else ""
    return [
        f"Ice jam ({found.kind}) from {found.jam.begin:.4g} to {found.jam.end:.4g} s{place}{thick}: "
        f"{_LASTS[found.jam.lasts]}."
    ]


def _beside_piers(river: River, time: float) -> list[str]:
    """Floes at each pier, and arches between piers, at a time, s."""
    if river.planar or not river.piers or not river.loose.any():
        return []
    names, near = river.run.body_names, pairs(river, river.run.nearest(time, "bodies"))
    chains = arches(near, river.piers)
    beside = ", ".join(f"{names[k]} {at_pier(near, k)}" for k in river.piers)
    between = "; ".join(f"{names[c[0]]} to {names[c[-1]]} by {len(c) - 2} floes" for c in chains) or "none"
    return [f"Floes within half a spacing of a pier at {time:.4g} s: {beside}. Arches: {between}."]


def _reach(river: River, ends: list[float]) -> str:
    """The reach as a whole at the ends of windows, s."""
    titles = ("time (s)", "energy slope", "head loss (m)", "rise (m)", "velocity (m/s)", "concentration",
              "ice thickness (m)", "jam thickness (m)", "ice speed (m/s)")  # fmt: skip
    rows = [(time, *river.reach_means(time).values()) for time in ends]
    return table(titles, [[value if np.isfinite(value) else None for value in row] for row in rows])


def _blocks(river: River) -> str:
    found = blocks(river)
    if len(found) >= MANY:
        of = Counter((b.name, "yes" if b.critical else "no") for b in found.values())
        return table(
            ("what became of blocks", "critical", "blocks"), [(*kind, many) for kind, many in of.most_common()]
        )
    rows = [(name, b.name, b.tilt, "yes" if b.critical else "no") for name, b in found.items()]
    return table(("block", "what became of it", "largest tilt (degrees)", "critical"), rows)
