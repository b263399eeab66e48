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
    series = columns(run, "openings")
    if series is None:
        return None
    drawn, axes = figure(2, height=2.4, sharex=True)
    for row, (name, unit) in enumerate((("discharge", "discharge (m3/s)"), ("level", "level z (m)"))):
        for side, colour, label in (("in", WATER, "inlet"), ("out", ACCENT, "outlet")):
            values = series[f"{name}_{side}"]
            if np.isfinite(values).any():
                axes[row, 0].plot(series["time"], values, color=colour, linewidth=1.4, label=label)
        axes[row, 0].set_ylabel(unit)
    axes[0, 0].legend(fontsize=8, frameon=False)
    axes[1, 0].set_xlabel("time (s)")
    return drawn


def channel(run: Run) -> Figure | None:
    """Discharge and energy slope of a channel that repeats, over time."""
    series = columns(run, "channel")
    if series is None:
        return None
    drawn, axes = figure(2, height=2.4, sharex=True)
    axes[0, 0].plot(series["time"], series["discharge"], color=WATER, linewidth=1.4, label="water")
    axes[0, 0].plot(series["time"], series["wanted"], color=FAINT, linestyle="--", linewidth=1.2, label="asked for")
    if series["ice"].any():
        axes[0, 0].plot(series["time"], series["ice"], color=INK, linewidth=1.2, label="ice")
    axes[0, 0].set_ylabel("discharge (m3/s)")
    axes[0, 0].legend(fontsize=8, frameon=False)
    axes[1, 0].plot(series["time"], series["energy_slope"], color=ACCENT, linewidth=1.2)
    axes[1, 0].set_ylabel("energy slope")
    axes[1, 0].set_xlabel("time (s)")
    return drawn


def ice(run: Run) -> Figure | None:
    """Volumes of ice in, out and inside, and how long the way in was blocked, over time."""
    series = columns(run, "ice")
    if series is None:
        return None
    drawn, axes = figure(2, height=2.4, sharex=True)
    for name, colour in (("in", WATER), ("inside", INK), ("out", ACCENT)):
        axes[0, 0].plot(series["time"], series[f"volume_{name}"], color=colour, linewidth=1.4, label=name)
    axes[0, 0].set_ylabel("ice (m3)")
    axes[0, 0].legend(fontsize=8, frameon=False)
    axes[1, 0].plot(series["time"], series["blocked"], color=ACCENT, linewidth=1.4)
    axes[1, 0].set_ylabel("blocked (s)")
    axes[1, 0].set_xlabel("time (s)")
    return drawn
