"""Water levels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.report.curves import LINES, figure
from parsim.report.measures import columns
from parsim.report.page import section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page


def parts(page: Page) -> str:
    """Their curves."""
    return section(
        "Gauges",
        page.figure(
            "gauges",
            gauges(page.run),
            "Curves of water level at the gauges.",
            "Water level at the gauges; gaps are dry.",
        ),
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
