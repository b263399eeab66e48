"""A field of floes: all its floes drawn, and room found for all of them at once. Lengths in m, areas in m2."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.ice.cells import cut
from parsim.ice.draw import Floe, drawn, evenly, rounded
from parsim.ice.outlines import Outlines, gaps, joined, moved, near, outlines
from parsim.ice.place import Pose, Region, Taken, place, somewhere
from parsim.ice.settle import Settled, settle

if TYPE_CHECKING:
    from collections.abc import Sequence

    from parsim.ice.draw import Laws

MOST, _MANY = 100_000, 1000  # floes of a field; after so many it is seen whether they will be more
_SPREAD = 8  # part of a floe's counter, the first of those for attempts
_ATTEMPTS, _WORK = 6, 8000  # at most, and for so many floes a second one
_SHARE, _TRIES = 0.4, 20  # of the plan that scattered floes, shrunk for it, cover; places looked at for each
_ROUNDS = {"box": 2000, "disc": 2000, "polygon": 150}  # polygons are cut from a cover then
_ROUNDING = 1e-7  # of the size of floes


class Placed(NamedTuple):
    """A floe and where it is."""

    floe: Floe
    pose: Pose


def covering(area: float, seed: int, stream: int, laws: Laws) -> list[Floe] | None:
    """The first floes of a stream, as many as come nearest to this area, at least one; None if more than MOST would."""
    floes: list[Floe] = []
    total = 0.0
    for floe in drawn(seed, stream, laws):
        if floes and total + 0.5 * floe.area > area:
            return floes
        floes.append(floe)
        total += floe.area
        if len(floes) % _MANY == 0 and total * MOST < len(floes) * area:
            break
    return None


def spread(
    floes: Sequence[Floe], region: Region, fixed: Outlines, gap: float, attempts: int = _ATTEMPTS
) -> list[Placed] | None:
    """Places for all floes in a region, a gap from each other and from what is `fixed`; None where none were found.

    The largest first, each where there is room (random sequential addition). Where that ends, all are scattered anew
    and pushed apart; polygons for which this is not enough are cut from a whole cover, and have other outlines then.
    """
    order = sorted(floes, key=lambda floe: (-floe.area, floe.key))
    found = _one_by_one(order, region, fixed, gap)
    for attempt in range(0 if found else min(attempts, 1 + _WORK // len(order))):
        found = _all_at_once(order, region, fixed, gap, attempt)
        if found is not None:
            break
    return found and sorted(found, key=lambda one: one.floe.key)


def room_for(floes: Sequence[Floe], region: Region, fixed: Outlines, gap: float) -> float:
    """The area of as many of the floes, the first ones, as room is found for, to a twentieth of them; 0 if of none."""
    for part in range(19, 0, -1):
        some = floes[: len(floes) * part // 20]
        if some and spread(some, region, fixed, gap, 1) is not None:
            return sum(floe.area for floe in some)
    return 0.0


def plan(found: Sequence[Placed]) -> Outlines:
    """Outlines of floes where they are."""
    own = outlines([one.floe.outline for one in found], [one.floe.round for one in found])
    turns = [one.pose.turn for one in found]
    angles = [np.array([turn(a) for a in turns]) for turn in (math.cos, math.sin)]
    return moved(own, np.array([one.pose.x for one in found]), np.array([one.pose.y for one in found]), *angles)


def fits(floe: Floe, region: Region) -> bool:
    """Whether a floe, turned somehow, has room in an empty region."""
    own = outlines([floe.outline], [floe.round])
    return any(somewhere(own, region, (0.5, 0.5, turn / 72)) is not None for turn in range(72))


def _one_by_one(order, region, fixed, gap):
    """All floes placed one after the other; None where one finds no room."""
    taken = Taken(region, gap, 2.0 * float(np.mean([floe.size for floe in order])))
    for row in range(len(fixed.cx)):
        taken.add(fixed.take(np.array([row])))
    found = []
    for floe in order:
        pose = place(floe, taken)
        if pose is None:
            return None
        found.append(Placed(floe, _rounded(pose, floe.size)))
    return found


def _all_at_once(order, region, fixed, gap, attempt):
    """All floes scattered and pushed apart, or cut; None where that is not enough."""
    own = outlines([floe.outline for floe in order], [floe.round for floe in order])
    start = _scattered(order, own, region, fixed, attempt)
    settled = settle(own, start, fixed, region, gap, _ROUNDS[order[0].shape])
    if not settled.lack.any():
        poses = [Pose(float(x), float(y), math.atan2(s, c)) for x, y, c, s, _ in zip(*settled, strict=True)]
        found = [Placed(*one) for one in zip(order, poses, strict=True)]
    elif order[0].shape == "polygon":
        sites = np.stack([settled.x, settled.y], 1)
        cells = cut(sites, np.array([floe.area for floe in order]), fixed, region, gap)
        if cells is None:
            return None
        found = [_cell(*one) for one in zip(order, cells, strict=True)]
    else:
        return None
    found = [Placed(floe, _rounded(pose, floe.size)) for floe, pose in found]
    return found if _clear(found, region, fixed, gap) else None


def _scattered(order, own, region, fixed, attempt):
    """Floes where discs of their areas, all shrunk until there is room, find some; turned at random."""
    width, height = (high - low for low, high in zip(*region, strict=True))
    shrunk = min(1.0, math.sqrt(_SHARE * width * height / sum(floe.area for floe in order)))
    dice = np.array([evenly(floe.key, _SPREAD + attempt, 3 * _TRIES) for floe in order]).reshape(-1, _TRIES, 3)
    inner = np.minimum(own.radius, 0.5 * min(width, height))[:, None]
    x, y = (region.low[a] + inner + dice[:, :, a] * (size - 2.0 * inner) for a, size in enumerate((width, height)))
    open_ = ~_blocked(x, y, fixed)
    cells: dict[tuple[int, int], list[tuple[float, float, float]]] = {}
    cell, places = 2.0 * shrunk * order[0].size, []
    for number, floe in enumerate(order):
        radius, spot = shrunk * math.sqrt(floe.area / math.pi), int(np.argmax(open_[number]))
        for at in np.flatnonzero(open_[number]):
            px, py = float(x[number, at]), float(y[number, at])
            column, line = int(px // cell), int(py // cell)
            beside = (cells.get((column + a, line + b), ()) for a in (-1, 0, 1) for b in (-1, 0, 1))
            if all((px - u) ** 2 + (py - v) ** 2 >= (radius + r) ** 2 for some in beside for u, v, r in some):
                spot = int(at)
                break
        px, py = float(x[number, spot]), float(y[number, spot])
        cells.setdefault((int(px // cell), int(py // cell)), []).append((px, py, radius))
        places.append((px, py, 2.0 * math.pi * dice[number, 0, 2]))
    px, py, turn = np.array(places).T
    cos, sin = (np.array([way(a) for a in turn.tolist()]) for way in (math.cos, math.sin))
    return Settled(px, py, cos, sin, np.zeros(len(order)))


def _blocked(x, y, fixed):
    """Whether points x, y (any shape) are in something that is fixed."""
    found = np.zeros(x.shape, bool)
    ahead = [np.roll(corner, -1, axis=1) for corner in (fixed.x, fixed.y)]
    for u, v, p, q in zip(fixed.x, fixed.y, *ahead, strict=True):
        inside = np.ones(x.shape, bool)
        for k in range(len(u)):
            inside &= (p[k] - u[k]) * (y - v[k]) - (q[k] - v[k]) * (x - u[k]) >= 0.0
        found |= inside
    return found


def _cell(floe, corners):
    """A floe with the outline of a cell (k, 2) and its own area."""
    x, y = corners.T
    p, q = np.roll(x, -1), np.roll(y, -1)
    cross = (x - x[0]) * (q - y[0]) - (p - x[0]) * (y - y[0])
    centre = [float(u[0] + ((u + w - 2.0 * u[0]) * cross).sum() / (3.0 * cross.sum())) for u, w in ((x, p), (y, q))]
    outline = np.array([[rounded(v, floe.size) for v in corner] for corner in (corners - centre).tolist()])
    return Placed(floe._replace(outline=outline), Pose(centre[0], centre[1], 0.0))


def _rounded(pose, size):
    """A pose to the digits that are the same on every processor, its turn from 0 to 2 pi."""
    degrees = round(math.degrees(pose.turn) % 360.0, 6)
    return Pose(rounded(pose.x, size), rounded(pose.y, size), math.radians(degrees))


def _clear(found, region, fixed, gap):
    """Whether all floes keep the gap and are in the region."""
    there, n = plan(found), len(found)
    off = _ROUNDING * max(one.floe.size for one in found)
    low_x, low_y, high_x, high_y = there.extents()
    if min(low_x.min() - region.low[0], low_y.min() - region.low[1]) < -off:
        return False
    if max(high_x.max() - region.high[0], high_y.max() - region.high[1]) > off:
        return False
    every = joined(there, fixed)
    i, j = near(every, gap)
    some = (i < n) | (j < n)
    return bool((gaps(every.take(i[some]), every.take(j[some])).apart >= gap - off).all())
