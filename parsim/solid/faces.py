"""Contact elements of a body against a plane, and against another body: depth, area and place of each."""

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.curves import spot_area
from parsim.solid.laws.law import FLAT, LINE
from parsim.solid.overlap import flatness, in_plane, room_in
from parsim.solid.search import AREA, DEPTH, INDEX, POINT
from parsim.solid.shapes.facets import corner_of, face_along, normal_of_face
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
_SAME = 1.0 - 1e-9  # square of the cosine from which an element belongs to a face


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
    own, slope = face_along(touch.forms, body, (-u, -v, -w))
    flat = flatness(slope)
    look = normal_of_face(touch.forms, body, own) if flat > 0.0 else (0.0, 0.0, 0.0)
    height, total, line = n[0] * cx + n[1] * cy + n[2] * cz - level, 0.0, whole_side(touch.forms, body)
    for slot in range(first, last):
        i = marks[slot, INDEX]
        if i >= 0:
            x, y, z = elements[i, 0], elements[i, 1], elements[i, 2]
            deep = -(height + u * x + v * y + w * z)
            area = 0.0
            if deep > 0.0 and curve[0] == FLAT:
                area = (1.0 - flat) * facing(elements, i, box, (-u, -v, -w))
                area += flat * slope * _of_face(elements, i, box, look)
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
    """The same against another body, depths along `n`; elements at the rim of the contact count less.

    `which`: (first, last, body, other); `by`: how far the two are moved; `rim`: width, m, of the rim, share of all, the
    same of a narrow contact, how deep the pair is, m, its `overlap.Faces`, to whose moments it adds, whether the body
    is their second. Where two faces lie on each other their own elements count, as far as they are beside the other
    face and as deep as that is along `n`. What lies above the other along `n` is not in it: most elements, and told by
    one product; the others take 0.1 us.
    """
    marks, slots, elements = touch.marks, touch.slots, touch.elements
    first, last, body, other = which
    (cx, cy, cz), t = pose_of(m, body, by[0])
    (bx, by_, bz), s = pose_of(m, other, by[1])
    (ramp, share, narrow, deepest, faces, second), box = rim, is_box(shape_of(m, body))
    u, v, w = to_body(t, n[0], n[1], n[2])
    along, total, flat = to_body(s, n[0], n[1], n[2]), 0.0, faces.flat
    top = n[0] * (bx - cx) + n[1] * (by_ - cy) + n[2] * (bz - cz) + reach(touch.forms, other, along)
    line = whole_side(touch.forms, body)
    if curve[0] == LINE and along_side(shape_of(m, body)) > 1:
        line = beside(touch.forms, (body, other), ((cx - bx, cy - by_, cz - bz), t, s), (-u, -v, -w), line)[0]
    look, under = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
    if flat > 0.0:
        own, opposite = (faces.two, faces.one) if second else (faces.one, faces.two)
        look, under = normal_of_face(touch.forms, body, own), _plane(touch.forms, other, opposite, along)
    for slot in range(first, last):
        i, area, face, flush = marks[slot, INDEX], 0.0, 0.0, 0.0
        if i < 0:
            (x, y, z), area = on_side(touch.forms, body, -2 - i, (-u, -v, -w), line)
        else:
            x, y, z = elements[i, 0], elements[i, 1], elements[i, 2]
            if flat < 1.0 and curve[0] == FLAT and u * x + v * y + w * z < top:
                area = facing(elements, i, box, (-u, -v, -w))
            if flat > 0.0:
                face = -_of_face(elements, i, box, look) * (look[0] * u + look[1] * v + look[2] * w)
        if area == 0.0 and face == 0.0:
            slots[slot, DEPTH] = slots[slot, AREA] = 0.0
            continue
        x, y, z = to_global(t, x, y, z)
        x, y, z = cx + x, cy + y, cz + z
        own_x, own_y, own_z = to_body(s, x - bx, y - by_, z - bz)
        deep = 0.0
        if area > 0.0:
            deep, weight = depth(touch.forms, other, (own_x, own_y, own_z), along, ramp)
            if i < 0:
                area *= _of_side(m, body, curve, deep)
            area *= share * narrow * weight * (1.0 - flat) if deep > 0.0 else 0.0
        if face > 0.0:
            p, q = in_plane(faces.axes, x, y, z)
            outline = faces.outline if second else faces.other
            face *= share * min(max(1.0 + room_in(outline, p, q) / ramp, 0.0), 1.0)
            _add(faces.moments, face, p, q)
            flush = under[3] - under[0] * own_x - under[1] * own_y - under[2] * own_z
            if face > 0.0 and flush > 0.0:
                more, whole = flat * face, area + flat * face
                deep, area = (area * deep + more * min(flush, deepest)) / whole, whole
        note(slots, slot, deep if area > 0.0 else 0.0, area, x, y, z)
        total += area
    return total


@kernel
def _add(moments, area, p, q):
    """Add an area at (p, q) to moments: see `overlap.Faces`."""
    moments[0] += area
    moments[1] += area * p
    moments[2] += area * q
    moments[3] += area * p * p
    moments[4] += area * p * q
    moments[5] += area * q * q


@kernel
def _plane(forms, b, face, along):
    """The plane of a face of body `b` (normal, level), of such length that a point's level is told along `along`."""
    n, p = normal_of_face(forms, b, face), corner_of(forms, b, face, 0)
    cosine = n[0] * along[0] + n[1] * along[1] + n[2] * along[2]
    x, y, z = n[0] / cosine, n[1] / cosine, n[2] / cosine
    return x, y, z, x * p[0] + y * p[1] + z * p[2]


@kernel
def _of_face(elements, i, box, look):
    """Area, m2, of element `i` in the face whose normal is `look` (3,), in the body's frame."""
    x, y, z = elements[i, 3], elements[i, 4], elements[i, 5]
    along = x * look[0] + y * look[1] + z * look[2]
    return along if along > 0.0 and (box or along * along > _SAME * (x * x + y * y + z * z)) else 0.0


@kernel
def beside(forms, pair, pose, d, whole):
    """(from where to where, m, along the axis of a cylinder its line farthest along `d` (3,) is in another body, and
    whether it is at all).

    `pair`: the cylinder and the other; `pose`: place of the cylinder from the other, rotation matrices of both. Where
    the line misses the other, what the other reaches along the axis.
    """
    (body, other), (at, t, s), (low, high) = pair, pose, whole
    (x, y, z), _ = on_side(forms, body, 0, d, whole)
    x, y, z = to_global(t, x, y, z)
    start, axis = to_body(s, at[0] + x, at[1] + y, at[2] + z), to_body(s, t[2], t[5], t[8])
    back, length = (-axis[0], -axis[1], -axis[2]), high - low
    enter = ahead(forms, other, start, axis, 0.0)
    if enter < length:
        end = start[0] + length * axis[0], start[1] + length * axis[1], start[2] + length * axis[2]
        leave = length - ahead(forms, other, end, back, 0.0)
        return (low + enter, low + max(enter, leave)), True
    x, y, z = to_body(s, at[0], at[1], at[2])
    middle = -(x * axis[0] + y * axis[1] + z * axis[2])
    far = min(max(middle + reach(forms, other, axis), low), high)
    return (min(max(middle - reach(forms, other, back), low), far), far), False
