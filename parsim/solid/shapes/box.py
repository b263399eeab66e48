"""A box: its table in a case, its volume and moments, and its contact elements."""

import math
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Size, Table


class BoxShape(Table):
    """A box about its centre."""

    kind: Literal["box"] = Field("box", description="a box")
    size: Size = Field(description="edge lengths (x, y, z) before turning, m; in 2D y = 1")

    @property
    def volume(self):
        """Volume, m3."""
        return math.prod(self.size)


def volume_of_box(half):
    """Volumes (nb,), m3, of boxes of half edges `half` (nb, 3)."""
    return 8.0 * half[:, 0] * half[:, 1] * half[:, 2]


def inertia_of_box(half, mass):
    """Principal moments (nb, 3), kg m2, of boxes of half edges (nb, 3) and mass (nb,)."""
    square = half * half
    return np.stack([mass / 3.0 * (square[:, (a + 1) % 3] + square[:, (a + 2) % 3]) for a in range(3)], axis=-1)


def elements_of(bodies, spacing=None):
    """Contact elements, the points that feel what a body touches, each with its share of area, on all bodies.

    They lie on corners, on edges, and between at most `spacing`, m, apart; in 2D on the outline.

    Returns first (nb + 1,): the elements of body b are rows first[b] to first[b + 1]; elements (n, 6): point, m, body
    frame, and its share of the face along each body axis, m2, signed as the face looks: the area seen along a
    direction d is the sum of max(0, area d) over the axes; cell (nb, 3), m, the distances between elements.
    Left out, the spacing is the smallest edge of each body; there are at least three elements along each edge. Two
    faces that overlap share a corner of one of them, or cross like bars: elements no farther apart than the smallest
    edge always feel it.
    """
    parts = [_box(half, bodies.planar, spacing) for half in bodies.half]
    first = np.cumsum([0, *(len(part) for part, _ in parts)])
    elements = np.concatenate([np.zeros((0, 6)), *(part for part, _ in parts)])
    return first, elements, np.array([cell for _, cell in parts]).reshape(-1, 3)


def _box(half, planar, spacing):
    """(elements, distances) of one box of half edges `half` (3,)."""
    used = [0, 2] if planar else [0, 1, 2]
    wanted = spacing or 2.0 * min(half[used])
    counts = [max(math.ceil(2.0 * h / wanted - 1e-9), 2) if a in used else 0 for a, h in enumerate(half)]
    lines = [np.linspace(-h, h, n + 1) if n else np.zeros(1) for h, n in zip(half, counts, strict=True)]
    shares = [_shares(h, n) for h, n in zip(half, counts, strict=True)]
    grid = np.stack(np.meshgrid(*lines, indexing="ij"), -1).reshape(-1, 3)
    share = np.stack(np.meshgrid(*shares, indexing="ij"), -1).reshape(-1, 3)
    area = np.zeros_like(grid)
    for a in used:
        on_face = np.abs(grid[:, a]) == half[a]
        side = np.sign(grid[:, a]) * share[:, (a + 1) % 3] * share[:, (a + 2) % 3]
        area[:, a] = np.where(on_face, side, 0.0)
    surface = np.any(area != 0.0, axis=1)
    cell = [2.0 * h / max(n, 1) for h, n in zip(half, counts, strict=True)]
    return np.hstack([grid, area])[surface], cell


def _shares(half, count):
    """Lengths that the points of one line stand for: halves at its ends."""
    if not count:
        return np.array([2.0 * half])
    share = np.full(count + 1, 2.0 * half / count)
    share[[0, -1]] *= 0.5
    return share
