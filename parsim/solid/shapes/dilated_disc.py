"""A dilated disc, a disc with a round rim: its table in a case, and what follows from it.

All points within a radius of a flat disc (Hopkins & Tuhkuri 1999, doi 10.1029/1999JC900062): the floes that Robb (2016,
sec. 8) names as the next step from spheres.
"""

import math
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Moderate
from parsim.machine.compiled import compiled
from parsim.solid.shapes.cylinder import ends
from parsim.solid.shapes.disc import circle
from parsim.solid.shapes.outline import Ring, disc_rings
from parsim.solid.shapes.samples import Samples, face_of
from parsim.solid.shapes.shape import ShapeTable

_CORNERS, _LAYERS = 48, 8  # of the surface that is drawn: around, and along the half circle of the rim


class DilatedDiscShape(ShapeTable):
    """A flat disc about the z axis, and all within half its thickness of that."""

    NUMBER = 6

    kind: Literal["dilated_disc"] = Field(description="a disc about its z axis with a round rim; 3D only")
    diameter: Moderate = Field(description="largest diameter, m")
    thickness: Moderate = Field(description="thickness along z, m; less than the diameter")

    @property
    def half(self):
        """See `ShapeTable`."""
        return 0.5 * self.diameter, 0.5 * self.diameter, 0.5 * self.thickness

    @property
    def core(self):
        """Radius of the flat disc, m."""
        return 0.5 * (self.diameter - self.thickness)

    @property
    def volume(self):
        """See `ShapeTable`."""
        return self._integral(lambda z, r: math.pi * r**2)

    def _integral(self, of):
        """Integral over the height of a function of height and radius there, m; exact to round-off."""
        t, weight = np.polynomial.legendre.leggauss(48)
        angle, tube = 0.5 * math.pi * t, 0.5 * self.thickness
        z, r = tube * np.sin(angle), self.core + tube * np.cos(angle)
        return float((weight * 0.5 * math.pi * tube * np.cos(angle) * of(z, r)).sum())

    def told(self):
        """See `ShapeTable`."""
        return f"shape.diameter = {self.diameter!r}, thickness = {self.thickness!r}"

    def faults(self, planar):
        """See `ShapeTable`."""
        if planar:
            yield 'shape.kind = "dilated_disc": a 2D case has none; use a disc or a polygon'
        if self.thickness >= self.diameter:
            yield f"shape.thickness = {self.thickness!r}: must be less than the diameter, {self.diameter!r}"

    def radius(self, planar):
        """See `ShapeTable`."""
        return 0.5 * self.diameter

    def reach(self, direction):
        """See `ShapeTable`."""
        return self.core * math.hypot(*direction[:2]) + 0.5 * self.thickness

    def away(self, points):
        """See `ShapeTable`."""
        over = np.maximum(np.hypot(*points[:, :2].T) - self.core, 0.0)
        return np.hypot(over, points[:, 2]) - 0.5 * self.thickness

    def inertia(self, mass):
        """See `ShapeTable`."""
        density = mass / self.volume
        polar = self._integral(lambda z, r: 0.5 * math.pi * r**4)
        upright = self._integral(lambda z, r: math.pi * r**2 * z**2)
        return [density * (0.5 * polar + upright)] * 2 + [density * polar]

    def surface(self):
        """See `ShapeTable`."""
        angle = np.linspace(-0.5 * math.pi, 0.5 * math.pi, _LAYERS + 1)
        tube = 0.5 * self.thickness
        rings = [
            np.column_stack(
                [(self.core + tube * math.cos(a)) * circle(_CORNERS), np.full(_CORNERS, tube * math.sin(a))]
            )
            for a in angle
        ]
        points, quads = np.concatenate(rings), []
        for layer in range(_LAYERS):
            for k in range(_CORNERS):
                low, n = layer * _CORNERS, (k + 1) % _CORNERS
                quads.append((low + k, low + n, low + _CORNERS + n, low + _CORNERS + k))
        top = _LAYERS * _CORNERS
        for k in range(1, _CORNERS - 1, 2):
            last = min(k + 2, _CORNERS - 1)
            quads += [(0, last, k + 1, k), (top, top + k, top + k + 1, top + last)]
        return points, np.array(quads)

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: rings on its flat ends; its rim touches at one point, which goes where it touches."""
        wanted = spacing or self.thickness
        return ends(self.core, 0.5 * self.thickness, wanted), [wanted] * 3

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`: layers of rings; the patches of the rim are those of its zones."""
        tube, layers = 0.5 * self.thickness, max(round(self.thickness / spacing), 1)
        thick, parts, first = self.thickness / layers, [], 0
        for layer in range(layers):
            low, high = layer * thick - tube, (layer + 1) * thick - tube
            part, count = self._layer(low, high, first, spacing, depth)
            parts.append(part)
            first += count
        return Samples(*map(np.concatenate, zip(*parts, strict=True)))

    def _layer(self, low, high, first, spacing, depth):
        """Samples between two heights, m, numbered from `first` on, and how many there are."""
        tube, z = 0.5 * self.thickness, 0.5 * (low + high)
        volume = _zone(self.core, tube, low, high)
        radius = math.sqrt(volume / (math.pi * (high - low)))
        end = (abs(low) >= tube * (1.0 - 1e-9)) - (abs(high) >= tube * (1.0 - 1e-9))
        offsets, shares, patches, rings = [], [], [], list(disc_rings(radius, spacing))
        both = end == 0 and high - low >= 2.0 * tube * (1.0 - 1e-9)
        for k, ring in enumerate(rings):
            deep = min((k + 0.5) * radius / len(rings), tube - abs(z))
            if deep >= depth and k:
                continue
            count = len(ring.area)
            at, even = first + np.arange(count), np.ones(count)
            offsets.append(np.column_stack([ring.points, z * even]))
            shares.append(ring.area * (high - low) / spacing**3)
            if k == 0:
                patches.append(self._rim(ring, at, low, high))
            for sign in (1.0, -1.0) if both else (-end,) if end else ():
                inside = np.hypot(*ring.points.T) < self.core
                if inside.any():
                    patches.append(self._end(ring, at, inside, float(sign)))
            first += count
        return (np.concatenate(offsets), np.concatenate(shares), *map(np.concatenate, zip(*patches, strict=True))), (
            sum(map(len, offsets))
        )

    def _rim(self, ring: Ring, at, low, high):
        """Patches of the zone of the rim between two heights."""
        tube = 0.5 * self.thickness
        angles = [math.asin(max(min(h / tube, 1.0), -1.0)) for h in (low, high)]
        middle = 0.5 * sum(angles)
        area = 2.0 * math.pi * tube * (self.core * (angles[1] - angles[0]) + (high - low)) / len(at)
        normal = np.column_stack([math.cos(middle) * ring.normal, np.full(len(at), math.sin(middle))])
        place = tube * normal + np.column_stack([self.core * ring.normal, np.zeros(len(at))])
        return at, face_of(normal), np.ones(len(at), bool), place, normal, np.full(len(at), area)

    def _end(self, ring, at, inside, sign):
        """Patches of a flat end over the samples of a ring that are under it."""
        at, points = at[inside], ring.points[inside]
        normal = np.tile((0.0, 0.0, sign), (at.size, 1))
        place = np.column_stack([points, np.full(at.size, 0.5 * sign * self.thickness)])
        return at, face_of(normal), np.zeros(at.size, bool), place, normal, ring.area[inside]


def _zone(core, tube, low, high):
    """Volume, m3, between two heights."""

    def below(z):
        angle = math.asin(max(min(z / tube, 1.0), -1.0))
        chord = 0.5 * (z * math.sqrt(max(tube * tube - z * z, 0.0)) + tube * tube * angle)
        return math.pi * (core * core * z + 2.0 * core * chord + tube * tube * z - z**3 / 3.0)

    return below(high) - below(low)


@compiled
def distance(p, half):
    """See `kernels.distance`; half (3,): half edges of the box around it."""
    core, length = half[0] - half[2], math.sqrt(p[0] * p[0] + p[1] * p[1])
    if length <= core:
        return abs(p[2]) - half[2], (0.0, 0.0, 1.0 if p[2] > 0.0 else -1.0)
    share = 1.0 - core / length
    x, y = share * p[0], share * p[1]
    away = math.sqrt(x * x + y * y + p[2] * p[2])
    if away == 0.0:
        return -half[2], (0.0, 0.0, 1.0)
    return away - half[2], (x / away, y / away, p[2] / away)


@compiled
def ahead(p, n, half, behind):
    """See `kernels.ahead`: by steps of the distance, which never lead past the surface."""
    along, far = -behind, 4.0 * half[0] + math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    for _ in range(100):
        x, y, z = p[0] + along * n[0], p[1] + along * n[1], p[2] + along * n[2]
        over = max(math.sqrt(x * x + y * y) - half[0] + half[2], 0.0)
        gap = math.sqrt(over * over + z * z) - half[2]
        if gap < 1e-9 * half[2]:
            return along
        along += gap
        if along > far:
            return math.inf
    return along
