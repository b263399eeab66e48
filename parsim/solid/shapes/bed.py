"""A bed: ground from a file over the whole box, down to its floor; it never moves.

Water sees it as columns of samples that hang from its surface, a spacing apart, so that it is as smooth as its heights.
"""

import functools
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Moderate, Number, Vector
from parsim.errors import InputError
from parsim.solid.shapes.meshed import DIGEST, Meshed, mark_of
from parsim.solid.shapes.samples import Samples, face_of
from parsim.terrain.height_field import HeightField
from parsim.terrain.place import Ground

_BEYOND = 6  # nodes by which its field goes on beyond its sides, which are walls: no way out of it leads through them
_MOST = 400**3  # nodes of a field
_COARSE = 0.5  # spacings by which it may be off between its heights


class BedShape(Ground, Meshed):
    """Ground between two corners in plan, over a floor; its origin is the middle of this floor."""

    kind: Literal["bed"] = Field(description="ground from a file, of a fixed body; made from the table [bed]")
    low: Vector = Field(description="its lowest corner, m; its z is that of its floor")
    high: tuple[Number, Number] = Field(description="its highest corner, m, without its z")
    resolution: Moderate = Field(description="distance between its heights, and between the nodes of its field, m")
    digest: str | None = Field(None, description=DIGEST)

    @property
    def centre(self):
        """Where its origin is in the case, (3,), m."""
        return (0.5 * (self.low[0] + self.high[0]), 0.5 * (self.low[1] + self.high[1]), self.low[2])

    @property
    def heights(self):
        """Its `HeightField` in the frame of the case, m. Raises InputError."""
        return _heights(self, mark_of(self.file))[0]

    @property
    def told_of_filling(self):
        """What was done where the file has no data, in words, empty for nothing."""
        return _heights(self, mark_of(self.file))[1]

    @property
    def _mesh(self):
        return _meshes(self, mark_of(self.file))[0]

    @property
    def field(self):
        """Its signed distances, as if it went on beyond its sides and its floor: `geometry.field.Field`."""
        return _meshes(self, mark_of(self.file))[1]

    def told(self):
        """See `ShapeTable`."""
        return f'shape.file = "{self.file}"'

    def faults(self, planar):
        """See `ShapeTable`."""
        if planar:
            yield 'shape.kind = "bed": a 2D case has none'
        if (least := float(np.prod(np.subtract(self.high, self.low[:2]) / self.resolution))) > _MOST:
            yield f"shape.resolution = {self.resolution}: makes {least:.3g} heights; at most {_MOST:.3g} nodes"
            return
        try:
            heights = self.heights
        except InputError as error:
            yield f"shape.file: {error}"
            return
        least, most = heights.z.min(), heights.z.max()
        nodes = np.prod([*heights.z.shape, (most - self.low[2]) / self.resolution])
        if least - self.low[2] < self.resolution:
            yield (
                f"shape: its lowest ground is at z = {least:.6g} m; must be a spacing, {self.resolution:g} m, or more "
                f"over the floor of the box, {self.low[2]:g}; change box.min or datum"
            )
        elif nodes > _MOST:
            yield f"shape.resolution = {self.resolution}: makes a field of {nodes:.3g} nodes; at most {_MOST:.3g}"
        yield from self.changed()

    def thinnest(self, planar):
        """See `ShapeTable`: of its sides and its height."""
        return 0.5 * float(min(*np.subtract(self.high, self.low[:2]), self.heights.z.max() - self.low[2]))

    def coarse(self):
        """How far it is off half way between its heights at most, m, where that is more than half of their distance."""
        surface, heights = _surface(self.file, mark_of(self.file), self.layout, self.river_reach), self.heights
        x, y = (0.5 * (row[1:] + row[:-1]) for row in (heights.x, heights.y))
        off = np.abs(surface.on(x, y, self.frame).z - heights.at(*np.meshgrid(x, y, indexing="ij")))
        most = float(np.nanmax(off, initial=0.0))
        return most if most > _COARSE * self.resolution else None

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: its heights; each has a third of the triangles around."""
        count = self.heights.z.size
        points, top = self._mesh.points, self._mesh.triangles
        top = top[(top < count).all(axis=1)]
        share = np.cross(*(points[top[:, k]] - points[top[:, 0]] for k in (1, 2))) / 6.0
        area = np.zeros((count, 3))
        for k in range(3):
            np.add.at(area, top[:, k], share)
        return np.hstack([points[:count], area]), [self.resolution] * 3

    def number_of_samples(self, spacing, depth, planar):
        """See `ShapeTable`: the heights, of which there are not too many, bound it."""
        return len(self.samples(spacing, depth, planar).shares)

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`: columns under its surface, of which patches are the tops."""
        ground, edges = self.heights, zip(self.low, self.high, strict=False)
        counts = [max(round((high - low) / spacing), 1) for low, high in edges]
        rows = [
            low + (np.arange(n) + 0.5) * (high - low) / n
            for low, high, n in zip(self.low, self.high, counts, strict=False)
        ]
        x, y = (row.ravel() for row in np.meshgrid(*rows, indexing="ij"))
        top, h = ground.at(x, y), 0.5 * spacing
        slope = np.stack([ground.at(x + h, y) - ground.at(x - h, y), ground.at(x, y + h) - ground.at(x, y - h)], -1)
        steep = np.sqrt(1.0 + ((slope / spacing) ** 2).sum(axis=1))
        thick, wanted = top - self.low[2], np.ceil(depth / spacing * steep)
        layers = np.maximum(np.minimum(np.round(thick / spacing), wanted), 1).astype(int)
        layer = np.where(thick < (wanted + 0.5) * spacing, thick / np.maximum(np.round(thick / spacing), 1.0), spacing)
        column = np.repeat(np.arange(top.size), layers)
        first = np.cumsum(layers) - layers
        under = (np.arange(column.size) - first[column] + 0.5) * layer[column]
        points = np.stack([x[column], y[column], top[column] - under], -1) - self.centre
        normal = np.column_stack([-slope / spacing, np.ones(top.size)]) / steep[:, None]
        return Samples(
            points,
            layer[column] / spacing,
            first,
            face_of(normal),
            np.ones(top.size, bool),
            np.stack([x, y, top], -1) - self.centre,
            normal,
            steep * spacing**2,
        )


@functools.cache
def _surface(file, mark, layout, reach):
    from parsim.terrain import read

    return read(Path(file), layout, reach)


@functools.cache
def _heights(shape, mark):
    """(heights of a bed, what was filled in words). Raises InputError."""
    surface, frame = _surface(shape.file, mark, shape.layout, shape.river_reach), shape.frame
    counts = [max(round((high - low) / shape.resolution), 1) for low, high in zip(shape.low, shape.high, strict=False)]
    x, y = (np.linspace(low, high, n + 1) for low, high, n in zip(shape.low, shape.high, counts, strict=False))
    _covered(surface, frame, x, y)
    return surface.on(x, y, frame).filled(shape.nodata)


def _covered(surface, frame, x, y):
    """Refuse a box that reaches beyond what the file covers."""
    places = np.stack(frame.of_file(*np.meshgrid(x, y, indexing="ij")), -1)
    near = 1e-9 * np.abs([surface.low, surface.high]).max()
    out = ((places < surface.low - near) | (places > surface.high + near)).any(axis=-1)
    if out.any():
        i, j = np.argwhere(out)[0]
        (left, low), (right, high) = surface.low, surface.high
        at = places[i, j]
        raise InputError(
            f"does not cover the box: {out.mean():.0%} of it is outside, such as x = {x[i]:.6g}, y = {y[j]:.6g} m, "
            f"which is ({at[0]:.10g}, {at[1]:.10g}) in the file; this reaches from ({left:.10g}, {low:.10g}) to "
            f"({right:.10g}, {high:.10g})"
        )


@functools.cache
def _meshes(shape, mark):
    """(`Mesh` of a bed about its origin, `Field` of it as it goes on beyond its sides)."""
    from parsim.geometry.field import field_of

    ground, h = shape.heights, shape.resolution
    mesh = _solid(ground, shape.low[2], shape.centre)
    row = [np.concatenate([r[0] - h * _PAD[::-1], r, r[-1] + h * _PAD]) for r in (ground.x, ground.y)]
    wide = HeightField(*row, np.pad(ground.z, _BEYOND, "edge"))
    around = _solid(wide, shape.low[2] - _BEYOND * h, shape.centre)
    return mesh, field_of(around.points, around.triangles, h)


_PAD = np.arange(1, _BEYOND + 1)


def _solid(ground, floor, origin):
    """`Mesh`, about an origin (3,), of what lies between ground and the height of a floor, m.

    Its points begin with the heights; the floor is a fan.
    """
    from parsim.geometry.mesh import Mesh

    x, y = np.meshgrid(ground.x, ground.y, indexing="ij")
    node = np.arange(x.size).reshape(x.shape)
    rim = np.concatenate([node[:-1, 0], node[-1, :-1], node[:0:-1, -1], node[0, :0:-1]])
    low = x.size + np.arange(rim.size)
    top = np.stack([x.ravel(), y.ravel(), ground.z.ravel()], -1)
    below = top[rim] * (1.0, 1.0, 0.0) + (0.0, 0.0, floor)
    middle = [[0.5 * (ground.x[0] + ground.x[-1]), 0.5 * (ground.y[0] + ground.y[-1]), floor]]
    points = np.concatenate([top, below, middle]) - origin
    a, b, c, d = (part.ravel() for part in (node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]))
    following, under = np.roll(rim, -1), np.roll(low, -1)
    faces = [(a, b, c), (a, c, d), (low, under, following), (low, following, rim)]
    faces.append((np.full(rim.size, len(points) - 1), under, low))
    triangles = np.concatenate([np.stack(each, -1) for each in faces])
    p, q, r = (points[triangles[:, k]] for k in range(3))
    volume = float((p * np.cross(q, r)).sum() / 6.0)
    square = [volume * float(side**2) / 12.0 for side in np.ptp(points, axis=0)]  # as of a box: it never turns
    moments = np.array([square[1] + square[2], square[0] + square[2], square[0] + square[1]])
    return Mesh(points, triangles, volume, moments, (1.0, 0.0, 0.0, 0.0), np.array(origin))
