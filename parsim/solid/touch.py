"""Geometry of the pairs that may touch: depth, area and place of each of their elements."""

import math

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.search import AREA, DEPTH, FEATURE, FIRST, INDEX, LAST, MIDDLE, POINT, A, B, above
from parsim.solid.separation import ROUND_A, ROUND_B, depth_in_box, edge_crossing, overlap_share, ramp_of, separation
from parsim.solid.shapes.kernels import touches_at_one_point
from parsim.solid.table import HALF, POSITION, pose_of, shape_of, three
from parsim.solid.tanks import SHARE

_NOWHERE = (0.0, 0.0, 0.0)
_DEEPEST = 0.1  # of its radius, that something round is expected to be pressed in; its stiffness grows with the depth


@kernel
def normal_of(m, touch, c):
    """(distance of pair `c` along its direction, unit normal towards body a)."""
    walls, pairs, shift = touch.walls, touch.pairs, touch.shift
    a, b = pairs[c, A], pairs[c, B]
    if b >= 0:
        return separation(m, a, b, three(shift, c, 0), pairs[c, FEATURE])
    w = -1 - b
    return above(m, walls, a, w), walls[w, 0], walls[w, 1], walls[w, 2]


@kernel
def measure(m, touch, c, n):
    """Depth, area and place of all elements of pair `c` for the normal `n` into `slots`; the area that touches, m2.

    Elements of either body count half, or the area would count twice; against what has none they count whole.
    """
    walls, pairs, shift = touch.walls, touch.pairs, touch.shift
    a, b, by = pairs[c, A], pairs[c, B], three(shift, c, 0)
    first, middle, last = pairs[c, FIRST], pairs[c, MIDDLE], pairs[c, LAST]
    touch.tanks[c, SHARE] = 1.0
    if pairs[c, FEATURE] >= ROUND_A:
        _spot(m, touch, c, n, max(-normal_of(m, touch, c)[0], 0.0))
        return touch.slots[last, AREA] if b >= 0 or _on_wall(touch, c) else 0.0
    here, opposite = pose_of(m, a, _NOWHERE), (-n[0], -n[1], -n[2])
    if b < 0:
        return _against_plane(touch, first, last, here, n, walls[-1 - b, 3])
    there, ramp = pose_of(m, b, by), ramp_of(m, a, b)
    touch.tanks[c, SHARE] = overlap_share(m, a, b, by, n[0], n[1], n[2], 4.0 * ramp)
    share = touch.tanks[c, SHARE] * whole(touch, b)
    total = _in_box(touch, first, middle, here, there, three(m, b, HALF), n, (ramp, share))
    total += _in_box(touch, middle, last, there, here, three(m, a, HALF), opposite, (ramp, share))
    return total + _cross(m, touch, by, c, n, share)


@kernel
def _on_wall(touch, c):
    """Whether what is round touches its wall where there is one."""
    w, last = touch.walls[-1 - touch.pairs[c, B]], touch.pairs[c, LAST]
    x, y, z = three(touch.slots, last, POINT)
    return w[4] <= x <= w[7] and w[5] <= y <= w[8] and w[6] <= z <= w[9]


@kernel
def roundness(m, touch, c):
    """Radius of what is round where pair `c` touches, m: of both 1 / (1/R + 1/S); 0 between faces and edges."""
    a, b = touch.pairs[c, A], touch.pairs[c, B]
    if touch.pairs[c, FEATURE] < ROUND_A:
        return 0.0
    if touch.pairs[c, FEATURE] == ROUND_B:
        return m[b, HALF]
    if b >= 0 and touches_at_one_point(shape_of(m, b)):
        return m[a, HALF] * m[b, HALF] / (m[a, HALF] + m[b, HALF])
    return m[a, HALF]


@kernel
def _spot(m, touch, c, n, depth):
    """Where something round touches, into the last slot of pair `c`: one element `depth` deep.

    Over the circle that a sphere of radius R shares with a plane in it to the depth d, depths sum up to pi R d^2: so
    its area is pi R d.
    """
    pairs, slots = touch.pairs, touch.slots
    body, by, sign = pairs[c, A], _NOWHERE, -1.0
    if pairs[c, FEATURE] == ROUND_B:
        body, by, sign = pairs[c, B], three(touch.shift, c, 0), 1.0
    x, y, z = three(m, body, POSITION)
    arm = sign * (m[body, HALF] - 0.5 * depth)
    x, y, z = x + by[0] + arm * n[0], y + by[1] + arm * n[1], z + by[2] + arm * n[2]
    _set(slots, pairs[c, LAST], depth, math.pi * roundness(m, touch, c) * depth, x, y, z)


@kernel
def whole(touch, b):
    """Weight of the elements of a pair with b: a half each where both have some."""
    return 0.5 if b >= 0 and touch.first[b + 1] > touch.first[b] else 1.0


@kernel
def _against_plane(touch, first, last, here, n, level):
    """Elements `first` to `last` of a body at the pose `here` against a plane: `slots` and the area that touches."""
    elements, marks, slots = touch.elements, touch.marks, touch.slots
    (cx, cy, cz), t = here
    u, v, w = to_body(t, n[0], n[1], n[2])
    height, total = n[0] * cx + n[1] * cy + n[2] * cz - level, 0.0
    for slot in range(first, last):
        i = marks[slot, INDEX]
        x, y, z = elements[i, 0], elements[i, 1], elements[i, 2]
        depth, area = -(height + u * x + v * y + w * z), _seen(elements, i, u, v, w)
        x, y, z = to_global(t, x, y, z)
        depth = depth if area > 0.0 else 0.0  # faces that look away feel nothing, nor have they a friction spring
        _set(slots, slot, depth, area, cx + x, cy + y, cz + z)
        total += area if depth > 0.0 else 0.0
    slots[last, DEPTH] = slots[last, AREA] = 0.0
    return total


@kernel
def _seen(elements, i, u, v, w):
    """Area that element `i` shows against the direction (u, v, w), in its body's frame."""
    return max(-elements[i, 3] * u, 0.0) + max(-elements[i, 4] * v, 0.0) + max(-elements[i, 5] * w, 0.0)


@kernel
def _set(slots, slot, depth, area, x, y, z):
    slots[slot, DEPTH], slots[slot, AREA] = depth, area
    slots[slot, POINT], slots[slot, POINT + 1], slots[slot, POINT + 2] = x, y, z


@kernel
def _in_box(touch, first, last, here, there, edges, n, rim):
    """The same against a box at the pose `there`, depths along `n`; the rim of the contact takes from their area."""
    elements, marks, slots = touch.elements, touch.marks, touch.slots
    (cx, cy, cz), t = here
    (bx, by, bz), s = there
    ramp, share = rim
    u, v, w = to_body(t, n[0], n[1], n[2])
    along, total = to_body(s, n[0], n[1], n[2]), 0.0
    for slot in range(first, last):
        i = marks[slot, INDEX]
        x, y, z = to_global(t, elements[i, 0], elements[i, 1], elements[i, 2])
        x, y, z = cx + x, cy + y, cz + z
        depth, weight = depth_in_box(edges, to_body(s, x - bx, y - by, z - bz), along, ramp)
        area = weight * share * _seen(elements, i, u, v, w)
        _set(slots, slot, depth if area > 0.0 else 0.0, area, x, y, z)
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
    apart = separation(m, a, b, by, feature)[0]
    x, y, z, area, meet = edge_crossing(m, a, b, by, feature, n)
    depth = max(-apart, 0.0) if meet else 0.0
    _set(slots, slot, depth, share * area, x, y, z)
    return share * area if depth > 0.0 else 0.0


@kernel
def show(m, touch, c, n):
    """Area, place and depth 1 of all elements of pair `c` into `slots`, as if all touched; their area, m2.

    What is round is as deep as it is expected to get.
    """
    pairs, shift, slots = touch.pairs, touch.shift, touch.slots
    a, b, by, far = pairs[c, A], pairs[c, B], three(shift, c, 0), 1e9
    first, middle, last = pairs[c, FIRST], pairs[c, MIDDLE], pairs[c, LAST]
    if pairs[c, FEATURE] >= ROUND_A:
        _spot(m, touch, c, n, max(_DEEPEST * roundness(m, touch, c), -normal_of(m, touch, c)[0]))
        return slots[last, AREA]
    _against_plane(touch, first, middle, pose_of(m, a, _NOWHERE), n, far)
    if b >= 0:
        opposite = (-n[0], -n[1], -n[2])
        _against_plane(touch, middle, last, pose_of(m, b, by), opposite, far)
        _cross(m, touch, by, c, n, 1.0)
    share, total = whole(touch, b), 0.0
    for slot in range(first, last + 1):
        slots[slot, DEPTH] = 1.0
        slots[slot, AREA] *= share
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
