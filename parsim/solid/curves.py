"""How what touches is curved, and how large an area stands for it."""

import math

from parsim.geometry.rotation import to_body
from parsim.machine.jit import kernel
from parsim.solid.laws.law import FLAT, LINE, SPOT
from parsim.solid.shapes.kernels import along_side, curvature_radius, touches_along_a_line
from parsim.solid.table import shape_of, turn_at

_ON_END = 0.5  # sine of the angle from its axis below which a body touches with its end, not with its curved side
_PARALLEL = 0.99  # cosine of the angle between cylinders that touch along a line


@kernel
def curve_of(m, forms, a, b, n):
    """(FLAT, LINE or SPOT; radius, m, of both 1 / (1/R + 1/S)) of what touches along the normal `n`."""
    one = radius_of(m, forms, a, n)
    two = radius_of(m, forms, b, n) if b >= 0 else 0.0
    if one == 0.0 and two == 0.0:
        return FLAT, 0.0
    radius = one * two / (one + two) if one > 0.0 and two > 0.0 else one + two
    line = (one == 0.0 or touches_along_a_line(shape_of(m, a))) and (two == 0.0 or touches_along_a_line(shape_of(m, b)))
    if line and one > 0.0 and two > 0.0 and not forms.planar:
        s, t = turn_at(m, a), turn_at(m, b)
        line = abs(s[2] * t[2] + s[5] * t[5] + s[8] * t[8]) > _PARALLEL
    return (LINE if line else SPOT), radius


@kernel
def radius_of(m, forms, b, n):
    """Radius of what body `b` has of round where the normal is `n`, m; 0 at its faces and edges."""
    if along_side(shape_of(m, b)) > 0:
        x, y, _ = to_body(turn_at(m, b), n[0], n[1], n[2])
        if x * x + y * y < _ON_END * _ON_END:
            return 0.0
    return curvature_radius(forms, b)


@kernel
def spot_area(curve, deep):
    """Area, m2, by which the depth at its middle gives the depths summed over what something round has in a face.

    A sphere of radius R to the depth d pi R d, for its depths sum up to pi R d^2; a metre of a cylinder has
    4/3 sqrt(2 R d).
    """
    bend, radius = curve
    deep = max(deep, 0.0)
    return 4.0 / 3.0 * math.sqrt(2.0 * radius * deep) if bend == LINE else math.pi * radius * deep
