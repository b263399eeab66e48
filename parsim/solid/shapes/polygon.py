"""A convex polygon, a body of a plane: its table in a case, and what follows from it."""

import math
from functools import cache
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Number
from parsim.machine.compiled import compiled
from parsim.solid.shapes.outline import inset, most_inset, polygon_rings, sides_of
from parsim.solid.shapes.samples import flat_samples
from parsim.solid.shapes.shape import ShapeTable
from parsim.solid.shapes.surface import laid

NORMAL, OFFSET, START, LENGTH, CORE = 0, 2, 3, 5, 6  # columns of its sides
MARGIN = 0.2  # of the least half width, by which the core of a body is smaller
MOST_CORNERS = 64
Corners = Annotated[tuple[tuple[Number, Number], ...], Field(min_length=3, max_length=MOST_CORNERS)]


class PolygonShape(ShapeTable):
    """A convex polygon in the x-z plane."""

    NUMBER = 3
    FLAT = True

    kind: Literal["polygon"] = Field(description="a convex polygon; 2D only")
    points: Corners = Field(description="corners (x, z) in their order, m, about any origin")

    @property
    def corners(self):
        """Corners (k, 2), m, anticlockwise about its centre."""
        return centred(self.points)

    @property
    def half(self):
        """See `ShapeTable`."""
        x, z = np.abs(self.corners).max(axis=0)
        return float(x), 0.5, float(z)

    @property
    def volume(self):
        """See `ShapeTable`."""
        return moments_of(self.corners)[0]

    def told(self):
        """See `ShapeTable`."""
        return f"shape.points = {told(self.points)}"

    def faults(self, planar):
        """See `ShapeTable`."""
        if not planar:
            yield 'shape.kind = "polygon": a 3D case has none; use a prism'
        yield from faults_of(self.points)

    def radius(self, planar):
        """See `ShapeTable`."""
        return float(np.hypot(*self.corners.T).max())

    def reach(self, direction):
        """See `ShapeTable`."""
        return float((self.corners @ (direction[0], direction[2])).max())

    def thinnest(self, planar):
        """See `ShapeTable`."""
        return most_inset(self.corners)

    def normals(self):
        """See `ShapeTable`."""
        return np.array([(normal[0], 0.0, normal[1]) for normal, _ in sides_of(self.corners)])

    def away(self, points):
        """See `ShapeTable`."""
        return flat_away(points[:, [0, 2]], self.corners)

    def inertia(self, mass):
        """See `ShapeTable`; but for that about y those of a thin plate, which nothing asks for."""
        area, (xx, _, zz) = moments_of(self.corners)
        return [mass * zz / area, mass * (xx + zz) / area, mass * xx / area]

    def sides(self):
        """See `ShapeTable`."""
        return sides_table(self.corners, MARGIN * self.thinnest(True))

    def surface(self):
        """See `ShapeTable`."""
        return laid(self.corners)

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: on its corners and between, at most its least width apart, three or more on a side."""
        wanted, rows = spacing or 2.0 * self.thinnest(True), []
        for (normal, _), p, q in zip(sides_of(self.corners), self.corners, np.roll(self.corners, -1, 0), strict=True):
            at, share = spread(p, q, wanted)
            rows.append(
                np.column_stack([at[:, 0], 0.0 * share, at[:, 1], normal[0] * share, 0.0 * share, normal[1] * share])
            )
        return np.concatenate(rows), [wanted] * 3

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`."""
        return flat_samples(polygon_rings(self.corners, spacing), most_inset(self.corners), spacing, depth)


def told(points):
    """Corners for a message: the first few."""
    shown = ", ".join(f"[{x:g}, {y:g}]" for x, y in points[:4])
    return f"[{shown}{', ...' if len(points) > 4 else ''}]"


def faults_of(points):
    """What is wrong with the corners of a convex polygon: messages."""
    corners = np.array(points, float)
    ahead, back = np.roll(corners, -1, axis=0) - corners, corners - np.roll(corners, 1, axis=0)
    bend = back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0]
    size = float(np.ptp(corners, axis=0).max())
    if size == 0.0 or (np.hypot(*ahead.T) <= 1e-9 * size).any():
        yield f"shape.points = {told(points)}: two corners are at one place; leave one out"
        return
    turns = bend / (np.hypot(*ahead.T) * np.hypot(*back.T))
    wrong = np.flatnonzero(turns * np.sign(np.sum(turns)) <= 1e-6)
    around = np.abs(np.sum(np.arctan2(bend, (ahead * back).sum(axis=1))))
    if wrong.size:
        at = list(points[wrong[0]])
        yield f"shape.points.{wrong[0]} = {at}: the polygon is not convex there; leave the corner out"
    elif abs(around - 2.0 * math.pi) > 1e-6:
        yield f"shape.points = {told(points)}: goes around more than once; give each corner once, in order"


@cache
def centred(points):
    """Corners (k, 2), m, anticlockwise, about their centre of area."""
    corners = np.array(points, float)
    corners -= corners.mean(axis=0)  # or the sums lose their digits far from the origin, as on a map
    x, y = corners.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    if cross.sum() < 0.0:
        return centred(points[::-1])
    middle = (corners + np.roll(corners, -1, axis=0)) * cross[:, None]
    area = cross.sum()
    return corners - (middle.sum(axis=0) / (3.0 * area) if area else 0.0)


def moments_of(corners):
    """Area, m2, and its second moments (xx, xy, yy), m4, about the origin, of a polygon that is anticlockwise."""
    x, y = corners.T
    p, q = np.roll(x, -1), np.roll(y, -1)
    cross = x * q - p * y
    square = [np.sum(cross * (a * a + a * b + b * b)) / 12.0 for a, b in ((x, p), (y, q))]
    mixed = np.sum(cross * (x * q + 2.0 * x * y + 2.0 * p * q + p * y)) / 24.0
    return float(cross.sum() / 2.0), (float(square[0]), float(mixed), float(square[1]))


def sides_table(corners, margin):
    """Rows (k, 8) of the sides of a polygon: outward normal, offset, start, length, and corners of its core.

    The core is the polygon with its sides moved in by `margin`, m; where it has fewer corners the last is repeated.
    """
    core = [p for p, q in inset(corners, margin) if (p != q).any()]
    rows = []
    for k, ((normal, offset), p, q) in enumerate(zip(sides_of(corners), corners, np.roll(corners, -1, 0), strict=True)):
        rows.append([*normal, offset, *p, np.linalg.norm(q - p), *core[min(k, len(core) - 1)]])
    return np.array(rows)


def flat_away(points, corners):
    """Signed distances (n,), m, of points (n, 2) from a polygon."""
    highest, least = np.full(len(points), -math.inf), np.full(len(points), math.inf)
    for (normal, offset), p, q in zip(sides_of(corners), corners, np.roll(corners, -1, axis=0), strict=True):
        highest = np.maximum(highest, points @ normal - offset)
        along = np.clip((points - p) @ (q - p) / ((q - p) @ (q - p)), 0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(points - p - along[:, None] * (q - p), axis=1))
    return np.where(highest <= 0.0, highest, least)


def spread(start, end, wanted):
    """Points (n, 2) from `start` to `end`, at most `wanted`, m, apart, three or more; the length of each (n,), m."""
    length = np.linalg.norm(end - start)
    count = max(math.ceil(length / wanted - 1e-9), 2)
    share = np.full(count + 1, length / count)
    share[[0, -1]] *= 0.5
    return start + np.linspace(0.0, 1.0, count + 1)[:, None] * (end - start), share


@compiled
def flat_distance(u, v, sides):
    """(signed distance of a point of the plane from a polygon, m, outward normal there, two numbers)."""
    best, highest = 0, -math.inf
    for k in range(len(sides)):
        high = sides[k, 0] * u + sides[k, 1] * v - sides[k, OFFSET]
        if high > highest:
            best, highest = k, high
    if highest <= 0.0:
        return highest, sides[best, 0], sides[best, 1]
    least, x, y = math.inf, 0.0, 0.0
    for k in range(len(sides)):
        if sides[k, 0] * u + sides[k, 1] * v - sides[k, OFFSET] > 0.0:
            du, dv = u - sides[k, START], v - sides[k, START + 1]
            along = min(max(dv * sides[k, 0] - du * sides[k, 1], 0.0), sides[k, LENGTH])
            du, dv = du + along * sides[k, 1], dv - along * sides[k, 0]
            if du * du + dv * dv < least:
                least, x, y = du * du + dv * dv, du, dv
    length = math.sqrt(least)
    return length, x / length, y / length


@compiled
def flat_crossing(u, v, du, dv, sides):
    """See `disc.flat_crossing`."""
    enter, leave = -math.inf, math.inf
    for k in range(len(sides)):
        slope, room = sides[k, 0] * du + sides[k, 1] * dv, sides[k, OFFSET] - sides[k, 0] * u - sides[k, 1] * v
        if abs(slope) < 1e-12:
            if room < 0.0:
                return math.inf, -math.inf
        elif slope > 0.0:
            leave = min(leave, room / slope)
        else:
            enter = max(enter, room / slope)
    return enter, leave


@compiled
def flat_reach(du, dv, sides):
    """How far the polygon reaches along (du, dv), m."""
    most = -math.inf
    for k in range(len(sides)):
        most = max(most, sides[k, START] * du + sides[k, START + 1] * dv)
    return most


@compiled
def flat_core(du, dv, sides):
    """The corner of its core that lies farthest along (du, dv), two numbers, m."""
    best, most = 0, -math.inf
    for k in range(len(sides)):
        along = sides[k, CORE] * du + sides[k, CORE + 1] * dv
        if along > most:
            best, most = k, along
    return sides[best, CORE], sides[best, CORE + 1]


@compiled
def flat_depth(u, v, du, dv, sides, ramp, lateral):
    """See `box.depth`: of the sides alone."""
    depth, weight = math.inf, 1.0
    for k in range(len(sides)):
        along = sides[k, 0] * du + sides[k, 1] * dv
        room = sides[k, OFFSET] - sides[k, 0] * u - sides[k, 1] * v
        if abs(along) < lateral:
            weight = min(weight, 1.0 + room / ramp)
        elif along < 0.0:
            if room < 0.0:
                return 0.0, 0.0
        else:
            depth = min(depth, room / along)
    return depth, weight
