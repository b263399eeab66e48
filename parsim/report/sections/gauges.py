"""Water levels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.report.curves import LINES, WATER, figure
from parsim.report.measures import columns
from parsim.report.page import section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page

_TIMES = 5  # of the run, in long sections


def parts(page: Page) -> str:
    """Their curves, and long sections."""
    over_time = "Water level at the gauges; gaps are dry."
    along = "Water level along lines at times of the run, the last one boldest; broken: the piezometric level."
    return section(
        "Gauges",
        page.figure("gauges", gauges(page.run), "Curves of water level at the gauges.", over_time),
        page.figure("levels", levels(page.run), "Long sections of the water level.", along),
    )


def gauges(run: Run) -> Figure | None:
    """Water level over time at each gauge."""
    series = columns(run, "gauges")
    if series is None:
        return None
    drawn, axes = figure()
    names = list(dict.fromkeys(series["gauge"].tolist()))
    for number, name in enumerate(names):
        here = series["gauge"] == name
        label = f"{name} (x = {series['x'][here][0]:g} m)"
        axes[0, 0].plot(series["time"][here], series["level"][here], LINES[number // 5 % 4], linewidth=1.4, label=label)
    axes[0, 0].set_xlabel("time (s)")
    axes[0, 0].set_ylabel("water level z (m)")
    axes[0, 0].legend(fontsize=7, frameon=False, ncols=2)
    return drawn


def levels(run: Run) -> Figure | None:
    """Long section along each line at `_TIMES` times of the run."""
    series = columns(run, "levels")
    if series is None:
        return None
    names, times = list(dict.fromkeys(series["line"].tolist())), np.unique(series["time"])
    shown = times[np.linspace(0, times.size - 1, min(_TIMES, times.size)).round().astype(int)]
    drawn, axes = figure(len(names), 1, 2.4)
    for each, name in zip(axes[:, 0], names, strict=True):
        for number, time in enumerate(shown, 1):
            here = (series["line"] == name) & (series["time"] == time)
            width, share = 0.6 + number / shown.size, number / shown.size
            given = {"color": WATER, "linewidth": width, "alpha": share}
            each.plot(series["distance"][here], series["level"][here], label=f"t = {time:.4g} s", **given)
            each.plot(series["distance"][here], series["piezometric"][here], "--", **given)
        each.set_xlabel(f"distance along {name} (m)")
        each.set_ylabel("z (m)")
        each.legend(fontsize=7, frameon=False, ncols=3)
    return drawn
