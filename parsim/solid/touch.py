"""Geometry of the pairs that may touch: depth, area and place of each of their elements."""

import math

from parsim.geometry.rotation import to_body
from parsim.machine.jit import kernel
from parsim.solid.cores import between_cores
from parsim.solid.curves import curve_of, radius_of, spot_area
from parsim.solid.faces import EXPECTED, against_plane, beside, note, within
from parsim.solid.hollows import in_field
from parsim.solid.laws.law import FLAT, LINE
from parsim.solid.overlap import faces_of, fit
from parsim.solid.search import AREA, DEPTH, FEATURE, FIRST, LAST, MIDDLE, POINT, A, B, above
from parsim.solid.separation import (
    BALLS,
    CORES,
    FIELD,
    ROUND_A,
    ROUND_B,
    between,
    edge_crossing,
    overlap_share,
    ramp_of,
    separation,
)
from parsim.solid.shapes.kernels import along_side, whole_side
from parsim.solid.table import CELL, HALF, POSITION, shape_of, three, turn_at
from parsim.solid.tanks import BEND, DEEP, RADIUS, SHARE

_NOWHERE = (0.0, 0.0, 0.0)


@kernel
def normal_of(m, touch, c):
    """(distance of pair `c` along its direction, unit normal towards body a)."""
    walls, pairs, shift = touch.walls, touch.pairs, touch.shift
    a, b = pairs[c, A], pairs[c, B]
    if b >= 0:
        return separation(m, touch.forms, a, b, three(shift, c, 0), pairs[c, FEATURE])
    w = -1 - b
    return above(m, touch, a, w), walls[w, 0], walls[w, 1], walls[w, 2]


@kernel
def touches_round(touch, c):
    """Whether pair `c` touches at one point of something round."""
    return ROUND_A <= touch.pairs[c, FEATURE] <= BALLS


@kernel
def measure(m, touch, c, n, apart):
    """Depth, area and place of all elements of pair `c` for the normal `n` into `slots`; the area that touches, m2.

    What is round touches with its curved side alone.
    """
    walls, pairs, tanks = touch.walls, touch.pairs, touch.tanks
    a, b, by = pairs[c, A], pairs[c, B], three(touch.shift, c, 0)
    first, middle, last = pairs[c, FIRST], pairs[c, MIDDLE], pairs[c, LAST]
    tanks[c, SHARE], tanks[c, DEEP] = 1.0, max(-apart, 0.0)
    tanks[c, BEND], tanks[c, RADIUS] = curve_of(m, touch.forms, a, b, n)
    if touches_round(touch, c):
        _spot(m, touch, c, n)
        return touch.slots[last, AREA] if b >= 0 or _on_wall(touch, c) else 0.0
    curve, opposite = (tanks[c, BEND], tanks[c, RADIUS]), (-n[0], -n[1], -n[2])
    if b < 0:
        return against_plane(m, touch, (first, last, a), _NOWHERE, n, walls[-1 - b, 3], curve)
    if pairs[c, FEATURE] == FIELD:
        one, two = _shares(m, touch, a, b, n)
        touch.slots[last, DEPTH] = touch.slots[last, AREA] = 0.0
        total = in_field(m, touch, (first, middle, a, b), (_NOWHERE, by), one)
        return total + in_field(m, touch, (middle, last, b, a), (by, _NOWHERE), -two)
    ramp, narrow = ramp_of(m, a, b), 1.0
    if pairs[c, FEATURE] < ROUND_A:
        narrow = tanks[c, SHARE] = overlap_share(m, touch.forms, (a, b), by, n, 4.0 * ramp)
        if narrow == 0.0:  # apart, along another direction than that kept over the step
            return 0.0
    faces = faces_of(m, touch.forms, (a, b), by, n, curve[0] == FLAT)
    one, two = _shares(m, touch, a, b, n)
    rim_a = ramp, one, narrow, tanks[c, DEEP], faces, False
    rim_b = ramp, two, narrow, tanks[c, DEEP], faces, True
    total = within(m, touch, (first, middle, a, b), (_NOWHERE, by), n, rim_a, curve)
    total += within(m, touch, (middle, last, b, a), (by, _NOWHERE), opposite, rim_b, curve)
    if faces.flat > 0.0 and total > 0.0:
        total = fit(touch.slots, first, last, faces)
    if pairs[c, FEATURE] == CORES:
        return total + _between(m, touch, c, n, apart, total, 1.0 - faces.flat)
    return total + _cross(m, touch, by, c, n, narrow * _of_edges(touch, b))


@kernel
def _on_wall(touch, c):
    """Whether what is round touches its wall where there is one."""
    w, last = touch.walls[-1 - touch.pairs[c, B]], touch.pairs[c, LAST]
    x, y, z = three(touch.slots, last, POINT)
    return w[4] <= x <= w[7] and w[5] <= y <= w[8] and w[6] <= z <= w[9]


@kernel
def _spot(m, touch, c, n):
    """Where something round touches, into the last slot of pair `c`: one element."""
    pairs, slots, tanks = touch.pairs, touch.slots, touch.tanks
    body, by, sign, deep = pairs[c, A], _NOWHERE, -1.0, tanks[c, DEEP]
    if pairs[c, FEATURE] == ROUND_B:
        body, by, sign = pairs[c, B], three(touch.shift, c, 0), 1.0
    x, y, z = three(m, body, POSITION)
    arm = sign * (m[body, HALF] - 0.5 * deep)
    x, y, z = x + by[0] + arm * n[0], y + by[1] + arm * n[1], z + by[2] + arm * n[2]
    note(slots, pairs[c, LAST], deep, spot_area((tanks[c, BEND], tanks[c, RADIUS]), deep), x, y, z)


@kernel
def _of_edges(touch, b):
    """How much the crossing of two edges counts, which is an element of both."""
    return 0.5 if b >= 0 and touch.first[b + 1] > touch.first[b] else 1.0


@kernel
def _shares(m, touch, a, b, n):
    """How much the points of bodies a and b count, that watch each other; alone they count whole.

    Together once: where those of one stand for larger areas, they count less, or one of them would outweigh all others.
    """
    if touch.first[b + 1] == touch.first[b]:
        return 1.0, 0.0
    one, two = radius_of(m, touch.forms, a, n), radius_of(m, touch.forms, b, n)
    if one > 0.0 or two > 0.0:
        return (0.5, 0.5) if one > 0.0 and two > 0.0 else (1.0, 1.0)
    one, two = max(m[a, CELL], m[a, CELL + 2]), max(m[b, CELL], m[b, CELL + 2])
    ratio = 0.5 * min(one / two, two / one) * min(one / two, two / one)
    return (1.0 - ratio, ratio) if one < two else (ratio, 1.0 - ratio)


@kernel
def _cross(m, touch, by, c, n, share):
    """The crossing of two edges, where that is how the boxes touch: into the pair's last slot; its area."""
    pairs, slots = touch.pairs, touch.slots
    slot, a, b, feature = pairs[c, LAST], pairs[c, A], pairs[c, B], pairs[c, FEATURE]
    slots[slot, DEPTH] = slots[slot, AREA] = 0.0
    if feature < 6:
        return 0.0
    apart = separation(m, touch.forms, a, b, by, feature)[0]
    x, y, z, area, meet = edge_crossing(m, a, b, by, feature, n)
    deep = max(-apart, 0.0) if meet else 0.0
    note(slots, slot, deep, share * area, x, y, z)
    return share * area if deep > 0.0 else 0.0


@kernel
def _between(m, touch, c, n, apart, total, share):
    """What bodies feel where edges cross between their elements: into the pair's last slot; its area, m2.

    It stands between the nearest points of the cores and fills up what `total`, m2, the elements feel, to what one of
    them would, or this share of it; in a plane nothing crosses.
    """
    slot, a, b = touch.pairs[c, LAST], touch.pairs[c, A], touch.pairs[c, B]
    by, slots = three(touch.shift, c, 0), touch.slots
    slots[slot, DEPTH] = slots[slot, AREA] = 0.0
    cell = min(m[a, CELL], m[b, CELL])
    area = 0.5 * cell * cell
    if touch.tanks[c, BEND] != FLAT:
        area = spot_area((touch.tanks[c, BEND], touch.tanks[c, RADIUS]), -apart)
        if touch.tanks[c, BEND] == LINE:
            area *= _length(m, touch, c, n, ramp_of(m, a, b))
    area = share * (area - total)
    if touch.forms.planar or apart >= 0.0 or area <= 0.0:
        return 0.0
    _, (x, y, z) = between_cores(m, touch.forms, a, b, between(m, a, b, by))
    x, y, z = x + m[b, POSITION] + by[0], y + m[b, POSITION + 1] + by[1], z + m[b, POSITION + 2] + by[2]
    note(slots, slot, -apart, area, x, y, z)
    return area


@kernel
def _length(m, touch, c, n, short):
    """Length, m, along which the side of a cylinder of pair `c` may touch an edge; `short` where its line crosses it.

    Where the line misses the other body it lies beside an edge, along all of that.
    """
    a, b, least = touch.pairs[c, A], touch.pairs[c, B], math.inf
    x, y, z = between(m, a, b, three(touch.shift, c, 0))
    for body, other, sign in ((a, b, 1.0), (b, a, -1.0)):
        if along_side(shape_of(m, body)) > 1:
            t, s = turn_at(m, body), turn_at(m, other)
            d = to_body(t, -sign * n[0], -sign * n[1], -sign * n[2])
            pose = (sign * x, sign * y, sign * z), t, s
            (low, high), hit = beside(touch.forms, (body, other), pose, d, whole_side(touch.forms, body))
            least = min(least, short if hit else math.inf, high - low)
    return least


@kernel
def show(m, touch, c, n, apart):
    """Area, place and depth 1 of all elements of pair `c` into `slots`, as if all touched; their area, m2.

    What is round is as deep as it is expected to get.
    """
    pairs, slots, tanks = touch.pairs, touch.slots, touch.tanks
    a, b, by, far = pairs[c, A], pairs[c, B], three(touch.shift, c, 0), 1e9
    first, middle, last = pairs[c, FIRST], pairs[c, MIDDLE], pairs[c, LAST]
    tanks[c, BEND], tanks[c, RADIUS] = curve_of(m, touch.forms, a, b, n)
    tanks[c, DEEP] = max(EXPECTED * tanks[c, RADIUS], -apart)
    if touches_round(touch, c):
        _spot(m, touch, c, n)
        return slots[last, AREA]
    curve = tanks[c, BEND], tanks[c, RADIUS]
    against_plane(m, touch, (first, middle, a), _NOWHERE, n, far, curve)
    if b >= 0:
        against_plane(m, touch, (middle, last, b), by, (-n[0], -n[1], -n[2]), far, curve)
        if pairs[c, FEATURE] == CORES:
            _between(m, touch, c, n, min(apart, -tanks[c, DEEP], -1e-300), 0.0, 1.0)
        elif pairs[c, FEATURE] != FIELD:
            _cross(m, touch, by, c, n, 1.0)
    one, two = _shares(m, touch, a, b, n) if b >= 0 else (1.0, 0.0)
    total = 0.0
    for slot in range(first, last + 1):
        slots[slot, DEPTH] = 1.0
        slots[slot, AREA] *= one if slot < middle else (two if slot < last else _of_edges(touch, b))
        total += slots[slot, AREA]
    return total


@kernel
def centre_of(slots, first, last):
    """Centre of the touching area of the slots `first` to `last`, both included."""
    x, y, z, total = 0.0, 0.0, 0.0, 0.0
    for slot in range(first, last + 1):
        if slots[slot, DEPTH] > 0.0:
            area = slots[slot, AREA]
            px, py, pz = three(slots, slot, POINT)
            x, y, z, total = x + area * px, y + area * py, z + area * pz, total + area
    return x / total, y / total, z / total
