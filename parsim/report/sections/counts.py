"""The volume of the water, and particles where none may be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.report.curves import WATER, figure
from parsim.report.measures import columns, flows_through, percent, wet
from parsim.report.page import section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page

LEAKS = ("in_walls", "in_bodies", "in_gate", "lost")


def parts(page: Page) -> str:
    """Their curves."""
    return section(
        "Volume and particles",
        page.figure(
            "volume",
            volume(page.run),
            "Curves of the water's volume and of misplaced particles.",
            "Volume against its first value; particles found in walls, bodies or gate, and lost: all should stay 0.",
        ),
    )


def lines(run: Run) -> list[str]:
    """Drift and leaks, for the summary."""
    counts = columns(run, "counts")
    if counts is None or not wet(run):
        return []
    first = counts["volume"][0]
    leaks = [f"{counts[name].max()} {name.replace('_', ' ')}" for name in LEAKS if name in counts]
    volume = ""
    if first > 0 and not flows_through(run):
        volume = f"Volume within {percent(np.max(np.abs(counts['volume'] / first - 1)))} of its first value; "
    told = f"{volume}particles at most {', '.join(leaks)}."
    return [told[0].upper() + told[1:]]


def volume(run: Run) -> Figure | None:
    """The water's volume against its first value, and the counts of particles where none may be."""
    series = columns(run, "counts")
    if series is None or not wet(run):
        return None
    drawn, axes = figure(1, 2, 3.0)
    first = series["volume"][0]
    change = 100 * (series["volume"] / first - 1) if first > 0 else 1e3 * series["volume"]
    axes[0, 0].plot(series["time"], change, color=WATER, linewidth=1.6)
    axes[0, 0].set_ylabel(f"volume (%, against {first * 1e3:.4g} l)" if first > 0 else "volume (l)")
    for name in LEAKS:
        if name in series:
            axes[0, 1].step(series["time"], series[name], where="post", label=name.replace("_", " "), linewidth=1.4)
    axes[0, 1].set_ylabel("particles")
    axes[0, 1].legend(fontsize=8, frameon=False)
    for each in axes[0]:
        each.set_xlabel("time (s)")
    return drawn
