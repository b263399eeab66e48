"""Budgets: energy, volume, particles where none may be, and where the time of the computer went."""

import numpy as np

from parsim.report.measures import columns, energy_created
from parsim.report.plots import FAINT, INK, WATER, figure

NOT_ENERGY = {"step", "time", "dt"}
LEAKS = ("in_walls", "in_bodies", "in_gate", "lost")


def energy(run):
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
    share.plot(times, 100 * created, color="#c8553d", linewidth=1.5)
    share.axhline(0, color=INK, linewidth=0.8)
    share.set_ylabel("(E - E0 - W) / E0 (%)")
    share.set_xlabel("time (s)")
    return drawn


def volume(run):
    """The water's volume against its first value, and the counts of particles where none may be."""
    series = columns(run, "counts")
    if series is None:
        return None
    drawn, axes = figure(1, 2, 3.0)
    first = series["volume"][0]
    axes[0, 0].plot(series["time"], 100 * (series["volume"] / first - 1), color=WATER, linewidth=1.6)
    axes[0, 0].set_ylabel(f"volume (%, against {first * 1e3:.4g} l)")
    for name in LEAKS:
        if name in series:
            axes[0, 1].step(series["time"], series[name], where="post", label=name.replace("_", " "), linewidth=1.4)
    axes[0, 1].set_ylabel("particles")
    axes[0, 1].legend(fontsize=8, frameon=False)
    for each in axes[0]:
        each.set_xlabel("time (s)")
    return drawn


def phases(run):
    """Seconds spent in each phase of the solver, longest on top."""
    spent = run.info.get("phases") or {}
    if not spent:
        return None
    names = sorted(spent, key=spent.get)
    seconds = np.array([spent[name] for name in names], float)
    drawn, axes = figure(1, 1, 0.7 + 0.27 * len(names))
    bars = axes[0, 0].barh([name.replace("_", " ") for name in names], seconds, color=FAINT)
    total = max(seconds.sum(), 1e-300)
    axes[0, 0].bar_label(bars, [f" {second / total:.1%}" for second in seconds], fontsize=8)
    axes[0, 0].set_xlabel("wall time (s)")
    return drawn
