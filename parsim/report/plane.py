"""Pictures of two-dimensional runs: particles coloured by pressure and by speed, bodies as outlines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from parsim.report.measures import MANY
from parsim.report.scene import load

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from parsim.output.reader import Run

WIDTH = 9.0  # inches


def snapshot(run: Run, frame: int, kinds: Sequence[str] = ("pressure", "speed"), top: float | None = None) -> Figure:
    """A figure of one frame, one picture for each of ``kinds``; ``top`` ends the colour scale, by default its own."""
    scene, water = load(run, frame), run.water(frame)
    low, high = scene.tank
    shape = (high[2] - low[2]) / (high[0] - low[0])
    beside = shape > 0.6
    rows, across = (1, len(kinds)) if beside else (len(kinds), 1)
    width = WIDTH / across
    drawn = Figure(figsize=(WIDTH, rows * (width * shape * 0.85 + 0.5)), layout="constrained")
    for axes, kind in zip(drawn.subplots(rows, across, squeeze=False).flat, kinds, strict=True):
        values, label = _coloured(water, kind)
        size = (0.8 * width * 72 * scene.spacing / (high[0] - low[0])) ** 2
        dots = axes.scatter(
            *scene.water[:, [0, 2]].T,
            s=size,
            c=values,
            cmap="turbo" if kind == "speed" else "viridis",
            vmin=0,
            vmax=top or scale(water, kind),
            linewidths=0,
        )
        drawn.colorbar(dots, ax=axes, label=label, shrink=0.8)
        _frame(axes, scene)
    return drawn


def scale(water: Mapping[str, Any], kind: str) -> float:
    """A value that all but the most extreme particles stay below."""
    values, _ = _coloured(water, kind)
    return max(np.nanpercentile(values, 99.5), 1e-12) if len(values) else 1.0


def _coloured(water, kind):
    if kind == "pressure":
        return water["pressure"] / 1000, "pressure (kPa)"
    u, v, w = water["velocity"].T
    return np.sqrt(u * u + v * v + w * w), "speed (m/s)"


def _frame(axes, scene):
    """Bodies, gate and tank."""
    low, high = scene.tank
    axes.add_collection(
        PolyCollection(
            scene.points[scene.quads][..., [0, 2]],
            facecolors=scene.colours[scene.body],
            edgecolors="#3a1d10",
            linewidths=1,
        )
    )
    for body in np.unique(scene.body) if len(scene.names) < MANY else ():
        x, _, z = scene.position[body]
        axes.text(x, z, scene.names[body], ha="center", va="center", fontsize=8, fontweight="bold")
    if scene.gate:
        (x0, _, z0), (x1, _, z1) = scene.gate
        axes.fill([x0, x1, x1, x0], [z0, z0, z1, z1], color="#6b7280", alpha=0.8)
    axes.plot([low[0], low[0], high[0], high[0]], [high[2], low[2], low[2], high[2]], color="#1f2933", linewidth=1)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[2], high[2])
    axes.set_aspect("equal")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("z (m)")
