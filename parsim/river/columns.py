"""A grid of columns on the plan: cells in x and y, each cut into pixels on which footprints are drawn."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

PIXELS = 8  # along each edge of a column


class Columns(NamedTuple):
    """low (2,), m, corner at small x and y; step (2,), m, edges of a column; shape, how many along x and y; pixels (2,)
    in a column along x and y; wraps, whether the plan repeats along x and y."""

    low: np.ndarray
    step: np.ndarray
    shape: tuple[int, int]
    pixels: tuple[int, int]
    wraps: tuple[bool, bool]

    @property
    def x(self) -> np.ndarray:
        """Middles (nx,) of the columns along x, m."""
        return self.low[0] + (np.arange(self.shape[0]) + 0.5) * self.step[0]

    @property
    def y(self) -> np.ndarray:
        """Middles (ny,) of the columns along y, m."""
        return self.low[1] + (np.arange(self.shape[1]) + 0.5) * self.step[1]

    def numbers(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Number (n,) of the column that each place is in, ny times that along x and that along y; -1 outside."""
        along, inside = [], np.ones(len(x), bool)
        for axis, place in enumerate((x, y)):
            k = np.floor((place - self.low[axis]) / self.step[axis]).astype(np.int64)
            if self.wraps[axis]:
                k %= self.shape[axis]
            inside &= (k >= 0) & (k < self.shape[axis])
            along.append(k)
        return np.where(inside, along[0] * self.shape[1] + along[1], -1)

    def fold(self, values: np.ndarray) -> np.ndarray:
        """Values (nx ny, ...) by numbers of columns as (nx, ny, ...)."""
        return values.reshape(*self.shape, *values.shape[1:])


def columns_of(
    low: Sequence[float],
    high: Sequence[float],
    edge: float,
    wraps: tuple[bool, bool] = (False, False),
    planar: bool = False,
) -> Columns:
    """Columns of about the `edge`, m, that fill a box from `low` to `high` (2 or more), m.

    `planar`: of a 2D case, one column and one pixel across its metre of width.
    """
    size = [high[a] - low[a] for a in (0, 1)]
    count = [max(1, math.floor(length / edge + 0.5)) for length in size]
    if planar:
        count[1] = 1
    step = np.array([length / n for length, n in zip(size, count, strict=True)])
    pixels = (PIXELS, 1 if planar else PIXELS)
    return Columns(np.array(low[:2], float), step, (count[0], count[1]), pixels, wraps)


def sums(number: np.ndarray, weight: np.ndarray, columns: Columns) -> np.ndarray:
    """Sums (nx, ny) of the weights (n,) in each column by their numbers (n,); those outside (-1) are left out."""
    inside = number >= 0
    total = np.bincount(number[inside], weight[inside], columns.shape[0] * columns.shape[1])
    return columns.fold(total)


def means(number: np.ndarray, values: np.ndarray, weight: np.ndarray, columns: Columns) -> np.ndarray:
    """Weighted means (nx, ny) of values (n,) in each column; NaN where there is no weight."""
    total, whole = sums(number, weight * values, columns), sums(number, weight, columns)
    return np.divide(total, whole, out=np.full(columns.shape, np.nan), where=whole > 0.0)
