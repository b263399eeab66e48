"""A cylinder: its table in a case, and what follows from it."""

import math
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Moderate
from parsim.machine.compiled import compiled
from parsim.solid.shapes.disc import circle
from parsim.solid.shapes.outline import disc_rings
from parsim.solid.shapes.samples import stacked_samples
from parsim.solid.shapes.shape import ShapeTable
from parsim.solid.shapes.surface import away_from_stood, stood

_CORNERS = 48  # of the polygon that is drawn
_SLICES = 2000  # in which the volume under water is summed


class CylinderShape(ShapeTable):
    """A cylinder about the z axis."""

    NUMBER = 4

    kind: Literal["cylinder"] = Field(description="a cylinder about its z axis; 3D only")
    diameter: Moderate = Field(description="diameter, m")
    height: Moderate = Field(description="height along z, m")

    @property
    def half(self):
        """See `ShapeTable`."""
        return 0.5 * self.diameter, 0.5 * self.diameter, 0.5 * self.height

    @property
    def volume(self):
        """See `ShapeTable`."""
        return math.pi / 4.0 * self.diameter**2 * self.height

    def told(self):
        """See `ShapeTable`."""
        return f"shape.diameter = {self.diameter!r}, height = {self.height!r}"

    def faults(self, planar):
        """See `ShapeTable`."""
        if planar:
            yield 'shape.kind = "cylinder": a 2D case has none; use a disc'

    def radius(self, planar):
        """See `ShapeTable`."""
        return 0.5 * math.hypot(self.diameter, self.height)

    def reach(self, direction):
        """See `ShapeTable`."""
        return 0.5 * (self.diameter * math.hypot(*direction[:2]) + self.height * abs(direction[2]))

    def inertia(self, mass):
        """See `ShapeTable`."""
        across = mass * (self.diameter**2 / 16.0 + self.height**2 / 12.0)
        return [across, across, mass * self.diameter**2 / 8.0]

    def away(self, points):
        """See `ShapeTable`."""
        return away_from_stood(np.hypot(*points[:, :2].T) - 0.5 * self.diameter, points[:, 2], self.height)

    def under(self, up, level):
        """See `ShapeTable`: segments of the discs of which it is made."""
        radius, along = 0.5 * self.diameter, math.hypot(*up[:2])
        if along < 1e-9:
            return self.volume * min(max(0.5 + level / self.height, 0.0), 1.0)
        z = ((np.arange(_SLICES) + 0.5) / _SLICES - 0.5) * self.height
        cut = np.clip((level - z * up[2]) / along, -radius, radius)
        segment = radius**2 * (math.pi - np.arccos(cut / radius)) + cut * np.sqrt(radius**2 - cut**2)
        return float(segment.mean()) * self.height

    def surface(self):
        """See `ShapeTable`."""
        return stood(0.5 * self.diameter * circle(_CORNERS), self.height)

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: rings on its ends; its side touches along a line, which goes where it touches."""
        wanted = spacing or min(self.diameter, self.height)
        return ends(0.5 * self.diameter, 0.5 * self.height, wanted), [wanted] * 3

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`."""
        radius = 0.5 * self.diameter
        return stacked_samples(disc_rings(radius, spacing), radius, self.height, spacing, depth)


def ends(radius, half, wanted):
    """Elements (n, 6) on the two round ends, at z = +- `half`, m: rings at most `wanted`, m, apart, rim and centre."""
    rings, rows = max(math.ceil(radius / wanted - 1e-9), 2), []
    for ring in range(rings + 1):
        at, step = radius * ring / rings, radius / rings
        low, high = max(at - 0.5 * step, 0.0), min(at + 0.5 * step, radius)
        count = max(math.ceil(2.0 * math.pi * at / wanted), 8) if ring else 1
        place, area = at * circle(count), np.full(count, math.pi * (high**2 - low**2) / count)
        for sign in (1.0, -1.0):
            flat = np.zeros((count, 2))
            rows.append(np.column_stack([place, np.full(count, sign * half), flat, sign * area]))
    return np.concatenate(rows)


@compiled
def flat_depth(u, v, du, dv, radius, ramp, lateral):
    """See `polygon.flat_depth`: its side is taken for the plane that touches it next to the point."""
    length, along = math.sqrt(u * u + v * v), math.sqrt(du * du + dv * dv)
    if along < lateral:
        return math.inf, 1.0 + (radius - length) / ramp
    if length > radius:
        return 0.0, 0.0
    ahead = (u * du + v * dv) / along
    return (math.sqrt(max(ahead * ahead + radius * radius - length * length, 0.0)) - ahead) / along, 1.0


@compiled
def flat_core(du, dv, radius):
    """See `polygon.flat_core`."""
    length = math.sqrt(du * du + dv * dv)
    if length == 0.0:
        return 0.0, 0.0
    return radius * du / length, radius * dv / length
