"""Contact elements of a body against a plane, and against another body: depth, area and place of each."""

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.curves import spot_area
from parsim.solid.laws.law import FLAT, LINE
from parsim.solid.search import AREA, DEPTH, INDEX, POINT
from parsim.solid.shapes.kernels import depth, is_box, on_side, reach, touches_along_a_line
from parsim.solid.table import pose_of, shape_of

EXPECTED = 0.1  # of its radius, that something round is expected to be pressed in; its stiffness grows with the depth
_ANY = 1e8  # m: a plane that high is touched by all


@kernel
def facing(elements, i, box, d):
    """Area, m2, that element `i` shows along the unit vector `d` (3,), in the body's frame."""
    x, y, z = elements[i, 3] * d[0], elements[i, 4] * d[1], elements[i, 5] * d[2]
    if box:  # three faces in one element
        return max(x, 0.0) + max(y, 0.0) + max(z, 0.0)
    return max(x + y + z, 0.0)


@kernel
def note(slots, slot, deep, area, x, y, z):
    """Depth, m, area, m2, and place of one element."""
    slots[slot, DEPTH], slots[slot, AREA] = deep, area
    slots[slot, POINT], slots[slot, POINT + 1], slots[slot, POINT + 2] = x, y, z


@kernel
def _of_side(m, body, curve, deep):
    """What a point along the curved side of a body stands for, m2 or m2/m; lines that cross have a spot."""
    return spot_area(curve, deep) if touches_along_a_line(shape_of(m, body)) == (curve[0] == LINE) else 0.0


@kernel
def against_plane(m, touch, which, by, n, level, curve):
    """Elements first to last of a body moved by `by` against a plane: `slots` and the area that touches, m2.

    `which`: (first, last, body); a level of 1e9 m and more is touched by all, expected depth of what is round.
    """
    marks, slots, elements = touch.marks, touch.slots, touch.elements
    first, last, body = which
    box, ((cx, cy, cz), t) = is_box(shape_of(m, body)), pose_of(m, body, by)
    u, v, w = to_body(t, n[0], n[1], n[2])
    height, total = n[0] * cx + n[1] * cy + n[2] * cz - level, 0.0
    for slot in range(first, last):
        i = marks[slot, INDEX]
        if i >= 0:
            x, y, z = elements[i, 0], elements[i, 1], elements[i, 2]
            deep = -(height + u * x + v * y + w * z)
            area = facing(elements, i, box, (-u, -v, -w)) if deep > 0.0 and curve[0] == FLAT else 0.0
        else:
            (x, y, z), area = on_side(touch.forms, body, -2 - i, (-u, -v, -w))
            deep = -(height + u * x + v * y + w * z)
            area *= _of_side(m, body, curve, min(deep, EXPECTED * curve[1]) if level > _ANY else deep)
        x, y, z = to_global(t, x, y, z)
        deep = deep if area > 0.0 else 0.0  # faces that look away feel nothing, nor have they a friction spring
        note(slots, slot, deep, area, cx + x, cy + y, cz + z)
        total += area if deep > 0.0 else 0.0
    slots[last, DEPTH] = slots[last, AREA] = 0.0
    return total


@kernel
def within(m, touch, which, by, n, rim, curve):
    """The same against another body, depths along `n`; the rim of the contact takes from their area.

    `which`: (first, last, body, other); `by`: how far the two are moved. What lies above the other along `n` is not in
    it: most elements, and told by one product; the others take 0.1 us.
    """
    marks, slots, elements = touch.marks, touch.slots, touch.elements
    first, last, body, other = which
    (cx, cy, cz), t = pose_of(m, body, by[0])
    (bx, by_, bz), s = pose_of(m, other, by[1])
    (ramp, share), box = rim, is_box(shape_of(m, body))
    u, v, w = to_body(t, n[0], n[1], n[2])
    along, total = to_body(s, n[0], n[1], n[2]), 0.0
    top = n[0] * (bx - cx) + n[1] * (by_ - cy) + n[2] * (bz - cz) + reach(touch.forms, other, along)
    for slot in range(first, last):
        i, area = marks[slot, INDEX], 0.0
        if i < 0:
            (x, y, z), area = on_side(touch.forms, body, -2 - i, (-u, -v, -w))
        else:
            x, y, z = elements[i, 0], elements[i, 1], elements[i, 2]
            if curve[0] == FLAT and u * x + v * y + w * z < top:
                area = facing(elements, i, box, (-u, -v, -w))
        if area == 0.0:
            slots[slot, DEPTH] = slots[slot, AREA] = 0.0
            continue
        x, y, z = to_global(t, x, y, z)
        x, y, z = cx + x, cy + y, cz + z
        deep, weight = depth(touch.forms, other, to_body(s, x - bx, y - by_, z - bz), along, ramp)
        if i < 0:
            area *= _of_side(m, body, curve, deep)
        area = weight * share * area
        note(slots, slot, deep if area > 0.0 else 0.0, area, x, y, z)
        total += area
    return total
