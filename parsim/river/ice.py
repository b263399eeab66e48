"""Ice on a grid of columns: concentration, thickness, porosity and speed, from `raster.Cuts` of its floes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.river.columns import sums

if TYPE_CHECKING:
    from parsim.river.columns import Columns
    from parsim.river.raster import Cuts

INNER = 0.05, 0.95  # of the ice volume in a column that lies under the lower and the upper height of a jam


def concentration(cuts: Cuts, columns: Columns) -> np.ndarray:
    """Share (nx, ny) of each column's area that floes cover; where they lie over each other it counts once."""
    (nx, ny), (px, py) = columns.shape, columns.pixels
    under = np.zeros(nx * px * ny * py)
    under[cuts.pixel] = 1.0
    return under.reshape(nx, px, ny, py).mean(axis=(1, 3))


def solid_thickness(cuts: Cuts, columns: Columns) -> np.ndarray:
    """Volume of ice in each column over its area (nx, ny), m."""
    return sums(cuts.column, cuts.side * cuts.height, columns) / np.prod(columns.pixels)


def heights(cuts: Cuts, columns: Columns, shares: tuple[float, ...] = INNER) -> np.ndarray:
    """Heights (nx, ny, shares), m, under which these shares of the ice volume in each column lie; NaN without ice."""
    found = np.full((columns.shape[0] * columns.shape[1], len(shares)), np.nan)
    order = np.lexsort((cuts.height, cuts.column))
    column, height, side = cuts.column[order], cuts.height[order], cuts.side[order]
    first, last = np.flatnonzero(np.diff(column, prepend=-1)), np.flatnonzero(np.diff(column, append=-1)) + 1
    for begin, end in zip(first, last, strict=True):
        z = height[begin:end]
        lines = -np.cumsum(side[begin:end])  # that are in ice above each cut
        under = np.concatenate([[0.0], np.cumsum(lines[:-1] * np.diff(z))])
        found[column[begin]] = np.interp(np.array(shares) * under[-1], under, z)
    return columns.fold(found)


def jam_thickness(inner: np.ndarray, floe: float) -> np.ndarray:
    """Thickness of a jam (nx, ny), m, from the `heights` of INNER (nx, ny, 2), m, and the thickness of a floe, m.

    A tenth of a floe is added, so that one flat floe has its own thickness.
    """
    return inner[..., 1] - inner[..., 0] + 0.1 * floe


def porosity(solid: np.ndarray, jam: np.ndarray) -> np.ndarray:
    """Share (..., nx, ny) of a jam's thickness that is not ice, from solid and jam thickness (..., nx, ny), m."""
    return 1.0 - solid / jam


def layers(solid: np.ndarray, floe: float) -> np.ndarray:
    """How many floes lie over each other (nx, ny), from the solid thickness (nx, ny) and that of a floe, m."""
    return solid / floe


def speed(cuts: Cuts, velocity: np.ndarray, columns: Columns) -> np.ndarray:
    """Mean velocity (nx, ny) of the ice in each column by volume, m/s, from that of the bodies (nb,); NaN without."""
    volume = sums(cuts.column, cuts.side * cuts.height, columns)
    total = sums(cuts.column, cuts.side * cuts.height * velocity[cuts.body], columns)
    there = sums(cuts.column, np.ones(len(cuts.column)), columns) > 0.0
    return np.divide(total, volume, out=np.full(columns.shape, np.nan), where=there & (volume > 0.0))
