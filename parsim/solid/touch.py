"""Geometry of the pairs that may touch: depth, area and place of each of their elements."""

import math

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.cores import between_cores
from parsim.solid.curves import curve_of, radius_of, spot_area
from parsim.solid.hollows import in_field
from parsim.solid.laws.law import FLAT, LINE
from parsim.solid.search import AREA, DEPTH, FEATURE, FIRST, INDEX, LAST, MIDDLE, POINT, A, B, above
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
from parsim.solid.shapes.kernels import along_side, depth, is_box, on_side, touches_along_a_line
from parsim.solid.table import CELL, HALF, POSITION, pose_of, shape_of, three
from parsim.solid.tanks import BEND, DEEP, RADIUS, SHARE

_NOWHERE = (0.0, 0.0, 0.0)
EXPECTED = 0.1  # of its radius, that something round is expected to be pressed in; its stiffness grows with the depth


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
        return _against_plane(m, touch, (first, last, a), _NOWHERE, n, walls[-1 - b, 3], curve)
    if pairs[c, FEATURE] == FIELD:
        one, two = _shares(m, touch, a, b, n)
        touch.slots[last, DEPTH] = touch.slots[last, AREA] = 0.0
        total = in_field(m, touch, (first, middle, a, b), (_NOWHERE, by), one)
        return total + in_field(m, touch, (middle, last, b, a), (by, _NOWHERE), -two)
    ramp = ramp_of(m, a, b)
    if pairs[c, FEATURE] < ROUND_A:
        tanks[c, SHARE] = overlap_share(m, touch.forms, (a, b), by, n, 4.0 * ramp)
    one, two = _shares(m, touch, a, b, n)
    one, two = tanks[c, SHARE] * one, tanks[c, SHARE] * two
    total = _within(m, touch, (first, middle, a, b), (_NOWHERE, by), n, (ramp, one), curve)
    total += _within(m, touch, (middle, last, b, a), (by, _NOWHERE), opposite, (ramp, two), curve)
    if pairs[c, FEATURE] == CORES:
        return total + _between(m, touch, c, apart, total)
    return total + _cross(m, touch, by, c, n, tanks[c, SHARE] * _of_edges(touch, b))


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
    _set(slots, pairs[c, LAST], deep, spot_area((tanks[c, BEND], tanks[c, RADIUS]), deep), x, y, z)


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
def _watched(m, touch, b, slot, d):
    """(point of body `b` watched by a slot, area that it shows towards `d` (3,), m2, or what of a side it stands for).

    All in the body's frame; the last is told by a negative INDEX.
    """
    i = touch.marks[slot, INDEX]
    if i < 0:
        return on_side(touch.forms, b, -2 - i, d)
    e = touch.elements[i]
    if is_box(shape_of(m, b)):  # three faces in one element
        area = max(e[3] * d[0], 0.0) + max(e[4] * d[1], 0.0) + max(e[5] * d[2], 0.0)
    else:
        area = max(e[3] * d[0] + e[4] * d[1] + e[5] * d[2], 0.0)
    return (e[0], e[1], e[2]), area


@kernel
def _against_plane(m, touch, which, by, n, level, curve):
    """Elements first to last of a body moved by `by` against a plane: `slots` and the area that touches, m2.

    `which`: (first, last, body); a level of 1e9 m and more is touched by all, expected depth of what is round.
    """
    marks, slots = touch.marks, touch.slots
    first, last, body = which
    (cx, cy, cz), t = pose_of(m, body, by)
    u, v, w = to_body(t, n[0], n[1], n[2])
    height, total = n[0] * cx + n[1] * cy + n[2] * cz - level, 0.0
    for slot in range(first, last):
        (x, y, z), area = _watched(m, touch, body, slot, (-u, -v, -w))
        deep = -(height + u * x + v * y + w * z)
        if marks[slot, INDEX] < 0:
            area *= _of_side(m, body, curve, min(deep, EXPECTED * curve[1]) if level > 1e8 else deep)
        elif curve[0] != FLAT:
            area = 0.0
        x, y, z = to_global(t, x, y, z)
        deep = deep if area > 0.0 else 0.0  # faces that look away feel nothing, nor have they a friction spring
        _set(slots, slot, deep, area, cx + x, cy + y, cz + z)
        total += area if deep > 0.0 else 0.0
    slots[last, DEPTH] = slots[last, AREA] = 0.0
    return total


@kernel
def _of_side(m, body, curve, deep):
    """What a point along the curved side of a body stands for, m2 or m2/m; lines that cross have a spot."""
    return spot_area(curve, deep) if touches_along_a_line(shape_of(m, body)) == (curve[0] == LINE) else 0.0


@kernel
def _set(slots, slot, deep, area, x, y, z):
    slots[slot, DEPTH], slots[slot, AREA] = deep, area
    slots[slot, POINT], slots[slot, POINT + 1], slots[slot, POINT + 2] = x, y, z


@kernel
def _within(m, touch, which, by, n, rim, curve):
    """The same against another body, depths along `n`; the rim of the contact takes from their area.

    `which`: (first, last, body, other); `by`: how far the two are moved.
    """
    marks, slots = touch.marks, touch.slots
    first, last, body, other = which
    (cx, cy, cz), t = pose_of(m, body, by[0])
    (bx, by, bz), s = pose_of(m, other, by[1])
    ramp, share = rim
    u, v, w = to_body(t, n[0], n[1], n[2])
    along, total = to_body(s, n[0], n[1], n[2]), 0.0
    for slot in range(first, last):
        (x, y, z), area = _watched(m, touch, body, slot, (-u, -v, -w))
        x, y, z = to_global(t, x, y, z)
        x, y, z = cx + x, cy + y, cz + z
        deep, weight = depth(touch.forms, other, to_body(s, x - bx, y - by, z - bz), along, ramp)
        if marks[slot, INDEX] < 0:
            area *= _of_side(m, body, curve, deep)
        elif curve[0] != FLAT:
            area = 0.0
        area = weight * share * area
        _set(slots, slot, deep if area > 0.0 else 0.0, area, x, y, z)
        total += area
    return total


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
    _set(slots, slot, deep, share * area, x, y, z)
    return share * area if deep > 0.0 else 0.0


@kernel
def _between(m, touch, c, apart, total):
    """What bodies feel where edges cross between their elements: into the pair's last slot; its area, m2.

    It stands between the nearest points of the cores and fills up what `total`, m2, the elements feel, to what one of
    them would; in a plane nothing crosses.
    """
    slot, a, b = touch.pairs[c, LAST], touch.pairs[c, A], touch.pairs[c, B]
    by, slots = three(touch.shift, c, 0), touch.slots
    slots[slot, DEPTH] = slots[slot, AREA] = 0.0
    cell = min(m[a, CELL], m[b, CELL])
    area = 0.5 * cell * cell
    if touch.tanks[c, BEND] != FLAT:
        area = spot_area((touch.tanks[c, BEND], touch.tanks[c, RADIUS]), -apart)
        if touch.tanks[c, BEND] == LINE:
            area *= _shortest(touch.forms, a, b)
    if touch.forms.planar or apart >= 0.0 or total >= area:
        return 0.0
    _, (x, y, z) = between_cores(m, touch.forms, a, b, between(m, a, b, by))
    x, y, z = x + m[b, POSITION] + by[0], y + m[b, POSITION + 1] + by[1], z + m[b, POSITION + 2] + by[2]
    _set(slots, slot, -apart, area - total, x, y, z)
    return area - total


@kernel
def _shortest(forms, a, b):
    """Length, m, that one point along the side of a cylinder stands for, where a or b is one."""
    short = math.inf
    for body in (a, b):
        if along_side(forms.shape[body]) > 1:
            short = min(short, forms.half[body, 2] / 3.0)
    return short


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
    _against_plane(m, touch, (first, middle, a), _NOWHERE, n, far, curve)
    if b >= 0:
        _against_plane(m, touch, (middle, last, b), by, (-n[0], -n[1], -n[2]), far, curve)
        if pairs[c, FEATURE] == CORES:
            _between(m, touch, c, min(apart, -tanks[c, DEEP], -1e-300), 0.0)
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
