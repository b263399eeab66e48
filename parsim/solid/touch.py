"""Geometry of the pairs that may touch: depth, area and place of each of their elements."""

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.search import AREA, DEPTH, FEATURE, FIRST, INDEX, LAST, MIDDLE, POINT, A, B, above
from parsim.solid.separation import depth_in_box, edge_crossing, overlap_share, ramp_of, separation
from parsim.solid.table import HALF, pose_of, three

_NOWHERE = (0.0, 0.0, 0.0)


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

    Elements of either body count half, or the area would count twice; against walls and the gate they count whole.
    """
    walls, pairs, shift = touch.walls, touch.pairs, touch.shift
    a, b, by = pairs[c, A], pairs[c, B], three(shift, c, 0)
    first, middle, last = pairs[c, FIRST], pairs[c, MIDDLE], pairs[c, LAST]
    here, opposite = pose_of(m, a, _NOWHERE), (-n[0], -n[1], -n[2])
    if b < 0:
        return _against_plane(touch, first, last, here, n, walls[-1 - b, 3])
    there, ramp = pose_of(m, b, by), ramp_of(m, a, b)
    share = overlap_share(m, a, b, by, n[0], n[1], n[2], 4.0 * ramp) * whole(m, b)
    total = _in_box(touch, first, middle, here, there, three(m, b, HALF), n, (ramp, share))
    total += _in_box(touch, middle, last, there, here, three(m, a, HALF), opposite, (ramp, share))
    return total + _cross(m, touch, by, c, n, share)


@kernel
def whole(m, b):
    """Weight of the elements of a pair: a half each where both bodies have some."""
    return 0.5 if 0 <= b < len(m) - 1 else 1.0


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
    """Area, place and depth 1 of all elements of pair `c` into `slots`, as if all touched; their area, m2."""
    pairs, shift, slots = touch.pairs, touch.shift, touch.slots
    a, b, by, far = pairs[c, A], pairs[c, B], three(shift, c, 0), 1e9
    first, middle, last = pairs[c, FIRST], pairs[c, MIDDLE], pairs[c, LAST]
    _against_plane(touch, first, middle, pose_of(m, a, _NOWHERE), n, far)
    if b >= 0:
        opposite = (-n[0], -n[1], -n[2])
        _against_plane(touch, middle, last, pose_of(m, b, by), opposite, far)
        _cross(m, touch, by, c, n, 1.0)
    share, total = whole(m, b), 0.0
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
