"""Contact elements: the points on the surface of a body that feel what they touch, each with its share of area."""

import math

import numpy as np


def elements_of(bodies, spacing=None):
    """Elements on all bodies, corners and edges included, at most `spacing`, m, apart; in 2D on the outline.

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
