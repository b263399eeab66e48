"""What kernels ask of a shape, chosen by its number; `half` (3,): half edges of the box around it, m."""

from parsim.machine.jit import kernel
from parsim.solid.shapes import SHAPES, box, sphere

_distance_box, _distance_sphere = kernel(box.distance), kernel(sphere.distance)
_ahead_box, _ahead_sphere = kernel(box.ahead), kernel(sphere.ahead)
_reach_box, _reach_sphere = kernel(box.reach), kernel(sphere.reach)
_SPHERE, _ROUND = sphere.SphereShape.NUMBER, tuple(shape.NUMBER for shape in SHAPES if shape.ROUND)


@kernel
def distance(shape, p, half, used):
    """(signed distance of `p` (3,), m, from the surface, negative inside; unit normal of the nearest point (3,)).

    Both in the body's frame; `used` (3,): the axes along which it has a surface.
    """
    if shape == _SPHERE:
        return _distance_sphere(p, half, used)
    return _distance_box(p, half, used)


@kernel
def ahead(shape, p, n, half, behind):
    """Distance along `n` (3,) from `p` (3,) to the surface, from `behind` the point on; inf where it is missed, m."""
    if shape == _SPHERE:
        return _ahead_sphere(p, n, half, behind)
    return _ahead_box(p, n, half, behind)


@kernel
def reach(shape, d, half):
    """Half extent along the unit vector `d` (3,), m."""
    if shape == _SPHERE:
        return _reach_sphere(d, half)
    return _reach_box(d, half)


@kernel
def touches_at_one_point(shape):
    """Whether a shape is round (`ShapeTable.ROUND`)."""
    return shape in _ROUND
