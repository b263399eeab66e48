"""What sensors have read besides levels: pressures, forces on walls, discharges, velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.report.curves import LINES, figure
from parsim.report.measures import columns, mean_profile
from parsim.report.page import section

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page

# series, column that names the curves, what else does, what is drawn, label of the axis
_OVER_TIME = (
    ("pressures", "probe", ("filter",), "pressure", "pressure (Pa)"),
    ("forces", "patch", ("filter", "kind"), "fx", "fx (N)"),
    ("forces", "patch", ("filter", "kind"), "fz", "fz (N)"),
    ("fluxes", "section", (), "discharge", "discharge (m3/s)"),
)


def parts(page: Page) -> str:
    """Their curves, and the last velocities over the height."""
    told = "What the sensors read; velocities along plumb lines are the mean of the last tenth of the run."
    return section("Sensors", page.figure("sensors", sensors(page.run), "Curves of the sensors.", told))


def sensors(run: Run) -> Figure | None:
    """A row of axes for each quantity that was measured."""
    found = [(*each[1:], series) for each in _OVER_TIME if (series := columns(run, each[0])) is not None]
    lines = columns(run, "velocities")
    if not found and lines is None:
        return None
    drawn, axes = figure(len(found) + (lines is not None), 1, 2.4)
    for each, (name, others, quantity, label, series) in zip(axes[:, 0], found, strict=False):
        _over_time(each, series, (name, *others), quantity)
        each.set_xlabel("time (s)")
        each.set_ylabel(label)
        each.legend(fontsize=7, frameon=False, ncols=4)
    if lines is not None:
        _profiles(axes[-1, 0], lines)
    return drawn


def _over_time(axes: Axes, series: dict[str, Any], names: tuple[str, ...], quantity: str) -> None:
    """A curve for each of what the columns `names` tell apart."""
    for number, key in enumerate(dict.fromkeys(zip(*(series[k].tolist() for k in names), strict=True))):
        here = np.logical_and.reduce([series[k] == value for k, value in zip(names, key, strict=True)])
        style, label = LINES[number // 5 % 4], ", ".join(word for word in key if word != "none")
        axes.plot(series["time"][here], series[quantity][here], style, linewidth=1.2, label=label)


def _profiles(axes: Axes, series: dict[str, Any]) -> None:
    """Mean velocity downstream over height on each line, of the last tenth of the run."""
    time = series["time"]
    for name in dict.fromkeys(series["line"].tolist()):
        heights, u = mean_profile(series, name, time[-1] - 0.1 * (time[-1] - time[0]))
        axes.plot(u, heights, label=name)
    axes.set_xlabel("u (m/s)")
    axes.set_ylabel("z (m)")
    axes.legend(fontsize=7, frameon=False, ncols=4)
