"""Contact elements of a body against a plane, and against another body: depth, area and place of each."""

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.curves import spot_area
from parsim.solid.laws.law import FLAT, LINE
from parsim.solid.search import AREA, DEPTH, INDEX, POINT
from parsim.solid.shapes.kernels import (
    ahead,
    along_side,
    depth,
    is_box,
    on_side,
    reach,
    touches_along_a_line,
    whole_side,
)
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
    height, total, line = n[0] * cx + n[1] * cy + n[2] * cz - level, 0.0, whole_side(touch.forms, body)
    for slot in range(first, last):
        i = marks[slot, INDEX]
        if i >= 0:
            x, y, z = elements[i, 0], elements[i, 1], elements[i, 2]
            deep = -(height + u * x + v * y + w * z)
            area = facing(elements, i, box, (-u, -v, -w)) if deep > 0.0 and curve[0] == FLAT else 0.0
        else:
            (x, y, z), area = on_side(touch.forms, body, -2 - i, (-u, -v, -w), line)
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
    """The same against another body, depths along `n`: (the area that touches, what of their face is beside the other).

    `which`: (first, last, body, other); `by`: how far the two are moved; `rim`: width, m, over which elements at the
    rim of the contact count less, share of all, and how flat two faces lie on each other (`overlap.faces_of`). Both
    areas, m2, by their elements. What lies above the other along `n` is not in it: most elements, and told by one
    product; the others take 0.1 us.
    """
    marks, slots, elements = touch.marks, touch.slots, touch.elements
    first, last, body, other = which
    (cx, cy, cz), t = pose_of(m, body, by[0])
    (bx, by_, bz), s = pose_of(m, other, by[1])
    (ramp, share, flat), box = rim, is_box(shape_of(m, body))
    u, v, w = to_body(t, n[0], n[1], n[2])
    along, total, shown = to_body(s, n[0], n[1], n[2]), 0.0, 0.0
    top = n[0] * (bx - cx) + n[1] * (by_ - cy) + n[2] * (bz - cz) + reach(touch.forms, other, along)
    line = whole_side(touch.forms, body)
    if curve[0] == LINE and along_side(shape_of(m, body)) > 1:
        line = _beside(touch.forms, which, ((cx - bx, cy - by_, cz - bz), t, s), (-u, -v, -w), line)
    for slot in range(first, last):
        i, area, face = marks[slot, INDEX], 0.0, 0.0
        if i < 0:
            (x, y, z), area = on_side(touch.forms, body, -2 - i, (-u, -v, -w), line)
        else:
            x, y, z = elements[i, 0], elements[i, 1], elements[i, 2]
            if curve[0] == FLAT and (flat > 0.0 or u * x + v * y + w * z < top):
                area = facing(elements, i, box, (-u, -v, -w))
                face = _of_face(elements, i, box, (-u, -v, -w)) if flat > 0.0 else 0.0
        if area == 0.0:
            slots[slot, DEPTH] = slots[slot, AREA] = 0.0
            continue
        x, y, z = to_global(t, x, y, z)
        x, y, z = cx + x, cy + y, cz + z
        deep, weight = depth(touch.forms, other, to_body(s, x - bx, y - by_, z - bz), along, ramp)
        if i < 0:
            area *= _of_side(m, body, curve, deep)
        shown += weight * share * face
        area = weight * share * area if deep > 0.0 else 0.0
        note(slots, slot, deep if area > 0.0 else 0.0, area, x, y, z)
        total += area
    return total, shown


@kernel
def _of_face(elements, i, box, d):
    """What `facing` says, of the face alone that looks most along `d`."""
    x, y, z = elements[i, 3] * d[0], elements[i, 4] * d[1], elements[i, 5] * d[2]
    if box:
        p, q, r = abs(d[0]), abs(d[1]), abs(d[2])
        return max(x if p > max(q, r) else (y if q > r else z), 0.0)
    size = elements[i, 3] ** 2 + elements[i, 4] ** 2 + elements[i, 5] ** 2
    return x + y + z if x + y + z > 0.0 and (x + y + z) ** 2 > 0.9 * size else 0.0


@kernel
def _beside(forms, which, pose, d, whole):
    """From where to where, m, along the axis of a cylinder its line farthest along `d` (3,) is in the other body.

    `pose`: place of the cylinder from the other, rotation matrices of both. Where the line misses the other, what the
    other reaches along the axis.
    """
    (_, _, body, other), (at, t, s) = which, pose
    low, high = whole
    (x, y, z), _ = on_side(forms, body, 0, d, whole)
    x, y, z = to_global(t, x, y, z)
    start, axis = to_body(s, at[0] + x, at[1] + y, at[2] + z), to_body(s, t[2], t[5], t[8])
    back, length = (-axis[0], -axis[1], -axis[2]), high - low
    enter = ahead(forms, other, start, axis, 0.0)
    if enter < length:
        end = start[0] + length * axis[0], start[1] + length * axis[1], start[2] + length * axis[2]
        leave = length - ahead(forms, other, end, back, 0.0)
        return low + enter, low + max(enter, leave)
    x, y, z = to_body(s, at[0], at[1], at[2])
    middle = -(x * axis[0] + y * axis[1] + z * axis[2])
    far = min(max(middle + reach(forms, other, axis), low), high)
    return min(max(middle - reach(forms, other, back), low), far), far
