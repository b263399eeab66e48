"""Water on a grid of columns: where it begins and ends, its piezometric level and its velocity."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.river.columns import means

if TYPE_CHECKING:
    from collections.abc import Mapping

    from parsim.river.columns import Columns

CORE = 0.2, 0.8  # of the depth of a column, between which its level is found: near neither bed nor surface
DETACHED = 3  # class of splash in frames; that of water shut in is above
WINDOW = 5.0  # times sqrt(H/g), over which levels are averaged


class Water(NamedTuple):
    """Of each column (nx, ny), NaN where there is no water: bottom and top of it, m; piezometric level, m; velocity
    along x, m/s."""

    bottom: np.ndarray
    top: np.ndarray
    level: np.ndarray
    velocity: np.ndarray


def water_of(frame: Mapping[str, np.ndarray], columns: Columns, spacing: float, weight: float) -> Water:
    """`Water` of a frame's particles: position (n, 3), m, velocity (n, 3), m/s, pressure (n,), Pa, class (n,).

    spacing: of particles, m; weight: of the water along z, N/m3. The level is the mean of z + p/weight in CORE of the
    depth: it holds under ice too, and is finer than a spacing. Splash is left out.
    """
    kept = frame["class"] < DETACHED
    (x, y, z), u, p = frame["position"][kept].T, frame["velocity"][kept, 0], frame["pressure"][kept]
    number = columns.numbers(x, y)
    inside = number >= 0
    number, z, u, p = number[inside], z[inside], u[inside], p[inside]
    count = columns.shape[0] * columns.shape[1]
    bottom, top = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(bottom, number, z - 0.5 * spacing)
    np.maximum.at(top, number, z + 0.5 * spacing)
    share = (z - bottom[number]) / (top[number] - bottom[number])
    core = (share >= CORE[0]) & (share <= CORE[1])
    level = means(number[core], z[core] + p[core] / weight, np.ones(core.sum()), columns)
    velocity = means(number, u, np.ones(len(u)), columns)
    bottom[np.isinf(bottom)], top[np.isinf(top)] = np.nan, np.nan
    return Water(columns.fold(bottom), columns.fold(top), level, velocity)


def window(depth: float, gravity: float) -> float:
    """Time, s, over which levels are averaged, for a depth, m, and gravity, m/s2."""
    return float(WINDOW * np.sqrt(depth / gravity))
