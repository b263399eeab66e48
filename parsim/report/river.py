"""Pictures of a river with ice: plan, long section, speed over distance and time, forces on piers, balance."""

from __future__ import annotations

from itertools import cycle, product
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from parsim.report.curves import ACCENT, FAINT, INK, LINES, WATER, figure
from parsim.river.piers import PERCENTS, WINDOWS, percentiles
from parsim.river.profiles import across
from parsim.river.verdicts import outlines

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from parsim.river.reader import River

ICE, BED, MOST = "#8fb8d6", "#a58b6f", 6  # colours; piers shown


def plan(river: River, time: float) -> Figure | None:
    """Floes coloured by their speed, and the thickness of the jam and the concentration, near a time, s."""
    if river.planar or not river.loose.any():
        return None
    low, high = river.case.box.min, river.case.box.max
    shape = (high[1] - low[1]) / (high[0] - low[0])
    drawn = Figure(figsize=(9, 3 * (9 * 0.82 * shape + 0.45)), layout="constrained")
    top, middle, bottom = drawn.subplots(3, 1, sharex=True)
    frame = river.run.nearest(time, "bodies")
    bodies, around = river.run.bodies(frame), outlines(river, frame)
    floes = [k for k in around if river.loose[k]]
    speed = np.linalg.norm(bodies["velocity"], axis=1)
    shifts = [(a * river.case.box.size[0], b * river.case.box.size[1]) for a, b in _images(river)]
    drawn_floes = [around[k] + shift for shift in shifts for k in floes]  # at sides that repeat, on both
    patches = PolyCollection(drawn_floes, cmap="turbo", edgecolors=INK, linewidths=0.4)
    patches.set_array(np.tile(speed[floes], len(shifts)))
    patches.set_clim(0.0, max([1.2 * river.drift, *speed[floes], 0.0]) or 1.0)
    top.add_collection(patches)
    drawn.colorbar(patches, ax=top, label="speed (m/s)")
    concentration, jam = (each[river.run.nearest(time)] for each in (river.fields.concentration, river.fields.jam))
    maps = (
        (middle, concentration, "concentration", "Blues", 1.0),
        (bottom, jam, "jam thickness (m)", "viridis", np.nanmax(jam, initial=river.floe)),
    )
    for axes, found, label, colours, most in maps:
        values = np.ma.masked_invalid(found)
        extent = (low[0], high[0], low[1], high[1])
        picture = axes.imshow(
            values.T, origin="lower", extent=extent, cmap=colours, norm=Normalize(0.0, most), interpolation="nearest"
        )
        drawn.colorbar(picture, ax=axes, label=label)
    for axes in (top, middle, bottom):
        axes.add_collection(PolyCollection([around[k] for k in around if not river.loose[k]], facecolors=INK))
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", ylabel="y (m)")
        for x in river.measure.control.values():
            axes.axvline(x, color=ACCENT, linewidth=1, linestyle="--")
    top.set_title(f"t = {bodies['time']:.3f} s", fontsize=9, loc="left")
    bottom.set_xlabel("x (m)")
    return drawn


def _images(river):
    """Where a plan that repeats is seen: (0, 0) and what is beside it, in lengths and widths of the box."""
    each = [(0, -1, 1) if np.isfinite(period) else (0,) for period in river.period]
    return [*product(*each)]


def long_section(river: River, time: float) -> Figure | None:
    """Bed, piezometric level, ice and velocities along x, of the window that ends at a time, s."""
    along = river.along(time)
    x = along["x"]
    if not np.isfinite(along["level"]).any():
        return None
    drawn, axes = figure(2, 1, 2.6, sharex=True)
    top, bottom = axes[:, 0]
    bed = along["bed"]
    least = np.nanmin(bed)
    top.fill_between(x, least - 0.05 * (np.nanmax(along["level_90"]) - least), bed, color=BED, linewidth=0)
    top.fill_between(x, bed, np.fmin(along["water_top"], along["level"]), color=WATER, alpha=0.2, linewidth=0)
    low, high, width = along["ice_low"], along["ice_high"], river.columns.step[0]
    shades = [(ICE, 0.2 + 0.8 * share) for share in np.clip(along["concentration"], 0.0, 1.0)]
    top.bar(x, high - low, width, low, color=shades, linewidth=0)
    top.fill_between([], [], color=ICE, linewidth=0, label="ice, its inner 90 %, paler where it covers less")
    top.fill_between(x, along["level_10"], along["level_90"], color=WATER, alpha=0.35, linewidth=0)
    top.plot(x, along["level"], color=WATER, label="piezometric level, with 10 to 90 % across")
    if np.isfinite(along["rise"]).any():
        top.plot(x, along["level"] - along["rise"], color=INK, linewidth=1, linestyle="--", label="level before")
    top.plot(x, along["head"], color=ACCENT, linewidth=1, linestyle="-.", label="energy head")
    top.set_ylabel("z (m)")
    top.set_ylim(least - 0.05 * (np.nanmax(along["head"]) - least), None)
    drawn.suptitle(f"mean of the {river.window:.3g} s before t = {time:.3f} s", fontsize=9, x=0.07, ha="left")
    bottom.fill_between(x, along["velocity_10"], along["velocity_90"], color=WATER, alpha=0.25, linewidth=0)
    bottom.plot(x, along["velocity"], color=WATER, label="water, with 10 to 90 % across")
    bottom.plot(x, along["ice_speed"], color=ACCENT, marker=".", markersize=3, label="ice")
    bottom.set(ylabel="velocity (m/s)", xlabel="x (m)", xlim=(river.case.box.min[0], river.case.box.max[0]))
    bottom.set_ylim(min(0.0, *bottom.get_ylim()), None)
    for each in (top, bottom):
        each.legend(
            fontsize=7, frameon=False, ncols=4, columnspacing=1.0, loc="lower right", bbox_to_anchor=(1.0, 0.99)
        )
    return drawn


def time_distance(river: River) -> Figure | None:
    """Speed of the ice over distance and time: where a jam's front is, and when."""
    fields = river.fields
    if not np.isfinite(fields.speed).any() or len(fields.time) < 2:
        return None
    values = np.stack([across(each).mean for each in fields.speed])
    drawn, axes = figure(1, 1, 3.8)
    axes = axes[0, 0]
    axes.grid(False)
    most = max(1.2 * river.drift, np.nanpercentile(values, 99.0), 1e-12)
    picture = axes.pcolormesh(
        river.columns.x, fields.time, np.ma.masked_invalid(values), cmap="turbo", vmin=0.0, vmax=most, shading="nearest"
    )
    drawn.colorbar(picture, ax=axes, label="speed of the ice (m/s)")
    for name, x in river.measure.control.items():
        axes.axvline(x, color=INK, linewidth=1, linestyle="--")
        axes.text(x, fields.time[-1], f" {name}", fontsize=8, va="top")
    axes.set(xlabel="x (m)", ylabel="time (s)")
    return drawn


def pier_forces(river: River) -> Figure | None:
    """Force along x on the piers with the largest, by water and by ice, means and extremes, and its percentiles."""
    names = [river.run.body_names[k] for k in river.piers]
    told = {
        name: [peaks for kind in ("water", "contact") if (peaks := river.peaks(name, kind, "fx"))] for name in names
    }
    told = {name: both for name, both in told.items() if both}
    if not told:
        return None
    largest = sorted(told, key=lambda name: -max(percentiles(peaks, (0.0,))[0, 0] for peaks in told[name]))[:MOST]
    drawn, axes = figure(len(largest), 2, 2.0, width_ratios=(3, 1), sharex="col")
    for (left, right), name in zip(axes, [name for name in told if name in largest], strict=True):
        for peaks, colour, label in zip(told[name], (WATER, ACCENT), ("water", "ice"), strict=True):
            left.fill_between(peaks.time, peaks.least, peaks.largest, color=colour, alpha=0.3, linewidth=0)
            left.plot(peaks.time, peaks.impulse / peaks.span, color=colour, linewidth=1, label=label)
            _bars(right, percentiles(peaks), colour)
        left.set_ylabel(f"{name} fx (N)", fontsize=8)
    axes[0, 0].legend(fontsize=7, frameon=False)
    axes[-1, 0].set_xlabel("time (s)")
    axes[-1, 1].set_xticks(range(len(WINDOWS)), [f"{1000 * w:g} ms" for w in WINDOWS])
    axes[-1, 1].set(xlabel="mean over", xlim=(-0.5, len(WINDOWS) - 0.5))
    return drawn


def _bars(axes: Axes, found: np.ndarray, colour: str) -> None:
    """The percentiles of each window as ticks on a line, the maximum as a dot."""
    shift = -0.12 if colour == WATER else 0.12
    for k, values in enumerate(found):
        axes.plot([k + shift] * len(values), values, color=colour, linewidth=1, marker="_", markersize=9)
        axes.plot(k + shift, values[PERCENTS.index(100.0)], color=colour, marker="o", markersize=4)


def balance(river: River) -> Figure | None:
    """Ice in the box and in the reach, and what has passed each control plane, over time."""
    if not river.loose.any():
        return None
    time = river.tracks.time
    drawn, axes = figure()
    axes = axes[0, 0]
    axes.plot(time, river.stored(), color=INK, label="in the box")
    axes.plot(time, river.stored(river.reach), color=FAINT, label="in the reach")
    for (name, x), style in zip(river.measure.control.items(), cycle(LINES), strict=False):
        axes.plot(time, river.passed(x), style, color=ACCENT, label=f"passed {name}")
    axes.set(xlabel="time (s)", ylabel="ice (m3)")
    axes.set_ylim(min(0.0, *axes.get_ylim()), None)
    axes.legend(fontsize=7, frameon=False, ncols=4)
    return drawn
