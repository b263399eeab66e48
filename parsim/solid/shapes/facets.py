"""Flat faces of shapes by number: of a box 2 axis + (1 if it looks ahead), of others 0 and 1 the ends, 2 + k side k."""

import math

from parsim.machine.jit import kernel
from parsim.solid.shapes import box, cylinder, dilated_disc, disc, mesh, polygon, sphere
from parsim.solid.shapes.kernels import half_of, sides_of

_BOX, _SPHERE, _DISC = box.BoxShape.NUMBER, sphere.SphereShape.NUMBER, disc.DiscShape.NUMBER
_POLYGON, _CYLINDER = polygon.PolygonShape.NUMBER, cylinder.CylinderShape.NUMBER
_DILATED, _MESH = dilated_disc.DilatedDiscShape.NUMBER, mesh.MeshShape.NUMBER
_START, _LENGTH = polygon.START, polygon.LENGTH
_AROUND = 24  # corners of what is round
_EVEN = math.sqrt(2.0 * math.pi / (_AROUND * math.sin(2.0 * math.pi / _AROUND)))  # of its radius: area of the circle


@kernel
def face_along(forms, b, d):
    """(number of the flat face of body `b` that looks most along the unit vector `d` (3,), cosine of the angle); -1, 0
    of what has none, nor of a mesh."""
    shape = forms.shape[b]
    if shape == _BOX:
        a = 0
        for k in range(1, 3):
            if abs(d[k]) > abs(d[a]):
                a = k
        return 2 * a + (1 if d[a] > 0.0 else 0), abs(d[a])
    face, cosine = (1 if d[2] > 0.0 else 0), abs(d[2])
    if shape == _CYLINDER or shape == _DILATED:
        return face, cosine
    if shape == _SPHERE or shape == _DISC or shape == _MESH:
        return -1, 0.0
    sides, across = sides_of(forms, b), d[1]
    if shape == _POLYGON:
        face, cosine, across = -1, 0.0, d[2]
    for k in range(len(sides)):
        along = sides[k, 0] * d[0] + sides[k, 1] * across
        if along > cosine:
            face, cosine = 2 + k, along
    return face, cosine


@kernel
def normal_of_face(forms, b, face):
    """Outward unit normal (3,) of such a face."""
    if forms.shape[b] == _BOX:
        ahead = 1.0 if face % 2 else -1.0
        return (ahead, 0.0, 0.0) if face < 2 else ((0.0, ahead, 0.0) if face < 4 else (0.0, 0.0, ahead))
    if face < 2:
        return 0.0, 0.0, (1.0 if face == 1 else -1.0)
    u, v = sides_of(forms, b)[face - 2, 0], sides_of(forms, b)[face - 2, 1]
    return (u, 0.0, v) if forms.shape[b] == _POLYGON else (u, v, 0.0)


@kernel
def faces_from(forms, b):
    """(first flat face of body `b`, the one behind the last); a cylinder has its side after its ends."""
    shape = forms.shape[b]
    if shape == _SPHERE or shape == _DISC or shape == _MESH:
        return 0, 0
    if shape == _BOX:
        return 0, 6
    if shape == _CYLINDER or shape == _DILATED:
        return 0, 3 if shape == _CYLINDER else 2
    return (2 if shape == _POLYGON else 0), 2 + len(sides_of(forms, b))


@kernel
def normal_towards(forms, b, face, d):
    """The normal of a face of `faces_from`; of a cylinder's side that which looks most along `d` (3,)."""
    if forms.shape[b] != _CYLINDER or face < 2:
        return normal_of_face(forms, b, face)
    across = math.sqrt(d[0] * d[0] + d[1] * d[1])
    return (d[0] / across, d[1] / across, 0.0) if across > 0.0 else (1.0, 0.0, 0.0)


@kernel
def corners_of(forms, b, face):
    """How many corners such a face has; those that are round have a polygon of the same area."""
    shape = forms.shape[b]
    if shape == _CYLINDER or shape == _DILATED:
        return _AROUND
    return 4 if shape == _BOX or face > 1 else len(sides_of(forms, b))


@kernel
def corner_of(forms, b, face, k):
    """Corner `k` of such a face, in the order of its outline, m."""
    shape, half = forms.shape[b], half_of(forms, b)
    if shape == _BOX:
        ahead, one, two = (1.0 if face % 2 else -1.0), (1.0 if k in (0, 3) else -1.0), (1.0 if k < 2 else -1.0)
        if face < 2:
            return ahead * half[0], one * half[1], two * half[2]
        if face < 4:
            return one * half[0], ahead * half[1], two * half[2]
        return one * half[0], two * half[1], ahead * half[2]
    end = half[2] if face == 1 else -half[2]
    if shape == _CYLINDER or shape == _DILATED:
        angle = 2.0 * math.pi * k / _AROUND
        radius = _EVEN * (half[0] - (half[2] if shape == _DILATED else 0.0))
        return radius * math.cos(angle), radius * math.sin(angle), end
    sides = sides_of(forms, b)
    if face < 2:
        return sides[k, _START], sides[k, _START + 1], end
    u, v = sides[face - 2, _START], sides[face - 2, _START + 1]
    if k in (1, 2):
        u, v = u - sides[face - 2, 1] * sides[face - 2, _LENGTH], v + sides[face - 2, 0] * sides[face - 2, _LENGTH]
    if shape == _POLYGON:
        return u, (half[1] if k > 1 else -half[1]), v
    return u, v, (half[2] if k > 1 else -half[2])
