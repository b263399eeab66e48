"""Two flat faces that lie on each other: what of them touches, whatever contact elements they have.

Elements tell how deep; counted by those within the other body their area is off by up to half their distance at each
side: for bodies of 2 to 5 elements a side 0.84 to 1.8 times what it is. Their areas are therefore weighted so that they
have the area of the overlap, and its centre as far as none of them comes to pull. That comes from cutting convex
outlines by each other (Cyrus & Beck 1978, doi 10.1016/0097-8493(78)90021-3): what is left of the edges of both goes
around the overlap, and Green's theorem gives its moments. 1 us for two rectangles, of 4 that their pair takes.
"""

import math
from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.search import AREA, DEPTH, POINT
from parsim.solid.shapes.facets import corner_of, corners_of, face_along
from parsim.solid.shapes.kernels import LATERAL
from parsim.solid.table import POSITION, pose_of, turn_at

_FLAT = 0.5 * LATERAL  # sine of the angle between a face and the normal up to which it lies flat
_SAME = 1e-9  # of its size, by which one outline is made larger, the other smaller: edges that coincide count once
_EVEN = 1e-6  # ratio of the axes of an area below which it is a line; of its spread, below which it is a point
_SUMS = 6  # area and its first and second moments


class Faces(NamedTuple):
    """Of a pair: how flat two faces lie on each other, 1, or 0: no way; numbers of the faces of a and b; axes (3, 3)
    of their plane: origin, m, and two unit vectors; along these the outlines of both (k, 4): corners, m, and unit
    normals inwards, anticlockwise; area and moments (6,), m2 to m4, of the elements beside the other face."""

    flat: float
    one: int
    two: int
    axes: np.ndarray
    outline: np.ndarray
    other: np.ndarray
    moments: np.ndarray


@kernel
def faces_of(m, forms, ab, by, n, wanted):
    """The `Faces` of bodies a and b, moved by `by`, that look along `n`, the normal from b to a; none unless wanted."""
    a, b = ab
    axes, moments, flat, one, two = np.empty((3, 3)), np.zeros(_SUMS), 0.0, -1, -1
    if wanted:
        one, slope = face_along(forms, a, to_body(turn_at(m, a), -n[0], -n[1], -n[2]))
        two, steep = face_along(forms, b, to_body(turn_at(m, b), n[0], n[1], n[2]))
        flat = flatness(min(slope, steep))
    if flat == 0.0:
        return Faces(0.0, one, two, axes, np.empty((0, 4)), np.empty((0, 4)), moments)
    x, y, z = (0.0, -n[2], n[1]) if abs(n[0]) < 0.6 else (n[2], 0.0, -n[0])
    length = math.sqrt(x * x + y * y + z * z)
    axes[1, 0], axes[1, 1], axes[1, 2] = x / length, y / length, z / length
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        axes[0, k], axes[2, k] = m[a, POSITION + k], n[i] * axes[1, j] - n[j] * axes[1, i]
    outline, other = _outline(m, forms, a, (0.0, 0.0, 0.0), one, axes), _outline(m, forms, b, by, two, axes)
    return Faces(flat, one, two, axes, outline, other, moments)


@kernel
def flatness(cosine):
    """How flat a face lies that looks at this cosine along a normal."""
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0)) if cosine > 0.0 else 1.0
    return min(max((LATERAL - sine) / (LATERAL - _FLAT), 0.0), 1.0)


@kernel
def in_plane(axes, x, y, z):
    """The place (x, y, z) along the axes of a plane, two numbers, m."""
    x, y, z = x - axes[0, 0], y - axes[0, 1], z - axes[0, 2]
    return axes[1, 0] * x + axes[1, 1] * y + axes[1, 2] * z, axes[2, 0] * x + axes[2, 1] * y + axes[2, 2] * z


@kernel
def room_in(outline, p, q):
    """Distance, m, of a point from the nearest edge of an outline around it; negative outside."""
    least = math.inf
    for k in range(len(outline)):
        least = min(least, (p - outline[k, 0]) * outline[k, 2] + (q - outline[k, 1]) * outline[k, 3])
    return least


@kernel
def fit(slots, first, last, faces):
    """Weigh the areas of the elements first to last, of both faces, by the overlap of these; their area then, m2."""
    sums, exact, total = faces.moments, np.zeros(3), 0.0
    _around(faces.outline, faces.other, _SAME, exact)
    _around(faces.other, faces.outline, -_SAME, exact)
    even = exact[0] / sums[0] if exact[0] > 0.0 < sums[0] else 0.0
    p, q = sums[1] / max(sums[0], 1e-300), sums[2] / max(sums[0], 1e-300)
    slope_p, slope_q = 0.0, 0.0
    if even > 0.0:
        pp, pq, qq = sums[3] / sums[0] - p * p, sums[4] / sums[0] - p * q, sums[5] / sums[0] - q * q
        if pp + qq > _EVEN * exact[0]:
            slope_p, slope_q = _slopes(exact[1] / exact[0] - p, exact[2] / exact[0] - q, pp, pq, qq)
    least = 0.0
    for slot in range(first, last):
        if slots[slot, DEPTH] > 0.0:
            u, v = in_plane(faces.axes, slots[slot, POINT], slots[slot, POINT + 1], slots[slot, POINT + 2])
            least = min(least, slope_p * (u - p) + slope_q * (v - q))
    share = min(-1.0 / least, 1.0) if least < 0.0 else 1.0  # none pulls
    for slot in range(first, last):
        if slots[slot, DEPTH] > 0.0:
            u, v = in_plane(faces.axes, slots[slot, POINT], slots[slot, POINT + 1], slots[slot, POINT + 2])
            weight = even * max(1.0 + share * (slope_p * (u - p) + slope_q * (v - q)), 0.0)
            slots[slot, AREA] *= 1.0 + faces.flat * (weight - 1.0)
            if slots[slot, AREA] == 0.0:
                slots[slot, DEPTH] = 0.0
            total += slots[slot, AREA]
    return total


@kernel
def _slopes(p, q, pp, pq, qq):
    """By how much weights grow along both axes, 1/m, to move a centre by (p, q), m; pp, pq, qq: central moments, m2."""
    det, trace = pp * qq - pq * pq, pp + qq
    if det > _EVEN * trace * trace:
        return (qq * p - pq * q) / det, (pp * q - pq * p) / det
    return (p / pp, 0.0) if pp > qq else (0.0, q / qq)


@kernel
def _outline(m, forms, b, by, face, axes):
    """The outline of a face of body `b` moved by `by`: see `Faces`."""
    place, t = pose_of(m, b, by)
    count = corners_of(forms, b, face)
    out, turns = np.empty((count, 4)), 0.0
    for k in range(count):
        x, y, z = corner_of(forms, b, face, k)
        x, y, z = to_global(t, x, y, z)
        out[k, 0], out[k, 1] = in_plane(axes, x + place[0], y + place[1], z + place[2])
        if k > 1:
            x, y, z, w = (
                out[k - 1, 0] - out[0, 0],
                out[k - 1, 1] - out[0, 1],
                out[k, 0] - out[0, 0],
                out[k, 1] - out[0, 1],
            )
            turns += x * w - y * z
    if turns < 0.0:
        out = out[::-1].copy()
    for k in range(count):
        j = k + 1 if k + 1 < count else 0
        x, y = out[j, 0] - out[k, 0], out[j, 1] - out[k, 1]
        length = math.sqrt(x * x + y * y)
        out[k, 2], out[k, 3] = -y / length, x / length
    return out


@kernel
def _around(cut, other, more, sums):
    """Add to `sums` (3,) what the edges of `cut` within `other` bring to the overlap's area and first moments, m2, m3.

    `more`: share of its size by which `other` is taken for larger.
    """
    count = len(other)
    size = max(abs(other[count // 2, 0] - other[0, 0]), abs(other[count // 2, 1] - other[0, 1]))
    for k in range(len(cut)):
        j = k + 1 if k + 1 < len(cut) else 0
        dx, dy = cut[j, 0] - cut[k, 0], cut[j, 1] - cut[k, 1]
        low, high = 0.0, 1.0
        for i in range(count):
            room = (cut[k, 0] - other[i, 0]) * other[i, 2] + (cut[k, 1] - other[i, 1]) * other[i, 3] + more * size
            slope = dx * other[i, 2] + dy * other[i, 3]
            if slope > 0.0:
                low = max(low, -room / slope)
            elif slope < 0.0:
                high = min(high, -room / slope)
            elif room < 0.0:
                high = -1.0
        if low < high:
            px, py = cut[k, 0] + low * dx, cut[k, 1] + low * dy
            qx, qy = cut[k, 0] + high * dx, cut[k, 1] + high * dy
            cross = 0.5 * (px * qy - qx * py)
            sums[0] += cross
            sums[1] += cross * (px + qx) / 3.0
            sums[2] += cross * (py + qy) / 3.0
