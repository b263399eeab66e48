"""What kernels ask of a body's shape, chosen by its number, in the body's frame; forms: see `forms.Forms`."""

import math

from parsim.geometry.field import field_ahead, field_distance
from parsim.machine.jit import kernel
from parsim.solid.shapes import SHAPES, box, cylinder, dilated_disc, disc, mesh, polygon, prism, sphere, stood

LATERAL = 0.1  # cosine below which a face lies along a direction and does not bound the depth

_in_disc, _in_polygon = kernel(disc.flat_distance), kernel(polygon.flat_distance)
_across_disc, _across_polygon = kernel(disc.flat_crossing), kernel(polygon.flat_crossing)
_reach_polygon, _core_polygon, _core_disc = (
    kernel(polygon.flat_reach),
    kernel(polygon.flat_core),
    kernel(cylinder.flat_core),
)
_depth_polygon, _depth_disc = kernel(polygon.flat_depth), kernel(cylinder.flat_depth)
_distance_box, _distance_sphere = kernel(box.distance), kernel(sphere.distance)
_distance_stood, _distance_dilated = kernel(stood.distance), kernel(dilated_disc.distance)
_ahead_box, _ahead_sphere, _ahead_stood = kernel(box.ahead), kernel(sphere.ahead), kernel(stood.ahead)
_ahead_dilated = kernel(dilated_disc.ahead)
_reach_box, _core_box, _depth_box, _depth_stood = (
    kernel(box.reach),
    kernel(box.core),
    kernel(box.depth),
    kernel(stood.depth),
)
_BOX, _SPHERE, _DISC, _POLYGON = (
    box.BoxShape.NUMBER,
    sphere.SphereShape.NUMBER,
    disc.DiscShape.NUMBER,
    polygon.PolygonShape.NUMBER,
)
_CYLINDER, _DILATED, _MESH = cylinder.CylinderShape.NUMBER, dilated_disc.DilatedDiscShape.NUMBER, mesh.MeshShape.NUMBER
_PRISM = prism.PrismShape.NUMBER
_ROUND = tuple(shape.NUMBER for shape in SHAPES if shape.ROUND)


@kernel
def half_of(forms, b):
    """Half edges of the box around body `b`, a tuple, m."""
    return forms.half[b, 0], forms.half[b, 1], forms.half[b, 2]


@kernel
def sides_of(forms, b):
    """Rows of the sides of body `b`: see `polygon.sides_table`."""
    return forms.sides[forms.first[b] : forms.first[b + 1]]


@kernel
def distance(forms, b, p):
    """(signed distance of `p` (3,), m, from the surface, negative inside; unit normal of the nearest point (3,))."""
    shape, half = forms.shape[b], half_of(forms, b)
    if shape == _BOX:
        return _distance_box(p, half, forms.planar)
    if shape == _SPHERE:
        return _distance_sphere(p, half)
    if shape == _DISC:
        high, u, v = _in_disc(p[0], p[2], half[0])
        return high, (u, 0.0, v)
    if shape == _POLYGON:
        high, u, v = _in_polygon(p[0], p[2], sides_of(forms, b))
        return high, (u, 0.0, v)
    if shape == _CYLINDER:
        return _distance_stood(_in_disc(p[0], p[1], half[0]), p[2], half[2])
    if shape == _DILATED:
        return _distance_dilated(p, half)
    if shape == _MESH:
        return field_distance(p, forms.field, forms.grid[b])
    return _distance_stood(_in_polygon(p[0], p[1], sides_of(forms, b)), p[2], half[2])


@kernel
def ahead(forms, b, p, n, behind):
    """Distance along `n` (3,) from `p` (3,) to the surface, from `behind` the point on; inf where it is missed, m."""
    shape, half = forms.shape[b], half_of(forms, b)
    if shape == _BOX:
        return _ahead_box(p, n, half, behind)
    if shape == _SPHERE:
        return _ahead_sphere(p, n, half, behind)
    if shape == _DISC:
        enter, leave = _across_disc(p[0], p[2], n[0], n[2], half[0])
        return max(enter, -behind) if max(enter, -behind) <= leave else math.inf
    if shape == _POLYGON:
        enter, leave = _across_polygon(p[0], p[2], n[0], n[2], sides_of(forms, b))
        return max(enter, -behind) if max(enter, -behind) <= leave else math.inf
    if shape == _CYLINDER:
        return _ahead_stood(_across_disc(p[0], p[1], n[0], n[1], half[0]), p[2], n[2], half[2], behind)
    if shape == _DILATED:
        return _ahead_dilated(p, n, half, behind)
    if shape == _MESH:
        return field_ahead(p, n, forms.field, forms.grid[b], behind)
    return _ahead_stood(_across_polygon(p[0], p[1], n[0], n[1], sides_of(forms, b)), p[2], n[2], half[2], behind)


@kernel
def reach(forms, b, d):
    """How far the body reaches along the unit vector `d` (3,) from its centre, m; of a mesh, the box around it."""
    shape, half = forms.shape[b], half_of(forms, b)
    if shape == _BOX or shape == _MESH:
        return _reach_box(d, half)
    if shape == _SPHERE:
        return half[0]
    if shape == _DISC:
        return half[0] * math.sqrt(d[0] * d[0] + d[2] * d[2])
    if shape == _POLYGON:
        return _reach_polygon(d[0], d[2], sides_of(forms, b))
    if shape == _CYLINDER:
        return half[0] * math.sqrt(d[0] * d[0] + d[1] * d[1]) + half[2] * abs(d[2])
    if shape == _DILATED:
        return (half[0] - half[2]) * math.sqrt(d[0] * d[0] + d[1] * d[1]) + half[2]
    return _reach_polygon(d[0], d[1], sides_of(forms, b)) + half[2] * abs(d[2])


@kernel
def core(forms, b, d):
    """The point of the body's core that lies farthest along `d` (3,), m.

    Cores are convex and lie inside the bodies: those of two bodies that touch are apart, and the direction from one to
    the other turns no faster than the bodies do.
    """
    shape, half, margin = forms.shape[b], half_of(forms, b), forms.margin[b]
    if shape == _BOX:
        return _core_box(d, half, margin, forms.planar)
    if shape == _SPHERE or shape == _DISC:
        return 0.0, 0.0, 0.0
    if shape == _POLYGON:
        x, z = _core_polygon(d[0], d[2], sides_of(forms, b))
        return x, 0.0, z
    up = half[2] - margin if d[2] > 0.0 else margin - half[2]
    if shape == _CYLINDER:
        x, y = _core_disc(d[0], d[1], half[0] - margin)
        return x, y, up
    if shape == _DILATED:
        x, y = _core_disc(d[0], d[1], half[0] - half[2])
        return x, y, 0.0
    x, y = _core_polygon(d[0], d[1], sides_of(forms, b))
    return x, y, up


@kernel
def depth(forms, b, p, d, ramp):
    """(distance from point `p` along the unit vector `d` to the surface, m, weight).

    The point counts fully inside, less with its distance outside faces that lie along d (over `ramp`, m, so that a
    sideways motion changes the force smoothly), else not at all: weight 0. Above the surface the distance is negative.
    """
    shape, half = forms.shape[b], half_of(forms, b)
    if shape == _BOX:
        return _depth_box(p, d, half, ramp, LATERAL)
    if shape == _CYLINDER:
        return _depth_stood(
            _depth_disc(p[0], p[1], d[0], d[1], half[0], ramp, LATERAL), p[2], d[2], half[2], ramp, LATERAL
        )
    if shape == _DILATED or shape == _SPHERE or shape == _DISC or shape == _MESH:
        deep = -distance(forms, b, p)[0]
        return deep, (1.0 if deep > 0.0 else 0.0)
    sides = sides_of(forms, b)
    if shape == _POLYGON:
        deep, weight = _depth_polygon(p[0], p[2], d[0], d[2], sides, ramp, LATERAL)
        return deep, max(weight, 0.0)
    return _depth_stood(
        _depth_polygon(p[0], p[1], d[0], d[1], sides, ramp, LATERAL), p[2], d[2], half[2], ramp, LATERAL
    )


@kernel
def touches_at_one_point(shape):
    """Whether a shape is round (`ShapeTable.ROUND`)."""
    return shape in _ROUND


@kernel
def is_box(shape):
    """Whether a shape is a box."""
    return shape == _BOX


@kernel
def is_mesh(shape):
    """Whether a shape is a mesh, which may be hollow: it has no core."""
    return shape == _MESH


@kernel
def along_side(shape):
    """How many points of a body's curved side are watched as they move to where it touches: see `on_side`."""
    if shape == _CYLINDER:
        return 3
    return 1 if shape == _DILATED else 0


@kernel
def whole_side(forms, b):
    """From where to where, m, along the axis of body `b` its side is."""
    return -forms.half[b, 2], forms.half[b, 2]


@kernel
def on_side(forms, b, k, d, line):
    """(point k of the curved side that lies farthest along the unit vector `d` (3,), what of the side it stands for).

    Of a cylinder the ends and the middle of what touches of it, `line` from to, m, with the length that each stands
    for, m (Simpson); of a dilated disc the point of the rim, with 1. Less where d is across the ends, which then touch
    with their elements.
    """
    half, across = half_of(forms, b), math.sqrt(d[0] * d[0] + d[1] * d[1])
    x, y = (d[0] / across, d[1] / across) if across > 0.0 else (1.0, 0.0)
    if forms.shape[b] == _CYLINDER:
        share = (1.0 if k != 1 else 4.0) / 6.0 * (line[1] - line[0])
        return (half[0] * x, half[0] * y, line[0] + 0.5 * k * (line[1] - line[0])), share * across * across
    flat = half[0] - half[2]
    return (flat * x + half[2] * d[0], flat * y + half[2] * d[1], half[2] * d[2]), min(across / LATERAL, 1.0)


@kernel
def curvature_radius(forms, b):
    """Radius of what is round of a body, m: of a rim the geometric mean of its two; 0 where nothing is."""
    shape, half = forms.shape[b], half_of(forms, b)
    if shape == _DILATED:
        return math.sqrt(half[0] * half[2])
    return half[0] if shape == _CYLINDER or shape in _ROUND else 0.0


@kernel
def stands_upright(shape):
    """Whether a shape is an outline with a height (`stood`)."""
    return shape == _CYLINDER or shape == _PRISM


@kernel
def touches_along_a_line(shape):
    """Whether what is round of a body touches a face along a line, as a cylinder's side does."""
    return shape == _CYLINDER or shape == _DISC
