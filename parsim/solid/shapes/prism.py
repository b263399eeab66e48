"""A prism, an upright body on a convex polygon, what floes of ice look like: its table, and what follows from it."""

import math
from functools import cache
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Moderate
from parsim.solid.shapes.outline import most_inset, polygon_rings, sides_of
from parsim.solid.shapes.polygon import (
    MARGIN,
    Corners,
    centred,
    faults_of,
    flat_away,
    moments_of,
    sides_table,
    spread,
    told,
)
from parsim.solid.shapes.samples import stacked_samples
from parsim.solid.shapes.shape import ShapeTable
from parsim.solid.shapes.surface import away_from_stood, stood


class PrismShape(ShapeTable):
    """A convex polygon of the x-y plane with a height along z."""

    NUMBER = 5

    kind: Literal["prism"] = Field(description="a convex polygon with a height; 3D only")
    points: Corners = Field(description="corners (x, y) in their order, m, about any origin")
    height: Moderate = Field(description="height along z, m")

    @property
    def _drawn(self):
        """See `_in_principal_axes`."""
        return _in_principal_axes(self.points)

    @property
    def corners(self):
        """Corners (k, 2), m, anticlockwise about its centre, in its frame."""
        return self._drawn[0]

    @property
    def turn(self):
        """See `ShapeTable`: its principal axes may be turned about z."""
        return math.cos(0.5 * self._drawn[1]), 0.0, 0.0, math.sin(0.5 * self._drawn[1])

    @property
    def half(self):
        """See `ShapeTable`."""
        x, y = np.abs(self.corners).max(axis=0)
        return float(x), float(y), 0.5 * self.height

    @property
    def volume(self):
        """See `ShapeTable`."""
        return moments_of(self.corners)[0] * self.height

    def told(self):
        """See `ShapeTable`."""
        return f"shape.points = {told(self.points)}, height = {self.height!r}"

    def faults(self, planar):
        """See `ShapeTable`."""
        if planar:
            yield 'shape.kind = "prism": a 2D case has none; use a polygon'
        yield from faults_of(self.points)

    def radius(self, planar):
        """See `ShapeTable`."""
        return math.hypot(float(np.hypot(*self.corners.T).max()), 0.5 * self.height)

    def reach(self, direction):
        """See `ShapeTable`."""
        return float((self.corners @ direction[:2]).max()) + 0.5 * self.height * abs(direction[2])

    def thinnest(self, planar):
        """See `ShapeTable`."""
        return min(_inradius(self.points), 0.5 * self.height)

    def normals(self):
        """See `ShapeTable`."""
        return np.array([(0.0, 0.0, 1.0), *((*normal, 0.0) for normal, _ in sides_of(self.corners))])

    def away(self, points):
        """See `ShapeTable`."""
        return away_from_stood(flat_away(points[:, :2], self.corners), points[:, 2], self.height)

    def afloat(self, share, up=(0.0, 0.0, 1.0)):
        """See `ShapeTable`; exact where it stands upright."""
        return self.height * (0.5 - share) if up[2] > 1.0 - 1e-12 else super().afloat(share, up)

    def inertia(self, mass):
        """See `ShapeTable`."""
        area, (xx, _, yy) = moments_of(self.corners)
        upright = self.height**2 / 12.0
        return [mass * (yy / area + upright), mass * (xx / area + upright), mass * (xx + yy) / area]

    def sides(self):
        """See `ShapeTable`."""
        return sides_table(self.corners, MARGIN * self.thinnest(False))

    def surface(self):
        """See `ShapeTable`."""
        return stood(self.corners, self.height)

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: grids on the sides; on the ends rings of smaller polygons, from the rim to the centre.

        At most its least width apart.
        """
        wanted = spacing or 2.0 * self.thinnest(False)
        up, tall = spread(np.array([-0.5 * self.height]), np.array([0.5 * self.height]), wanted)
        rows, rings = [], max(math.ceil(_inradius(self.points) / wanted - 1e-9), 2)
        for (normal, offset), p, q in zip(
            sides_of(self.corners), self.corners, np.roll(self.corners, -1, 0), strict=True
        ):
            at, share = spread(p, q, wanted)
            for z, length in zip(up[:, 0], tall, strict=True):
                face = np.outer(share * length, normal)
                rows.append(np.column_stack([at, np.full(len(at), z), face, 0.0 * share]))
            for ring in range(rings):
                scale = 1.0 - ring / rings
                at, share = spread(scale * p, scale * q, wanted) if ring else (at, share)
                area = offset * share / scale * _hat(scale, 1.0 / rings)
                rows += [_ends(at, 0.5 * self.height, area)]
        middle = moments_of(self.corners)[0] - sum(r[r[:, 5] > 0.0, 5].sum() for r in rows)
        rows.append(_ends(np.zeros((1, 2)), 0.5 * self.height, np.array([middle])))
        return np.concatenate(rows), [wanted] * 3

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`."""
        rings = polygon_rings(self.corners, spacing)
        return stacked_samples(rings, _inradius(self.points), self.height, spacing, depth)


@cache
def _in_principal_axes(points):
    """(corners (k, 2), m, anticlockwise about their centre, in principal axes; by how much these are turned, rad)."""
    corners = centred(points)
    _, (xx, xy, yy) = moments_of(corners)
    even = abs(xy) <= 1e-9 * (xx + yy)
    angle = 0.0 if even else 0.5 * math.atan2(2.0 * xy, xx - yy)
    c, s = math.cos(angle), math.sin(angle)
    return corners @ np.array([[c, -s], [s, c]]), angle


@cache
def _inradius(points):
    """Radius of the largest circle in it, m."""
    return most_inset(_in_principal_axes(points)[0])


def _hat(scale, step):
    """Share of a triangle from the centre that the points at `scale` of the way to the rim stand for, over its half."""
    return 0.5 * step - step * step / 6.0 if scale == 1.0 else step * scale


def _ends(at, half, area):
    """Elements of both ends at the points `at` (n, 2)."""
    flat = np.zeros((len(at), 2))
    return np.concatenate([
        np.column_stack([at, np.full(len(at), sign * half), flat, sign * area]) for sign in (1.0, -1.0)
    ])  # fmt: skip
