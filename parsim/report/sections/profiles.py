"""The water's surface along the tank."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.report.curves import WATER, figure
from parsim.report.measures import asked, moments, wet
from parsim.report.page import section
from parsim.report.scene import load

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page
    from parsim.report.scene import Scene

DETACHED = 3


def parts(page: Page) -> str:
    """The profiles at `report.profiles`."""
    frames = moments(page.run.times("water"), asked(page.run, "profiles", ()))
    return section(
        "Water profile",
        page.figure(
            "profiles",
            profiles(page.run, frames) if frames and wet(page.run) else None,
            "Surface height along the tank at some times.",
            "Highest connected water across the tank, splash left out, in the frames nearest to the quoted times; "
            "bodies in their places. The line is the free surface and stops where bodies cover it.",
        ),
    )


def covered(position: np.ndarray, scene: Scene) -> np.ndarray:
    """Which of the points (n, 3) have a body over them: bool (n,)."""
    found = np.zeros(len(position), bool)
    for face in scene.points[scene.quads]:
        near = np.flatnonzero(
            ((position[:, :2] >= face[:, :2].min(0)) & (position[:, :2] <= face[:, :2].max(0))).all(1)
            & (position[:, 2] < face[:, 2].max())
        )
        edge, to = np.roll(face, -1, 0) - face, position[near, None, :2] - face[None, :, :2]
        side = edge[:, 0] * to[..., 1] - edge[:, 1] * to[..., 0]
        found[near] |= (side >= 0).all(1) | (side <= 0).all(1)
    return found


def profile(
    water: Mapping[str, Any], spacing: float, low: float, high: float, left_out: np.ndarray | bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Surface height (m) of connected water in bins of x one spacing wide: (middles, heights), NaN where there is none.

    `left_out` (n,) bool are particles that do not count.
    """
    edges = np.linspace(low, high, max(2, round((high - low) / spacing) + 1))
    heights = np.full(len(edges) - 1, -np.inf)
    counted = (water["class"] < DETACHED) & ~np.asarray(left_out)
    x, z = water["position"][counted, 0], water["position"][counted, 2]
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(heights) - 1)
    np.maximum.at(heights, place, z + spacing / 2)
    return (edges[1:] + edges[:-1]) / 2, np.where(np.isfinite(heights), heights, np.nan)


def profiles(run: Run, frames: Sequence[int]) -> Figure:
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
