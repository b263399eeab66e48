"""How far the water's front has come."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.report.curves import INK, WATER, figure
from parsim.report.measures import columns, published, wet
from parsim.report.page import section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page


def parts(page: Page) -> str:
    """The curve of the front."""
    return section(
        "Front",
        page.figure(
            "front",
            front(page.run),
            "Curve of the front's position over time.",
            f"Front of the connected water; it has arrived when two spacings from the end {end(page.run)} (black).",
        ),
    )


def lines(run: Run) -> list[str]:
    """When it arrived, for the summary."""
    arrival = front_arrival(run)
    return [] if arrival is None else [f"The front reached the end {end(run)} at {arrival:.3f} s."]


def end(run: Run) -> str:
    """What stands at the downstream end of the box, in a word."""
    side = run.case.get("box", {}).get("faces", {}).get("x_max", "wall")
    return "wall" if (side if isinstance(side, str) else side["kind"]) == "wall" else "of the box"


def front_arrival(run: Run) -> float | None:
    """Time (s) at which the front comes within two spacings of the downstream end, None if it does not or is there."""
    front = columns(run, "front")
    if front is None:
        return None
    later = front["time"] >= 0
    there = front["x"][later] >= run.case["box"]["max"][0] - 2 * run.case["spacing"]
    return float(front["time"][later][there.argmax()]) if there.any() and not there[0] else None


def front(run: Run) -> Figure | None:
    """The water's front over time and when it reaches the end wall."""
    series = columns(run, "front")
    if series is None or not wet(run):
        return None
    drawn, axes = figure()
    axes = axes[0, 0]
    axes.plot(series["time"], series["x"], color=WATER, linewidth=1.8)
    axes.axhline(run.case["box"]["max"][0], color=INK, linewidth=1.2)
    arrival = front_arrival(run)
    if arrival is not None:
        axes.axvline(arrival, color=WATER, linestyle="--", label=f"arrives at {arrival:.3f} s")
    for number in published(run):
        if number.quantity in QUANTITIES and number.low is not None and number.high is not None:
            axes.axvspan(
                number.low - 0.003,
                number.high + 0.003,
                color="#e07b39",
                alpha=0.6,
                label=f"published: {number.low:g} s",
            )
    axes.set_xlabel("time (s)")
    axes.set_ylabel("front x (m)")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8, frameon=False)
    return drawn


def _arrival(run, number):
    return front_arrival(run)


QUANTITIES = {"front arrives at the end wall": _arrival}
