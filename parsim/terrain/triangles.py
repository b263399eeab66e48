"""A surface of triangles that need not be closed: its heights alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.terrain.height_field import HeightField

if TYPE_CHECKING:
    from parsim.terrain.frame import Frame

_CHUNK = 2_000_000  # nodes looked at in one go
_RIM = 1e-9  # share of a triangle by which a node may lie beyond its sides


class Triangles(NamedTuple):
    """points (k, 3), triangles (n, 3) of them, turned either way; where several lie above each other the top counts."""

    points: np.ndarray
    triangles: np.ndarray

    @property
    def low(self) -> np.ndarray:
        """Lowest corner (2,) of the rectangle around it."""
        return self.points[:, :2].min(axis=0)

    @property
    def high(self) -> np.ndarray:
        """Highest corner (2,) of the rectangle around it."""
        return self.points[:, :2].max(axis=0)

    def on(self, x: np.ndarray, y: np.ndarray, frame: Frame) -> HeightField:
        """Its heights at the nodes x (nx,), y (ny,), m, of a grid in the frame of a case; NaN where there is none."""
        corners = np.stack([*frame.of_case(*self.points[:, :2].T), frame.height(self.points[:, 2])], -1)
        a, b, c = (corners[self.triangles[:, k]] for k in range(3))
        plan = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        sides = np.stack([a, b, c])
        low, high = sides.min(axis=0), sides.max(axis=0)
        first, last = [], []
        for axis, row in enumerate((x, y)):
            margin = _RIM * (high[:, axis] - low[:, axis]) + 1e-9 * (row[-1] - row[0])
            first.append(np.searchsorted(row, low[:, axis] - margin))
            last.append(np.searchsorted(row, high[:, axis] + margin, "right"))
        counts = [np.maximum(end - begin, 0) for begin, end in zip(first, last, strict=True)]
        nodes = np.where(plan != 0.0, counts[0] * counts[1], 0)
        heights = np.full((len(x), len(y)), -np.inf)
        for part in np.array_split(np.flatnonzero(nodes), 1 + int(nodes.sum()) // _CHUNK):
            which = np.repeat(part, nodes[part])
            place = np.arange(len(which)) - np.repeat(np.cumsum(nodes[part]) - nodes[part], nodes[part])
            i, j = first[0][which] + place // counts[1][which], first[1][which] + place % counts[1][which]
            p, q, r, area = a[which], b[which], c[which], plan[which]
            s = ((x[i] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (y[j] - p[:, 1]) * (r[:, 0] - p[:, 0])) / area
            t = ((q[:, 0] - p[:, 0]) * (y[j] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (x[i] - p[:, 0])) / area
            inside = (s >= -_RIM) & (t >= -_RIM) & (s + t <= 1.0 + _RIM)
            z = p[:, 2] + s * (q[:, 2] - p[:, 2]) + t * (r[:, 2] - p[:, 2])
            np.maximum.at(heights, (i[inside], j[inside]), z[inside])
        return HeightField(x, y, np.where(np.isneginf(heights), np.nan, heights))
