"""Outlines of floes in plan, many at once: how far they are apart, and which are near each other. Lengths in m.

Nothing here but sums, products and roots of single numbers: those come out the same on every processor.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable


_SIDE = 1e-6  # of the radius: shorter sides have no direction


class Outlines(NamedTuple):
    """Convex polygons: corners x, y (n, k), anticlockwise, the last repeated where there are fewer; centre cx, cy (n,);
    radius (n,) of the circle about it that holds them all; round (n,): radius of a disc, 0 of what is none."""

    x: np.ndarray
    y: np.ndarray
    cx: np.ndarray
    cy: np.ndarray
    radius: np.ndarray
    round: np.ndarray

    def take(self, rows: np.ndarray) -> Outlines:
        """Some of them."""
        return Outlines(*(part[rows] for part in self))

    def extents(self) -> tuple[np.ndarray, ...]:
        """Least x and y, largest x and y, each (n,)."""
        return self.x.min(axis=1), self.y.min(axis=1), self.x.max(axis=1), self.y.max(axis=1)


def outlines(corners: Iterable[np.ndarray], rounds: Iterable[float]) -> Outlines:
    """Of polygons (k, 2) about their centres, all at the origin."""
    kept = [np.asarray(own, float) for own in corners]
    most = max([3, *map(len, kept)])
    every = np.array([np.concatenate([own, np.repeat(own[-1:], most - len(own), axis=0)]) for own in kept])
    x, y = np.moveaxis(every.reshape(-1, most, 2), 2, 0)
    zero = np.zeros(len(kept))
    return Outlines(x, y, zero, zero, np.sqrt((x * x + y * y).max(axis=1, initial=0.0)), np.array(list(rounds), float))


def moved(own: Outlines, cx: np.ndarray, cy: np.ndarray, cos: np.ndarray, sin: np.ndarray) -> Outlines:
    """Outlines that stand at the origin turned, by cosine and sine, and moved."""
    c, s = cos[:, None], sin[:, None]
    x, y = c * own.x - s * own.y + cx[:, None], s * own.x + c * own.y + cy[:, None]
    return own._replace(x=x, y=y, cx=cx, cy=cy)


def joined(one: Outlines, two: Outlines) -> Outlines:
    """Both, one after the other."""
    most, parts = max(one.x.shape[1], two.x.shape[1]), []
    for a, b in zip(one, two, strict=True):
        if a.ndim == 2:
            a, b = (np.concatenate([p, np.repeat(p[:, -1:], most - p.shape[1], axis=1)], axis=1) for p in (a, b))
        parts.append(np.concatenate([a, b]))
    return Outlines(*parts)


class Gaps(NamedTuple):
    """Of pairs: how far they are apart at least, negative where they overlap (n,); direction from the first to the
    second along which that is, nx, ny (n,); the point where they are nearest, px, py (n,)."""

    apart: np.ndarray
    nx: np.ndarray
    ny: np.ndarray
    px: np.ndarray
    py: np.ndarray


def gaps(one: Outlines, two: Outlines) -> Gaps:
    """Of pairs row by row, by separating axes: the sides of both, of two discs the line through their centres."""
    discs = (one.round > 0.0) & (two.round > 0.0)
    if discs.all():
        return _of_discs(one, two)
    if discs.any():
        found, parts = np.zeros((5, len(discs))), ((discs, _of_discs), (~discs, _of_sides))
        for rows, how in parts:
            found[:, rows] = how(one.take(rows), two.take(rows))
        return Gaps(*found)
    return _of_sides(one, two)


def _of_discs(one, two):
    dx, dy = two.cx - one.cx, two.cy - one.cy
    length = np.maximum(np.sqrt(dx * dx + dy * dy), 1e-30)
    nx, ny = dx / length, dy / length
    return Gaps(length - one.round - two.round, nx, ny, one.cx + one.round * nx, one.cy + one.round * ny)


def _of_sides(one, two):
    first, back = _along_sides(one, two), _along_sides(two, one)
    return Gaps(*np.where(first.apart >= back.apart, first, back._replace(nx=-back.nx, ny=-back.ny)))


def _along_sides(one, two):
    """Gaps along the sides of the first."""
    ex, ey = np.roll(one.x, -1, axis=1) - one.x, np.roll(one.y, -1, axis=1) - one.y
    length = np.sqrt(ex * ex + ey * ey)
    side = length > _SIDE * one.radius[:, None]
    length = np.where(side, length, 1.0)
    nx, ny = ey / length, -ex / length
    reach = nx[:, :, None] * two.x[:, None, :] + ny[:, :, None] * two.y[:, None, :]
    apart = np.where(side, reach.min(axis=2) - (nx * one.x + ny * one.y), -np.inf)
    rows, best = np.arange(len(apart)), apart.argmax(axis=1)
    corner = reach[rows, best].argmin(axis=1)
    return Gaps(apart[rows, best], nx[rows, best], ny[rows, best], two.x[rows, corner], two.y[rows, corner])


def near(those: Outlines, margin: float) -> tuple[np.ndarray, np.ndarray]:
    """Rows i and j (m,) of all pairs whose upright boxes are no more than a margin apart: sorted along the longer axis,
    each is met only by those that begin before it ends."""
    boxes = those.extents()
    lengthwise = int(np.ptp(those.cy) > np.ptp(those.cx)) if len(those.cx) else 0
    low, high, beside_low, beside_high = (boxes[k] for k in ((0, 2, 1, 3), (1, 3, 0, 2))[lengthwise])
    order = np.argsort(low, kind="stable")
    ends = np.searchsorted(low[order], high[order] + margin, side="right")
    count = np.maximum(ends - np.arange(len(order)) - 1, 0)
    first = np.repeat(np.arange(len(order)), count)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count)
    i, j = order[first], order[second]
    beside = (beside_low[j] <= beside_high[i] + margin) & (beside_low[i] <= beside_high[j] + margin)
    return i[beside], j[beside]
