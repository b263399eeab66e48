"""A sphere: its table in a case, and what follows from it."""

import math
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Moderate
from parsim.machine.compiled import compiled
from parsim.solid.shapes.samples import Samples, face_of
from parsim.solid.shapes.shape import ShapeTable

_TURN = math.pi * (3.0 - math.sqrt(5.0))  # rad, from each point of a spiral to the next: even, and never repeating
_QUADS = 8  # along each edge of the cube that becomes the surface


class SphereShape(ShapeTable):
    """A sphere about its centre."""

    NUMBER = 1
    ROUND = True

    kind: Literal["sphere"] = Field(description="a sphere; 3D only")
    diameter: Moderate = Field(description="diameter, m")

    @property
    def half(self):
        """Half edges (3,) of the cube around it, m."""
        return (0.5 * self.diameter,) * 3

    @property
    def volume(self):
        """Volume, m3."""
        return math.pi / 6.0 * self.diameter**3

    def told(self):
        """See `ShapeTable`."""
        return f"shape.diameter = {self.diameter!r}"

    def faults(self, planar):
        """See `ShapeTable`."""
        if planar:
            yield 'shape.kind = "sphere": a 2D case has none; use a box'

    def radius(self, planar):
        """See `ShapeTable`."""
        return 0.5 * self.diameter

    def reach(self, direction):
        """See `ShapeTable`."""
        return 0.5 * self.diameter

    def inertia(self, mass):
        """See `ShapeTable`."""
        return [0.1 * mass * self.diameter**2] * 3

    def away(self, points):
        """See `ShapeTable`."""
        return np.linalg.norm(points, axis=1) - 0.5 * self.diameter

    def under(self, up, level):
        """See `ShapeTable`: a cap."""
        radius = 0.5 * self.diameter
        deep = radius + min(max(level, -radius), radius)
        return math.pi * deep * deep * (3.0 * radius - deep) / 3.0

    def surface(self):
        """See `ShapeTable`: a cube blown up."""
        steps = np.tan(math.pi / 4.0 * np.linspace(-1.0, 1.0, _QUADS + 1))  # quads of about one size
        u, v = (grid.ravel() for grid in np.meshgrid(steps, steps, indexing="ij"))
        corner = np.arange((_QUADS + 1) ** 2).reshape(_QUADS + 1, _QUADS + 1)
        quads = np.stack([corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]], -1).reshape(-1, 4)
        points = [
            np.roll(np.stack([u, v if sign > 0 else -v, np.full(u.size, sign)], -1), a, axis=1)
            for a in range(3)
            for sign in (-1.0, 1.0)
        ]
        every = np.concatenate(points)
        first, same = np.unique(np.round(every, 9) + 0.0, axis=0, return_inverse=True)
        faces = same.reshape(-1)[np.concatenate([quads + k * u.size for k in range(6)])]
        return 0.5 * self.diameter * first / np.linalg.norm(first, axis=1)[:, None], faces

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: none, a sphere touches at one point."""
        return np.zeros((0, 6)), [math.inf] * 3

    def _shells(self, spacing, depth):
        """Middle radius, m, volume over that of a lattice point, and number of samples of each shell."""
        radius = 0.5 * self.diameter
        number = max(round(radius / spacing), 1)
        for shell in range(min(number, max(math.ceil(depth / radius * number - 0.5), 1))):
            outer, inner = radius * (1.0 - shell / number), radius * (1.0 - (shell + 1) / number)
            volume = 4.0 / 3.0 * math.pi * (outer**3 - inner**3) / spacing**3
            yield 0.5 * (outer + inner), volume, 2 * round(0.5 * volume) or 1

    def number_of_samples(self, spacing, depth, planar):
        """See `ShapeTable`."""
        return sum(count for _, _, count in self._shells(spacing, depth))

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`: shells about a spacing thick, of points on spirals, each with its share of the shell."""
        radius, offsets, shares = 0.5 * self.diameter, [], []
        for middle, volume, count in self._shells(spacing, depth):
            offsets.append(middle * spiral(count) if count > 1 else np.zeros((1, 3)))
            shares.append(np.full(count, volume / count))
        first = len(offsets[0])
        normal = spiral(first) if first > 1 else np.array([[0.0, 0.0, 1.0]])
        patches = np.arange(first), face_of(normal), np.ones(first, bool), radius * normal, normal
        return Samples(
            np.concatenate(offsets),
            np.concatenate(shares),
            *patches,
            np.full(first, 4.0 * math.pi * radius * radius / first),
        )


def spiral(count):
    """Directions (count, 3), even over the sphere: a spiral from a pole to the equator (Gonzalez 2010) and its mirror
    image through the centre, so that they pull nowhere; `count` is even."""
    up = 1.0 - (2.0 * np.arange(count // 2) + 1.0) / count
    across, angle = np.sqrt(1.0 - up * up), _TURN * np.arange(count // 2)
    half = np.stack([across * np.cos(angle), across * np.sin(angle), up], -1)
    return np.concatenate([half, -half])


@compiled
def distance(p, half):
    """See `kernels.distance`."""
    length = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    if length == 0.0:
        return -half[0], (0.0, 0.0, 1.0)
    return length - half[0], (p[0] / length, p[1] / length, p[2] / length)


@compiled
def ahead(p, n, half, behind):
    """See `kernels.ahead`."""
    along = -(p[0] * n[0] + p[1] * n[1] + p[2] * n[2])
    square = half[0] * half[0] - (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) + along * along
    if square < 0.0:
        return math.inf
    root = math.sqrt(square)
    return max(along - root, -behind) if along + root >= -behind else math.inf


@compiled
def reach(d, half):
    """See `kernels.reach`."""
    return half[0]
