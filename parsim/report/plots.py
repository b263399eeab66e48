"""Curves: block trajectories, water profiles, front, gauges, loads. Each returns a figure, or None without data."""

import numpy as np
from matplotlib.figure import Figure

from parsim.report.measures import body_tracks, columns, front_arrival, published
from parsim.report.scene import body_colours, load

DETACHED = 3
WATER, INK, FAINT = "#2b7bba", "#1f2933", "#9aa5b1"
LINES = ("-", "--", "-.", ":")


def figure(rows=1, across=1, height=3.4, **options):
    """A figure of the page's width and its axes, with a light grid."""
    drawn = Figure(figsize=(9, height * rows), layout="constrained")
    axes = drawn.subplots(rows, across, squeeze=False, **options)
    for each in axes.flat:
        each.grid(color="#e4e7eb", linewidth=0.7)
        each.spines[["top", "right"]].set_visible(False)
        each.tick_params(labelsize=8)
    return drawn, axes


def name_ends(axes, ends):
    """Write names right of the ends of curves, moved apart where they would overlap: ``ends`` (name, x, y, colour)."""
    low, high = axes.get_ylim()
    gap, last = 0.05 * (high - low), -np.inf
    for name, x, y, colour in sorted(ends, key=lambda end: end[2]):
        last = max(y, last + gap)
        axes.text(x, last, f" {name}", color=colour, fontsize=8, fontweight="bold", va="center")


def trajectories(run):
    """x and z of each body's centre over time, with the published largest x."""
    tracks = body_tracks(run)
    if not tracks:
        return None
    drawn, axes = figure(1, 2, 4.2)
    colours = dict(zip(tracks, body_colours(len(tracks)), strict=True))
    for each, key in zip(axes[0], "xz", strict=True):
        ends = []
        for number, (name, track) in enumerate(tracks.items()):
            each.plot(track["time"], track[key], LINES[number % 4], color=colours[name], linewidth=1.8)
            ends.append((name, track["time"][-1], track[key][-1], colours[name]))
        name_ends(each, ends)
        each.set_xlabel("time (s)")
        each.set_ylabel(f"{key.upper()} of the centre (m)")
    _published_x(axes[0, 0], run, colours)
    return drawn


def _published_x(axes, run, colours):
    """The experiments' spread as a bar at the quoted time, the published model as a cross."""
    for number in published(run):
        if number.block not in colours or number.time is None:
            continue
        style = {"color": colours[number.block], "zorder": 5}
        if number.low is not None and number.high is not None:
            middle, half = (number.low + number.high) / 2, (number.high - number.low) / 2
            label = f"{number.block} {number.quantity}, experiments"
            axes.errorbar(number.time, middle, half, fmt="s", capsize=6, elinewidth=4, markersize=6,
                          markeredgecolor=INK, label=label, **style)  # fmt: skip
        if number.model is not None:
            label = f"{number.block} {number.quantity}, published model"
            axes.plot(number.time, number.model, "X", markersize=9, markeredgecolor=INK, label=label, **style)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=7, frameon=False, loc="upper left")


def covered(position, scene):
    """Which of the points (n, 3) have a body over them: bool (n,)."""
    found = np.zeros(len(position), bool)
    for face in scene.points[scene.quads]:
        near = np.flatnonzero(((position[:, :2] >= face[:, :2].min(0)) & (position[:, :2] <= face[:, :2].max(0))).all(1)
                              & (position[:, 2] < face[:, 2].max()))
        edge, to = np.roll(face, -1, 0) - face, position[near, None, :2] - face[None, :, :2]
        side = edge[:, 0] * to[..., 1] - edge[:, 1] * to[..., 0]
        found[near] |= (side >= 0).all(1) | (side <= 0).all(1)
    return found


def profile(water, spacing, low, high, left_out=False):
    """Surface height (m) of connected water in bins of x one spacing wide: (middles, heights), NaN where there is none.

    `left_out` (n,) bool are particles that do not count.
    """
    edges = np.linspace(low, high, max(2, round((high - low) / spacing) + 1))
    heights = np.full(len(edges) - 1, -np.inf)
    counted = (water["class"] != DETACHED) & ~np.asarray(left_out)
    x, z = water["position"][counted, 0], water["position"][counted, 2]
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(heights) - 1)
    np.maximum.at(heights, place, z + spacing / 2)
    return (edges[1:] + edges[:-1]) / 2, np.where(np.isfinite(heights), heights, np.nan)


def profiles(run, frames):
    """The water's profile along the tank in the given frames, with the bodies' outlines."""
    drawn, axes = figure(len(frames), 1, 2.5, sharex=True)
    low, high = run.case["box"]["min"], run.case["box"]["max"]
    for each, frame in zip(axes[:, 0], frames, strict=True):
        water, scene = run.water(frame), load(run, frame)
        middles, heights = profile(water, run.case["spacing"], low[0], high[0])
        each.fill_between(middles, low[2], heights, color=WATER, alpha=0.25, linewidth=0)
        under = covered(water["position"], scene)  # its top is no surface: the line stops at bodies
        each.plot(*profile(water, run.case["spacing"], low[0], high[0], under), color=WATER, linewidth=1.6)
        for face, owner in zip(scene.quads, scene.body, strict=True):
            each.fill(scene.points[face, 0], scene.points[face, 2], color=scene.colours[owner], alpha=0.5, linewidth=0)
        each.set_title(f"t = {water['time']:.3f} s", fontsize=9, loc="left")
        each.set_ylabel("z (m)")
        each.set_xlim(low[0], high[0])
        each.set_ylim(low[2], None)
    axes[-1, 0].set_xlabel("x (m)")
    return drawn


def front(run):
    """The water's front over time and when it reaches the end wall."""
    series = columns(run, "front")
    if series is None:
        return None
    drawn, axes = figure()
    axes = axes[0, 0]
    axes.plot(series["time"], series["x"], color=WATER, linewidth=1.8)
    axes.axhline(run.case["box"]["max"][0], color=INK, linewidth=1.2)
    arrival = front_arrival(run)
    if arrival is not None:
        axes.axvline(arrival, color=WATER, linestyle="--", label=f"arrives at {arrival:.3f} s")
    for number in published(run):
        if number.quantity.startswith("front") and number.low is not None:
            axes.axvspan(number.low - 0.003, number.high + 0.003, color="#e07b39", alpha=0.6,
                         label=f"published: {number.low:g} s")  # fmt: skip
    axes.set_xlabel("time (s)")
    axes.set_ylabel("front x (m)")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8, frameon=False)
    return drawn


def gauges(run):
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


def loads(run):
    """Forces along x and z on each body, by kind."""
    series = columns(run, "loads")
    if series is None:
        return None
    names = list(dict.fromkeys(series["body"].tolist()))
    drawn, axes = figure(len(names), 2, 1.7, sharex=True)
    colours = {"water": WATER, "contact": "#c8553d", "gravity": FAINT}
    for row, name in zip(axes, names, strict=True):
        for each, force in zip(row, ("fx", "fz"), strict=True):
            for kind, colour in colours.items():
                here = (series["body"] == name) & (series["kind"] == kind)
                each.plot(series["time"][here], series[force][here], color=colour, linewidth=1.1, label=kind)
            each.set_ylabel(f"{name} {force} (N)", fontsize=8)
    axes[0, 0].legend(fontsize=7, frameon=False, ncols=3)
    for each in axes[-1]:
        each.set_xlabel("time (s)")
    return drawn
