"""The budget of energy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.report.curves import ACCENT, INK, figure
from parsim.report.measures import columns, flows_through, percent
from parsim.report.page import section

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page

NOT_ENERGY = {"step", "time", "dt"}


def parts(page: Page) -> str:
    """Its curves."""
    return section(
        "Energy",
        page.figure(
            "energy",
            energy(page.run),
            "Curves of the parts of the energy over time.",
            "All parts of the energy and their sum; below, what was created: positive is energy from nothing, "
            "negative is dissipation. W is the work done from outside."
            + " What water brings in and takes out is not counted: the sum says nothing here."
            * flows_through(page.run),
        ),
    )


def lines(run: Run) -> list[str]:
    """What was created at most, for the summary."""
    series = columns(run, "energy")
    if series is None or flows_through(run):
        return []
    created = np.max(energy_created(series)[1], initial=0.0)
    return [f"Energy created, at most: {percent(created)} of that at the start."]


def energy_created(energy: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """(E - E0 - work done from outside) / E0 at each time from t = 0 on: (times, share)."""
    later = energy["time"] >= 0
    work = sum((values[later] for name, values in energy.items() if name.startswith("work")), np.zeros(later.sum()))
    total = energy["total"][later]
    if not len(total) or total[0] == 0:
        return energy["time"][later], np.zeros_like(total)
    return energy["time"][later], (total - total[0] - (work - work[0])) / total[0]


def energy(run: Run) -> Figure | None:
    """All parts of the energy over time, and what share of it was created from nothing."""
    series = columns(run, "energy")
    if series is None:
        return None
    drawn, axes = figure(2, 1, 3.0, sharex=True, height_ratios=(2, 1))
    parts, share = axes[:, 0]
    for name in (name for name in series if name not in NOT_ENERGY | {"total"}):
        style = "--" if name.startswith(("work", "dissipated")) else "-"
        parts.plot(series["time"], series[name], style, linewidth=1.3, label=name.replace("_", " "))
    parts.plot(series["time"], series["total"], color=INK, linewidth=2.2, label="total")
    parts.set_ylabel("energy (J)")
    parts.legend(fontsize=7, frameon=False, ncols=3)
    times, created = energy_created(series)
    share.plot(times, 100 * created, color=ACCENT, linewidth=1.5)
    share.axhline(0, color=INK, linewidth=0.8)
    share.set_ylabel("(E - E0 - W) / E0 (%)")
    share.set_xlabel("time (s)")
    return drawn
