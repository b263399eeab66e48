"""Chains of floes from pier to pier, and which floes are beside each other."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable
from typing import TYPE_CHECKING, TypeVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Body = TypeVar("Body", bound=Hashable)


def arches(pairs: Iterable[tuple[Body, Body]], piers: Sequence[Body]) -> list[list[Body]]:
    """The shortest chain of floes between every two piers that have one, piers at both ends; none goes through a pier.

    pairs: bodies that touch, by name or number.
    """
    beside: dict[Body, list[Body]] = {}
    for one, other in pairs:
        beside.setdefault(one, []).append(other)
        beside.setdefault(other, []).append(one)
    found: list[list[Body]] = []
    for k, pier in enumerate(piers):
        chains = _chains(beside, pier, set(piers))
        found += [chains[other] for other in piers[k + 1 :] if other in chains]
    return found


def _chains(beside, start, piers):
    """The shortest chain from a pier to every other pier, breadth first, of those with a floe between."""
    came, waiting, ends = {start: None}, deque([start]), {}
    while waiting:
        here = waiting.popleft()
        for other in beside.get(here, ()):
            if other in piers:
                if here != start and other != start and other not in ends:
                    ends[other] = [*_way(came, here), other]
            elif other not in came:
                came[other] = here
                waiting.append(other)
    return ends


def _way(came, last):
    way = []
    while last is not None:
        way.append(last)
        last = came[last]
    return way[::-1]


def at_pier(pairs: Iterable[tuple[Body, Body]], pier: Body) -> int:
    """How many bodies touch a pier."""
    return len({one if other == pier else other for one, other in pairs if pier in (one, other)})


def outline(points: np.ndarray) -> np.ndarray:
    """Corners (k, 2) of the convex outline of points (n, 2), anticlockwise (Andrew 1979)."""
    ordered = np.unique(points, axis=0).tolist()
    if len(ordered) < 3:
        return np.array(ordered)
    corners: list[list[float]] = []
    for each in (ordered, ordered[::-1]):
        half: list[list[float]] = []
        for point in each:
            while len(half) > 1 and _turn(half[-2], half[-1], point) <= 0.0:
                half.pop()
            half.append(point)
        corners += half[:-1]
    return np.array(corners)


def _turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def gap(one: np.ndarray, other: np.ndarray) -> float:
    """Distance, m, between two convex outlines (k, 2), (m, 2), m; zero where they overlap."""
    if not _apart(one, other):
        return 0.0
    return min(_nearest(one, other), _nearest(other, one))


def _apart(one, other):
    """Whether a line along an edge of one of them has them on its two sides."""
    for a, b in ((one, other), (other, one)):
        along = np.roll(a, -1, 0) - a
        away = (b[None, :, 0] - a[:, None, 0]) * along[:, None, 1] - (b[None, :, 1] - a[:, None, 1]) * along[:, None, 0]
        if (away.min(axis=1) > 0.0).any():
            return True
    return False


def _nearest(points, polygon):
    """Smallest distance of points (n, 2) from the sides of a polygon (k, 2)."""
    along = np.roll(polygon, -1, 0) - polygon
    to = points[:, None] - polygon[None]
    square = np.maximum((along**2).sum(-1), 1e-300)
    share = np.clip((to * along).sum(-1) / square, 0.0, 1.0)
    return float(np.hypot(*np.moveaxis(to - share[..., None] * along, -1, 0)).min())


def neighbours(
    outlines: Sequence[np.ndarray], reach: float, period: tuple[float, float] = (np.inf, np.inf)
) -> list[tuple[int, int]]:
    """Pairs of outlines (k, 2), m, at most `reach`, m, apart, on a plan that repeats after a `period`, m, or never."""
    low = np.array([each.min(axis=0) for each in outlines]).reshape(-1, 2)
    high = np.array([each.max(axis=0) for each in outlines]).reshape(-1, 2)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    pairs = []
    for one in range(len(outlines)):
        away = middle[one + 1 :] - middle[one]
        with np.errstate(invalid="ignore"):
            shift = np.where(np.isfinite(period), -np.rint(away / period) * period, 0.0)
        near = (np.abs(away + shift) <= half[one + 1 :] + half[one] + reach).all(axis=1)
        for k in np.flatnonzero(near).tolist():
            if gap(outlines[one], outlines[one + 1 + k] + shift[k]) <= reach:
                pairs.append((one, one + 1 + k))
    return pairs
