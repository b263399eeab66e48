"""Which bodies are near each other: cells of a grid for each size of bodies, in time that goes with their number.

A body is in a cell of the level whose cells are at least as wide as it is with the reach, and at most twice as wide. It
looks for others in the cells around it, of its own level and of all wider ones.
"""

import math
from typing import NamedTuple

import numpy as np

from parsim.machine.jit import inlined, kernel

_ALL = 3  # cells along a period below which it is one cell: a body would see the same one on both sides
_NONE = -1
_ROOM = 1.0 + 1e-9  # for the rounding of cells


class Grid(NamedTuple):
    """cell (n, 3) and level (n,) of n bodies; chains of those in one bucket: first (a power of two of buckets) and
    following (n,); width (l,) of the cells of each level, m, how many there are along the axes, many (l, 3), 0:
    endless, and how many bodies, bodies (l,)."""

    cell: np.ndarray
    level: np.ndarray
    first: np.ndarray
    following: np.ndarray
    width: np.ndarray
    many: np.ndarray
    bodies: np.ndarray


@kernel
def grid_of(place, extent, far, period):
    """`Grid` of one body or more at `place` (n, 3), m, for pairs up to `far` apart, m.

    extent (n, 3): how far they reach along the axes, m; period (3,), m, inf where nothing repeats.
    """
    count = len(place)
    size = np.empty(count)
    for b in range(count):
        size[b] = _ROOM * (2.0 * max(extent[b, 0], extent[b, 1], extent[b, 2]) + far)
    least = max(np.min(size), 1e-9 * np.max(size))
    level = np.empty(count, np.int64)
    for b in range(count):
        level[b] = max(math.ceil(math.log2(size[b] / least)), 0)
    width = least * 2.0 ** np.arange(np.max(level) + 1)
    many = np.zeros((len(width), 3), np.int64)
    for k in range(len(width)):
        for a in range(3):
            if period[a] < math.inf:
                many[k, a] = math.floor(period[a] / width[k])
                many[k, a] = 1 if many[k, a] < _ALL else many[k, a]
    buckets, bodies = 1, np.zeros(len(width), np.int64)
    while buckets < 2 * count:
        buckets *= 2
    cell, first, following = np.empty((count, 3), np.int64), np.full(buckets, _NONE), np.empty(count, np.int64)
    for b in range(count - 1, -1, -1):
        bodies[level[b]] += 1
        for a in range(3):
            cell[b, a] = _cell(place[b, a], width[level[b]], period[a], many[level[b], a])
        at = _bucket(level[b], cell[b, 0], cell[b, 1], cell[b, 2], buckets)
        following[b], first[at] = first[at], b
    return Grid(cell, level, first, following, width, many, bodies)


@kernel
def _cell(x, width, period, many):
    if many == 0:
        return math.floor(x / width)
    return math.floor((x / period - math.floor(x / period)) * many) % many


@inlined
def _bucket(level, i, j, k, buckets):
    return ((i * 73856093) ^ (j * 19349663) ^ (k * 83492791) ^ (level * 15485863)) & (buckets - 1)


@kernel
def _around(x, width, period, many):
    """The first and the last cell around place x along one axis."""
    at = _cell(x, width, period, many)
    return (0, 0) if many == 1 else (at - 1, at + 1)


@kernel
def near_of(grid, place, period, b, found):
    """Note in `found` the bodies that may be near body b: those of its level after it, all of wider ones; how many.

    Beyond the room in `found` they are counted only. 0.4 us a body.
    """
    count, many = 0, grid.many
    for k in range(grid.level[b], len(grid.width)):
        if not grid.bodies[k]:
            continue
        west, east = _around(place[b, 0], grid.width[k], period[0], many[k, 0])
        near, far = _around(place[b, 1], grid.width[k], period[1], many[k, 1])
        low, high = _around(place[b, 2], grid.width[k], period[2], many[k, 2])
        for i in range(west, east + 1):
            x = i % many[k, 0] if many[k, 0] else i
            for j in range(near, far + 1):
                y = j % many[k, 1] if many[k, 1] else j
                for h in range(low, high + 1):
                    z = h % many[k, 2] if many[k, 2] else h
                    count = _look(grid, k, (x, y, z), b, found, count)
    return count


@inlined
def _look(grid, k, cell, b, found, count):
    """Note the bodies in one cell of level `k`; the new count."""
    x, y, z = cell
    other = grid.first[_bucket(k, x, y, z, len(grid.first))]
    while other != _NONE:
        its = grid.cell[other]
        if grid.level[other] == k and its[0] == x and its[1] == y and its[2] == z and (k > grid.level[b] or other > b):
            if count < len(found):
                found[count] = other
            count += 1
        other = grid.following[other]
    return count
