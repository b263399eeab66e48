"""Which bodies are within reach of each other, of what is driven and of walls in one step: pairs, their features."""

import math
from typing import NamedTuple

import numpy as np

from parsim.machine.jit import inlined, kernel
from parsim.solid.grid import grid_of, near_of
from parsim.solid.search import FEATURE, KEY, A, B, above
from parsim.solid.separation import BALLS, ROUND_A, best_feature, gap_of_balls, is_ball
from parsim.solid.shapes.kernels import reach, touches_at_one_point
from parsim.solid.speeds import MARGIN, bound_of_speed
from parsim.solid.table import ALONE, DRIVEN, HALF, INVOLVED, POSITION, ROLE, TURN, shape_of, three

_ROUNDING = 1e-9  # of the widest body


class Reach(NamedTuple):
    """How far is looked for pairs: period (3,), m; half extents along the axes (b, 3), m; reach, m; 2D or not."""

    period: np.ndarray
    extent: np.ndarray
    reach: float
    planar: bool


@kernel
def near_pairs(m, touch, period, planar, dt, count):
    """Find the pairs that may touch within `dt`, s, and mark their bodies as involved; (number, reach in m).

    `period` (3,), m, inf where nothing repeats; the bodies are the first `count` rows of the table. A number beyond the
    room for pairs says how much is needed. A grid, then upright boxes, then separating axes. 3 us a ball, 50 a prism.
    """
    if count == 0:
        return 0, 0.0
    place, walls, ball = m[:count, POSITION : POSITION + 3], touch.walls, _balls(m)
    extent, widest = _extents(m, touch.forms, ball)
    far = 2.0 * MARGIN * dt * bound_of_speed(m, dt) + _ROUNDING * widest
    near = Reach(period, extent, far, planar)
    number, beside = 0, _beside(m, place, near)
    for k in range(len(beside)):  # balls apart from what takes long: a loop that calls much is slow where it does not
        a, b = beside[k, 0], beside[k, 1]
        if ball[a] and ball[b]:
            by = _image(m, a, b, near)
            if gap_of_balls(m, a, b, by)[0] <= far:
                number = _note(m, touch.pairs, touch.shift, number, a, b, BALLS, by)
    for k in range(len(beside)):
        a, b = beside[k, 0], beside[k, 1]
        if not (ball[a] and ball[b]):
            by = _image(m, a, b, near)
            feature, distance = best_feature(m, touch.forms, a, b, by, planar)
            if distance <= far:
                number = _note(m, touch.pairs, touch.shift, number, a, b, feature, by)
    for a in range(count):
        if m[a, ROLE] > DRIVEN:
            for w in range(len(walls)):
                high = _height_of_ball(m, walls, a, w) if ball[a] else above(m, touch, a, w)
                if high < far:
                    feature = ROUND_A if touches_at_one_point(shape_of(m, a)) else 0
                    feature = BALLS if ball[a] else feature
                    number = _note(m, touch.pairs, touch.shift, number, a, -1 - w, feature, (0.0, 0.0, 0.0))
    return number, far


@kernel
def _balls(m):
    """Which rows are balls: (n,) bool."""
    out = np.empty(len(m), np.bool_)
    for b in range(len(m)):
        out[b] = is_ball(m, b)
    return out


@inlined
def _height_of_ball(m, walls, a, w):
    x, y, z = three(m, a, POSITION)
    return walls[w, 0] * x + walls[w, 1] * y + walls[w, 2] * z - m[a, HALF] - walls[w, 3]


@kernel
def _beside(m, place, near):
    """Bodies, and what is driven, whose upright boxes are within reach of each other: rows (n, 2), the less first."""
    count, number, out, found = len(place), 0, np.empty((64, 2), np.int64), np.empty(64, np.int64)
    grid = grid_of(place, near.extent, near.reach, near.period)
    for a in range(count):
        others = near_of(grid, place, near.period, a, found)
        if others + len(m) - count > len(found):
            found = np.empty(2 * others + len(m) - count, np.int64)
            others = near_of(grid, place, near.period, a, found)
        for driven in range(count, len(m)):
            found[others] = driven
            others += 1
        if number + others > len(out):
            larger = np.empty((2 * (number + others), 2), np.int64)
            larger[:number] = out[:number]
            out = larger
        for k in range(others):
            b = found[k]
            if (m[a, ROLE] > DRIVEN or m[b, ROLE] > DRIVEN) and _within(m, min(a, b), max(a, b), near):
                out[number, 0], out[number, 1] = min(a, b), max(a, b)
                number += 1
    return out[:number]


@inlined
def _within(m, a, b, near):
    """Whether the upright boxes around two bodies are within reach of each other."""
    by = _image(m, a, b, near)
    for k in range(3):
        apart = m[a, POSITION + k] - m[b, POSITION + k] - by[k]
        if abs(apart) > near.extent[a, k] + near.extent[b, k] + near.reach:
            return False
    return True


@inlined
def _image(m, a, b, near):
    """How far the image of body b beside body a is moved, m."""
    return _moved(m, a, b, near, 0), _moved(m, a, b, near, 1), _moved(m, a, b, near, 2)


@inlined
def _moved(m, a, b, near, k):
    """The same along axis k; what is wider than half the period has no image."""
    if not near.extent[b, k] < 0.5 * near.period[k] < math.inf:
        return 0.0
    return near.period[k] * np.round((m[a, POSITION + k] - m[b, POSITION + k]) / near.period[k])


@kernel
def _extents(m, forms, ball):
    """(how far all rows reach along the axes, to the farther side, (rows, 3), m; the most of what is not driven)."""
    extent, widest = np.zeros((len(m), 3)), 0.0
    for b in range(len(m)):
        for a in range(3):
            if forms.planar and a == 1:
                continue  # all are as deep as the plane
            if ball[b]:
                extent[b, a] = m[b, HALF]
            else:
                x, y, z = three(m, b, TURN + 3 * a)
                extent[b, a] = max(reach(forms, b, (x, y, z)), reach(forms, b, (-x, -y, -z)))
            if m[b, ROLE] != DRIVEN:
                widest = max(widest, extent[b, a])
    return extent, widest


@kernel
def _note(m, pairs, shift, number, a, b, feature, by):
    """Note a pair, if there is room, and that its bodies may touch; the new number of pairs."""
    for body in (a, b):
        if body >= 0 and m[body, ROLE] == ALONE:
            m[body, ROLE] = INVOLVED
    if number < len(pairs):
        pairs[number, A], pairs[number, B], pairs[number, FEATURE] = a, b, feature
        pairs[number, KEY] = a * (len(m) + 6) + b + 6
        shift[number, 0], shift[number, 1], shift[number, 2] = by
    return number + 1
