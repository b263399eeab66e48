"""Heights on a regular grid: what lies between its nodes, parts of it, and what to do where it holds none."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.errors import InputError

if TYPE_CHECKING:
    from parsim.terrain.frame import Frame

_CHUNK = 2_000_000  # distances looked at in one go


class HeightField(NamedTuple):
    """x (nx,), y (ny,), even and ascending; z (nx, ny), NaN where there is no data. `beyond` (2,): how far along x and
    y it reaches past the outermost nodes, half a cell for rasters, whose nodes are the middles of cells."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    beyond: tuple[float, float] = (0.0, 0.0)

    @property
    def low(self) -> np.ndarray:
        """Lowest corner (2,) of what it covers."""
        return np.array([self.x[0], self.y[0]]) - self.beyond

    @property
    def high(self) -> np.ndarray:
        """Highest corner (2,) of what it covers."""
        return np.array([self.x[-1], self.y[-1]]) + self.beyond

    def at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Bilinear heights at points x, y of one shape; NaN beside nodes without data; past the rim see `_between`."""
        (i, s), (j, t) = _between(self.x, x), _between(self.y, y)
        out = np.zeros(np.broadcast(x, y).shape)
        for di, share in ((0, 1.0 - s), (1, s)):
            for dj, part in ((0, 1.0 - t), (1, t)):
                weight = share * part
                corner = self.z[np.minimum(i + di, len(self.x) - 1), np.minimum(j + dj, len(self.y) - 1)]
                out += np.where(weight == 0.0, 0.0, weight * corner)
        return out

    def on(self, x: np.ndarray, y: np.ndarray, frame: Frame) -> HeightField:
        """The same at the nodes x (nx,), y (ny,), m, of a grid in the frame of a case."""
        places = frame.of_file(*np.meshgrid(x, y, indexing="ij"))
        return HeightField(x, y, frame.height(self.at(*places)))

    def filled(self, way: str) -> tuple[HeightField, str]:
        """The same with a height everywhere, and what was done, in words, empty for nothing.

        `way`: "linear", between the next nodes with data along x and y, where there are such on both sides, else
        nearest; "nearest"; "refuse". Raises InputError where there is no data and that is refused, or none at all.
        """
        empty = np.isnan(self.z)
        missing = int(empty.sum())
        if not missing:
            return self, ""
        i, j = np.argwhere(empty)[0]
        told = f"no data at {missing} of {empty.size} heights, the first at x = {self.x[i]:.6g}, y = {self.y[j]:.6g} m"
        if way == "refuse" or missing == empty.size:
            hint = "" if missing == empty.size else '; nodata = "nearest" or "linear" fills them'
            raise InputError(told + hint)
        z = _linear(self.x, self.y, self.z) if way == "linear" else self.z
        left = np.isnan(z)
        words = f"{told}; filled " + {missing: "with the nearest", 0: "linearly"}.get(
            int(left.sum()), f"linearly, {int(left.sum())} at the edge with the nearest"
        )
        return self._replace(z=_nearest(self.x, self.y, z) if left.any() else z), words


def even(row: np.ndarray) -> bool:
    """Whether numbers (n,) that ascend are those of even steps, to a thousandth of one."""
    if len(row) < 2:
        return False
    exact, step = np.linspace(row[0], row[-1], len(row), retstep=True)
    return bool(np.abs(row - exact).max() <= 1e-3 * step)


def _between(row, at):
    """Node below each place and the share of the way to the next.

    Past the ends the slope of the last cell goes on for half a step, to the edge of a raster's cell, and no further.
    """
    if len(row) == 1:
        return np.zeros(np.shape(at), int), np.zeros(np.shape(at))
    step = (row[-1] - row[0]) / (len(row) - 1)
    where = (at - row[0]) / step
    whole = np.rint(where)
    where = np.where(np.abs(where - whole) < 1e-9, whole, where)  # beside a node, rounding needs no other node
    node = np.clip(np.floor(where).astype(int), 0, len(row) - 2)
    return node, np.clip(where - node, -0.5, 1.5)


def _linear(x, y, z):
    """Heights with holes filled between their sides along x and y, the nearer pair counting more; NaN at open ends."""
    total, weight = np.zeros(z.shape), np.zeros(z.shape)
    for row, heights, sums, weights in ((x, z, total, weight), (y, z.T, total.T, weight.T)):
        for k in range(heights.shape[1]):
            known = np.flatnonzero(~np.isnan(heights[:, k]))
            if len(known) < 2:
                continue
            holes = np.setdiff1d(np.arange(known[0], known[-1]), known)
            after = np.searchsorted(known, holes)
            share = 1.0 / (row[known[after]] - row[known[after - 1]])
            sums[holes, k] += share * np.interp(row[holes], row[known], heights[known, k])
            weights[holes, k] += share
    return np.where(np.isnan(z) & (weight > 0.0), total / np.where(weight > 0.0, weight, 1.0), z)


def _nearest(x, y, z):
    """Heights with each hole at that of the nearest node that has one, which is beside some hole."""
    empty = np.isnan(z)
    wide = np.pad(empty, 1)
    rim = ~empty & np.any([wide[1 + i : wide.shape[0] - 1 + i, 1 + j : wide.shape[1] - 1 + j] for i, j in _AROUND], 0)
    holes, known, out = np.argwhere(empty), np.argwhere(rim), z.copy()
    for part in np.array_split(holes, 1 + len(holes) * len(known) // _CHUNK):
        square = (x[part[:, :1]] - x[known[:, 0]]) ** 2 + (y[part[:, 1:]] - y[known[:, 1]]) ** 2
        best = known[square.argmin(axis=1)]
        out[part[:, 0], part[:, 1]] = z[best[:, 0], best[:, 1]]
    return out


_AROUND = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
