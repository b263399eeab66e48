"""What acts on the bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.report.curves import ACCENT, FAINT, WATER, figure
from parsim.report.measures import MANY, columns
from parsim.report.page import section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page

MOST = 6  # of many bodies, that are shown


def parts(page: Page) -> str:
    """Its curves."""
    return section(
        "Loads on the bodies",
        page.figure(
            "loads",
            loads(page.run),
            "Curves of forces on each body.",
            f"Forces along the flow (fx) and upward (fz), as means over a step; where there are {MANY} bodies or more, "
            f"on the {MOST} with the largest by water and contacts.",
        ),
    )


def loads(run: Run) -> Figure | None:
    """Forces along x and z on each body, by kind."""
    series = columns(run, "loads")
    if series is None:
        return None
    names = _shown(series)
    drawn, axes = figure(len(names), 2, 1.7, sharex=True)
    colours = {"water": WATER, "contact": ACCENT, "gravity": FAINT}
    for row, name in zip(axes, names, strict=True):
        for each, force in zip(row, ("fx", "fz"), strict=True):
            for kind, colour in colours.items():
                here = (series["body"] == name) & (series["kind"] == kind)
                each.plot(series["time"][here], series[force][here], color=colour, linewidth=1.1, label=kind)
            each.set_ylabel(f"{name} {force} (N)", fontsize=8)
    axes[0, 0].legend(fontsize=7, frameon=False, ncols=3)
    for each in axes[-1]:
        each.set_xlabel("time (s)")
    return drawn


def _shown(series: dict[str, np.ndarray]) -> list[str]:
    """Names of the bodies, in their order; of many those on which water and contacts have had the largest forces."""
    names = list(dict.fromkeys(series["body"].tolist()))
    if len(names) < MANY:
        return names
    known, body = np.unique(series["body"], return_inverse=True)
    force, most = np.nan_to_num(np.hypot(series["fx"], series["fz"])), np.zeros(len(known))
    acts = np.isin(series["kind"], ("water", "contact"))
    np.maximum.at(most, body[acts], force[acts])
    largest = set(known[np.argsort(-most, kind="stable")[:MOST]].tolist())
    return [name for name in names if name in largest]
