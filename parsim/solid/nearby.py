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
_SKIN = 0.1  # of the least extent, by which more are listed than are within reach
_LOOK = 6e-6  # s that it takes to look at two bodies, about
_TOLD = 6  # numbers of a pair: a, b, feature, shift


class Reach(NamedTuple):
    """How far is looked for pairs: period (3,), m; half extents along the axes (b, 3), m; reach, m; 2D or not."""

    period: np.ndarray
    extent: np.ndarray
    reach: float
    planar: bool


class Beside:
    """Bodies whose upright boxes were within reach, and more, of each other, kept until something may have come in.

    What is found does not depend on when they were listed: it is looked at anew each time.
    """

    def __init__(self):
        self._listed = np.zeros((0, 2), np.int64)
        self._seen, self._far = np.zeros((0, 7)), -math.inf

    def near_pairs(self, m, touch, find, dt, shares=None):
        """See `near_pairs`; `find`: its period, planar and count; shares: see `Contacts`. In no order."""
        period, planar, count = find
        far, seen = _reach(m, touch.forms, dt, count)
        if count and not (len(seen) == len(self._seen) and far + 2.0 * _changed(seen, self._seen) <= self._far):
            self._seen, self._far = seen, far + max(far, _SKIN * float(seen[:count, 3:6].max(axis=1).min()))
            self._listed = _beside(m, Reach(period, seen[:, 3:6], self._far, planar), count)
        if not count:
            return 0, 0.0
        near, many = Reach(period, seen[:, 3:6], far, planar), len(self._listed)
        if shares is None or _LOOK * many < shares.least:
            return near_pairs(m, touch, self._listed, near, count, (0, 1)), far
        number = near_pairs(m, touch, self._listed, near, count, (shares.own, shares.count))
        numbers = shares.counts(number)
        if numbers.sum() <= len(touch.pairs):
            line = shares.gather(told(touch, number), _TOLD * numbers)
            take_pairs(m, touch, line)
        return int(numbers.sum()), far


@kernel
def _reach(m, forms, dt, count):
    """(how far is looked for pairs, m; of all rows place, how far they reach along the axes, m, and whether they are
    free, (rows, 7))."""
    extent, widest = _extents(m, forms, _balls(m))
    seen = np.empty((len(m), 7))
    for b in range(len(m)):
        for k in range(3):
            seen[b, k], seen[b, 3 + k] = m[b, POSITION + k], extent[b, k]
        seen[b, 6] = 1.0 if m[b, ROLE] > DRIVEN else 0.0
    return (2.0 * MARGIN * dt * bound_of_speed(m, dt) + _ROUNDING * widest if count else 0.0), seen


@kernel
def _changed(seen, before):
    """How far, m, the sides of any upright box have moved; endlessly where something has become free, or is no more."""
    most = 0.0
    for b in range(len(seen)):
        for k in range(3):
            most = max(most, abs(seen[b, k] - before[b, k]) + abs(seen[b, 3 + k] - before[b, 3 + k]))
        if seen[b, 6] != before[b, 6]:
            return math.inf
    return most


@kernel
def near_pairs(m, touch, beside, near, count, part):
    """Find the pairs that may touch among those `beside` each other, and mark their bodies as involved; how many.

    The bodies are the first `count` rows of the table. A number beyond the room for pairs says how much is needed.
    part: which of how many parts of all that is looked at.
    A grid, then upright boxes, then separating axes. 50 us a prism; 0.5 us a ball, 4 where all are listed anew.
    """
    far, walls, ball, number = near.reach, touch.walls, _balls(m), 0
    first, last = part[0] * len(beside) // part[1], (part[0] + 1) * len(beside) // part[1]
    for k in range(first, last):  # balls apart from what takes long: a loop that calls much is slow where it does not
        a, b = beside[k, 0], beside[k, 1]
        if ball[a] and ball[b] and _within(m, a, b, near):
            by = _image(m, a, b, near)
            if gap_of_balls(m, a, b, by)[0] <= far:
                number = _note(m, touch.pairs, touch.shift, number, a, b, BALLS, by)
    for k in range(first, last):
        a, b = beside[k, 0], beside[k, 1]
        if not (ball[a] and ball[b]) and _within(m, a, b, near):
            by = _image(m, a, b, near)
            feature, distance = best_feature(m, touch.forms, a, b, by, near.planar)
            if distance <= far:
                number = _note(m, touch.pairs, touch.shift, number, a, b, feature, by)
    for a in range(part[0] * count // part[1], (part[0] + 1) * count // part[1]):
        if m[a, ROLE] > DRIVEN:
            for w in range(len(walls)):
                high = _height_of_ball(m, walls, a, w) if ball[a] else above(m, touch, a, w)
                if high < far:
                    feature = ROUND_A if touches_at_one_point(shape_of(m, a)) else 0
                    feature = BALLS if ball[a] else feature
                    number = _note(m, touch.pairs, touch.shift, number, a, -1 - w, feature, (0.0, 0.0, 0.0))
    return number


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
def _beside(m, near, count):
    """Bodies, and what is driven, whose upright boxes are within reach of each other: rows (n, 2), the less first."""
    place = m[:count, POSITION : POSITION + 3]
    number, out, found = 0, np.empty((64, 2), np.int64), np.empty(64, np.int64)
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


@kernel
def told(touch, number):
    """The first `number` pairs as numbers, _TOLD of each, (number, _TOLD)."""
    out = np.empty((number, _TOLD))
    for c in range(number):
        out[c, 0], out[c, 1], out[c, 2] = touch.pairs[c, A], touch.pairs[c, B], touch.pairs[c, FEATURE]
        out[c, 3], out[c, 4], out[c, 5] = touch.shift[c, 0], touch.shift[c, 1], touch.shift[c, 2]
    return out


@kernel
def take_pairs(m, touch, line):
    """Note the pairs that `line` has, as all have `told` them."""
    for c in range(len(line) // _TOLD):
        at = c * _TOLD
        by = line[at + 3], line[at + 4], line[at + 5]
        _note(m, touch.pairs, touch.shift, c, int(line[at]), int(line[at + 1]), int(line[at + 2]), by)
