"""Contacts of meshes, which may be hollow: each element has the normal of the surface that it is behind."""

import math

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.faces import facing, note
from parsim.solid.search import AREA, DEPTH, INDEX, NORMAL
from parsim.solid.shapes.kernels import distance, is_box
from parsim.solid.table import pose_of, shape_of


@kernel
def in_field(m, touch, which, by, share):
    """Elements first to last of a body in another, each with the normal there: into `slots`; the area that touches, m2.

    `which`: (first, last, body, other); `by`: how far the two are moved; share: of their area, negative for those of b,
    as normals point to a.
    """
    marks, slots, (first, last, body, other), total = touch.marks, touch.slots, which, 0.0
    (cx, cy, cz), t = pose_of(m, body, by[0])
    (bx, by_, bz), s = pose_of(m, other, by[1])
    sign, box = (1.0 if share > 0.0 else -1.0), is_box(shape_of(m, body))
    for slot in range(first, last):
        if marks[slot, INDEX] < 0:
            slots[slot, DEPTH] = slots[slot, AREA] = 0.0
            continue  # points that move along a curved side; the corners of the mesh feel that
        i = marks[slot, INDEX]
        x, y, z = to_global(t, touch.elements[i, 0], touch.elements[i, 1], touch.elements[i, 2])
        x, y, z = cx + x, cy + y, cz + z
        high, n = distance(touch.forms, other, to_body(s, x - bx, y - by_, z - bz))
        n = to_global(s, n[0], n[1], n[2])
        look = to_body(t, -n[0], -n[1], -n[2])
        area = abs(share) * facing(touch.elements, i, box, look) if high < 0.0 else 0.0
        note(slots, slot, -high if area > 0.0 else 0.0, area, x, y, z)
        for k in range(3):
            slots[slot, NORMAL + k] = sign * n[k]
        total += area
    return total


@kernel
def normal_by_elements(slots, first, last, n):
    """Mean of the normals of the elements that touch, by area and depth; `n` (3,) where that is none."""
    x, y, z = 0.0, 0.0, 0.0
    for slot in range(first, last + 1):
        if slots[slot, DEPTH] > 0.0:
            by = slots[slot, DEPTH] * slots[slot, AREA]
            x, y, z = x + by * slots[slot, NORMAL], y + by * slots[slot, NORMAL + 1], z + by * slots[slot, NORMAL + 2]
    size = math.sqrt(x * x + y * y + z * z)
    return (x / size, y / size, z / size) if size > 0.0 else n
