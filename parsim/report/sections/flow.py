"""What flows through a channel, in at an inlet and out at an outlet; the ice that comes and goes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.report.curves import ACCENT, FAINT, INK, WATER, figure
from parsim.report.measures import columns
from parsim.report.page import listing, section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page


def parts(page: Page) -> str:
    """Their curves."""
    return section(
        "Flow",
        listing(lines(page.run)),
        page.figure(
            "openings",
            openings(page.run),
            "Curves of discharge and level at inlet and outlet.",
            "What comes in as asked for, what goes out as a running mean, and the levels that both hold.",
        ),
        page.figure(
            "channel",
            channel(page.run),
            "Curves of the discharge through the channel and of its energy slope.",
            "Discharge of the water, and the slope that drives all that is in the channel.",
        ),
        page.figure(
            "ice",
            ice(page.run),
            "Curves of the ice that has come in, is inside and has gone out.",
            "Ice through inlet and outlet; below, for how long no room was found for a floe that was due.",
        ),
    )


def lines(run: Run) -> list[str]:
    """The account of water and ice, for the summary."""
    told, water, floes = [], columns(run, "openings"), columns(run, "ice")
    if water is not None:
        off = int(water["balance"][-1] - water["balance"][0])
        came, left = int(water["let_in"][-1]), int(water["let_out"][-1])
        told.append(f"{came} particles came in, {left} went out; the account is off by {off}.")
    if floes is not None:
        end = {name: values[-1] for name, values in floes.items()}
        told.append(
            f"{int(end['let_in'])} floes came in, {int(end['out'])} went out, {int(end['inside'])} are inside; the way "
            f"in was blocked for {end['blocked']:.3g} s, {int(end['due'])} were due at the end."
        )
    return told


def openings(run: Run) -> Figure | None:
    """Discharges and levels at inlet and outlet over time."""
    sides = (("in", "inlet", WATER), ("out", "outlet", ACCENT))
    rows = (("discharge", "discharge (m3/s)"), ("level", "level z (m)"))
    return _over_time(
        columns(run, "openings"), {unit: [(f"{name}_{s}", label, c) for s, label, c in sides] for name, unit in rows}
    )


def channel(run: Run) -> Figure | None:
    """Discharge and energy slope of a channel that repeats, over time."""
    flows = [("discharge", "water", WATER), ("wanted", "asked for", FAINT), ("ice", "ice", INK)]
    slope = [("energy_slope", "energy slope", ACCENT)]
    return _over_time(columns(run, "channel"), {"discharge (m3/s)": flows, "energy slope": slope})


def ice(run: Run) -> Figure | None:
    """Volumes of ice in, out and inside, and how long the way in was blocked, over time."""
    volumes = [(f"volume_{name}", name, colour) for name, colour in (("in", WATER), ("inside", INK), ("out", ACCENT))]
    blocked = [("blocked", "blocked", ACCENT)]
    return _over_time(columns(run, "ice"), {"ice (m3)": volumes, "blocked (s)": blocked})


def _over_time(series, panels):
    """Curves over time: {label of a panel: (column, name, colour) of each of its curves}; None without a series."""
    if series is None:
        return None
    drawn, axes = figure(len(panels), height=2.4, sharex=True)
    for each, (label, curves) in zip(axes[:, 0], panels.items(), strict=True):
        for column, name, colour in curves:
            if np.isfinite(series[column]).any():
                each.plot(series["time"], series[column], color=colour, linewidth=1.4, label=name)
        each.set_ylabel(label)
    axes[0, 0].legend(fontsize=8, frameon=False)
    axes[-1, 0].set_xlabel("time (s)")
    return drawn
