"""The area in which two flat faces lie on each other, whatever contact elements they have.

Elements tell where and how deep; counted by those that lie within the other body the area is off by up to half their
distance at each side: for bodies of 2 to 5 elements a side 0.84 to 1.8 times what it is. Cut convex outlines by each
other instead (Cyrus & Beck 1978, doi 10.1016/0097-8493(78)90021-3): what is left of the edges of both goes around the
overlap, and Green's theorem gives its area. 0.5 us for two rectangles.
"""

import math

import numpy as np

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.shapes.kernels import LATERAL, corner_of, corners_of, face_along
from parsim.solid.table import pose_of, turn_at

_FLAT = 0.5 * LATERAL  # sine of the angle between a face and the normal up to which it lies flat
_SAME = 1e-9  # of its size, by which an outline is made smaller: edges that coincide count once


@kernel
def faces_of(m, forms, a, b, n):
    """((face of body a, of body b), how flat they lie on each other along the normal `n` from b to a, 0 to 1)."""
    one, slope = face_along(forms, a, to_body(turn_at(m, a), -n[0], -n[1], -n[2]))
    two, other = face_along(forms, b, to_body(turn_at(m, b), n[0], n[1], n[2]))
    least = min(slope, other)
    sine = math.sqrt(max(1.0 - least * least, 0.0)) if least > 0.0 else 1.0
    return (one, two), min(max((LATERAL - sine) / (LATERAL - _FLAT), 0.0), 1.0)


@kernel
def overlap(m, forms, ab, by, n, faces):
    """Area, m2, in which these faces of bodies a and b, moved by `by`, cover each other, seen along `n`."""
    a, b = ab
    u = _across(n)
    v = n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]
    one, two = _outline(m, forms, a, (0.0, 0.0, 0.0), faces[0], u, v), _outline(m, forms, b, by, faces[1], u, v)
    size = math.sqrt(min(abs(_area(one)), abs(_area(two))))
    origin = one[0, 0], one[0, 1]
    return 0.5 * (_around(one, two, _SAME * size, origin) + _around(two, one, -_SAME * size, origin))


@kernel
def _across(n):
    """A unit vector across the unit vector `n`."""
    x, y, z = (0.0, -n[2], n[1]) if abs(n[0]) < 0.6 else (n[2], 0.0, -n[0])
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


@kernel
def _outline(m, forms, b, by, face, u, v):
    """Corners (k, 2), m, of a face of body `b` along `u` and `v`, anticlockwise."""
    place, t = pose_of(m, b, by)
    out = np.empty((corners_of(forms, b, face), 2))
    for k in range(len(out)):
        x, y, z = corner_of(forms, b, face, k)
        x, y, z = to_global(t, x, y, z)
        x, y, z = x + place[0], y + place[1], z + place[2]
        out[k, 0], out[k, 1] = u[0] * x + u[1] * y + u[2] * z, v[0] * x + v[1] * y + v[2] * z
    if _area(out) < 0.0:
        return out[::-1].copy()
    return out


@kernel
def _area(outline):
    """Signed area, m2."""
    total, count = 0.0, len(outline)
    for k in range(count):
        j = k + 1 if k + 1 < count else 0
        total += (outline[k, 0] - outline[0, 0]) * (outline[j, 1] - outline[0, 1])
        total -= (outline[j, 0] - outline[0, 0]) * (outline[k, 1] - outline[0, 1])
    return 0.5 * total


@kernel
def _around(cut, other, more, origin):
    """Twice the area, m2, that the parts of the edges of `cut` sweep about `origin`, within `other` and `more`, m,
    around it."""
    total, (ox, oy) = 0.0, origin
    for k in range(len(cut)):
        j = k + 1 if k + 1 < len(cut) else 0
        px, py = cut[k, 0] - ox, cut[k, 1] - oy
        dx, dy = cut[j, 0] - cut[k, 0], cut[j, 1] - cut[k, 1]
        low, high = 0.0, 1.0
        for i in range(len(other)):
            h = i + 1 if i + 1 < len(other) else 0
            ex, ey = other[h, 0] - other[i, 0], other[h, 1] - other[i, 1]
            length = math.sqrt(ex * ex + ey * ey)
            room = (ex * (py + oy - other[i, 1]) - ey * (px + ox - other[i, 0])) + more * length
            slope = ex * dy - ey * dx
            if slope > 0.0:
                low = max(low, -room / slope)
            elif slope < 0.0:
                high = min(high, -room / slope)
            elif room < 0.0:
                high = -1.0
        if low < high:
            total += (high - low) * (px * dy - py * dx)
    return total
