"""A disc, the round body of a plane: its table in a case, and what follows from it; also what is round in a plane."""

import math
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Moderate
from parsim.machine.compiled import compiled
from parsim.solid.shapes.outline import disc_rings
from parsim.solid.shapes.samples import flat_samples
from parsim.solid.shapes.shape import ShapeTable
from parsim.solid.shapes.surface import laid

_CORNERS = 64  # of the polygon that is drawn


class DiscShape(ShapeTable):
    """A disc in the x-z plane, a metre of a cylinder along y."""

    NUMBER = 2
    ROUND = FLAT = True

    kind: Literal["disc"] = Field(description="a disc; 2D only")
    diameter: Moderate = Field(description="diameter, m")

    @property
    def half(self):
        """See `ShapeTable`."""
        return 0.5 * self.diameter, 0.5, 0.5 * self.diameter

    @property
    def volume(self):
        """See `ShapeTable`."""
        return math.pi / 4.0 * self.diameter**2

    def told(self):
        """See `ShapeTable`."""
        return f"shape.diameter = {self.diameter!r}"

    def faults(self, planar):
        """See `ShapeTable`."""
        if not planar:
            yield 'shape.kind = "disc": a 3D case has none; use a cylinder or a sphere'

    def radius(self, planar):
        """See `ShapeTable`."""
        return 0.5 * self.diameter

    def reach(self, direction):
        """See `ShapeTable`."""
        return 0.5 * self.diameter * math.hypot(direction[0], direction[2])

    def inertia(self, mass):
        """See `ShapeTable`; but for that about y those of a thin plate, which nothing asks for."""
        own = mass * self.diameter**2 / 16.0
        return [own, 2.0 * own, own]

    def away(self, points):
        """See `ShapeTable`."""
        return np.hypot(points[:, 0], points[:, 2]) - 0.5 * self.diameter

    def under(self, up, level):
        """See `ShapeTable`."""
        radius = 0.5 * self.diameter
        level = min(max(level, -radius), radius)
        return radius**2 * (math.pi - math.acos(level / radius)) + level * math.sqrt(radius**2 - level**2)

    def surface(self):
        """See `ShapeTable`."""
        return laid(0.5 * self.diameter * circle(_CORNERS))

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: none, a disc touches at one point."""
        return np.zeros((0, 6)), [math.inf] * 3

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`."""
        return flat_samples(disc_rings(0.5 * self.diameter, spacing), 0.5 * self.diameter, spacing, depth)


def circle(count):
    """Corners (count, 2) of an even polygon on the circle of radius 1, anticlockwise."""
    angle = 2.0 * math.pi * np.arange(count) / count
    return np.stack([np.cos(angle), np.sin(angle)], -1)


@compiled
def flat_distance(u, v, radius):
    """(signed distance of a point of the plane from a circle about the origin, m; outward normal, two numbers)."""
    length = math.sqrt(u * u + v * v)
    if length == 0.0:
        return -radius, 0.0, 1.0
    return length - radius, u / length, v / length


@compiled
def flat_crossing(u, v, du, dv, radius):
    """Where, along (du, dv) from (u, v), a line enters and leaves the circle, m; enters after it leaves: it misses."""
    square = du * du + dv * dv
    if square < 1e-24:
        inside = u * u + v * v <= radius * radius
        return (-math.inf, math.inf) if inside else (math.inf, -math.inf)
    middle = -(u * du + v * dv) / square
    u, v = u + middle * du, v + middle * dv
    room = radius * radius - u * u - v * v
    if room < 0.0:
        return math.inf, -math.inf
    half = math.sqrt(room / square)
    return middle - half, middle + half
