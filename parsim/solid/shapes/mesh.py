"""A mesh of triangles from a file, convex or not, closed or made a shell: its table, and what follows from it.

What takes long to import is imported where a mesh is read.
"""

import functools
import math
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Moderate
from parsim.errors import InputError
from parsim.solid.shapes.meshed import DIGEST, Meshed, cut, mark_of
from parsim.solid.shapes.samples import Samples, face_of

_NODES = 64  # of the field along its longest side, where nothing else is asked for
_ACROSS = 4  # of them across its shortest side, if that is more
_MOST = 400  # of them at most
_CLOSE = 0.1  # share of its volume that the field may be off
_LEAST_SHARE = 0.1  # of a lattice point that a sample stands for; what is less goes to its neighbours


class MeshShape(Meshed):
    """A closed surface of triangles from a file, or the shell along an open one."""

    kind: Literal["mesh"] = Field(description="a mesh of triangles from a file; 3D only")
    file: str = Field(description="STL, OBJ, PLY or VTU; a path from where the case is, any origin")
    scale: Moderate = Field(1.0, description="length, m, of one unit of the file: 0.001 for millimetres")
    thickness: Moderate | None = Field(
        None, description="of the shell that an open surface becomes, m, half on either side; left out: it is closed"
    )
    resolution: Moderate | None = Field(
        None,
        description="distance between nodes of its field, m; left out: a 64th of its longest side, half of thickness",
    )
    digest: str | None = Field(None, description=DIGEST)

    def completed(self):
        """See `ShapeTable`. Raises InputError for a file that holds no mesh."""
        _ = self._mesh
        return super().completed()

    @property
    def _mesh(self):
        return _read(self.file, mark_of(self.file), self.scale, self.thickness)

    @property
    def field(self):
        """Its signed distances: `geometry.field.Field`."""
        return _field(self.file, mark_of(self.file), self.scale, self.thickness, self.step)

    @property
    def step(self):
        """Distance between the nodes of its field, m."""
        sides = np.ptp(self._mesh.points, axis=0)
        wanted = min(sides.max() / _NODES, sides.min() / _ACROSS, 0.5 * (self.thickness or math.inf))
        return self.resolution or float(max(wanted, sides.max() / _MOST))

    def told(self):
        """See `ShapeTable`."""
        return f'shape.file = "{self.file}" of {" x ".join(f"{2.0 * h:.4g}" for h in self.half)} m'

    def faults(self, planar):
        """See `ShapeTable`."""
        if planar:
            yield 'shape.kind = "mesh": a 2D case has none; use a polygon'
        try:
            sides = np.ptp(self._mesh.points, axis=0)
        except InputError as error:
            yield f"shape.file: {error}"
            return
        low, high = sides.max() / _MOST, 0.5 * sides.min()
        if low > high:
            yield f"{self.told()}: too thin for a field; its thinnest side must be a {_MOST // 2}th of its longest"
        elif not low <= self.step <= high:
            yield f"shape.resolution = {self.resolution}: must be between {low:.4g} and {high:.4g} m for this mesh"
        elif abs(self._inside() / self.volume - 1.0) > _CLOSE:
            yield (
                f"{self.told()}: its field, {self.step:.4g} m between nodes, encloses {self._inside():.4g} m3, its "
                f"triangles {self.volume:.4g}; pieces of it overlap, or shape.resolution must be finer than its walls"
            )
        yield from self.changed()

    def _inside(self):
        """Volume, m3, inside by its field."""
        share = np.clip(0.5 - self.field.value / self.step, 0.0, 1.0)
        return float(share.sum() * self.step**3)

    def hint(self, room):
        """See `ShapeTable`."""
        if max(self.half) < max(room):
            return ""
        return f"; {self.told()} at shape.scale = {self.scale:g}: for a file in millimetres it is 0.001"

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`: a lattice, each point with the share of its cell that is inside; patches of its surface."""
        low, high = self._mesh.points.min(axis=0), self._mesh.points.max(axis=0)
        count = np.maximum(np.round((high - low) / spacing).astype(int), 1)
        axes = [a + (np.arange(n) + 0.5) * (b - a) / n for a, b, n in zip(low, high, count, strict=True)]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
        away = self.away(points)
        share = np.clip(0.5 - away / spacing, 0.0, 1.0)
        kept = share >= _LEAST_SHARE if (share >= _LEAST_SHARE).any() else away == away.min()
        points, away, share = points[kept], away[kept], np.maximum(share[kept], _LEAST_SHARE)
        share *= self.volume / spacing**3 / share.sum()
        near = -away < depth
        points, share = points[near], share[near]
        corners, triangles = cut(self._mesh, spacing)
        place = corners[triangles].mean(axis=1)
        normal = 0.5 * np.cross(*(corners[triangles[:, k]] - corners[triangles[:, 0]] for k in (1, 2)))
        area = np.linalg.norm(normal, axis=1)
        place, normal, area = place[area > 0.0], normal[area > 0.0] / area[area > 0.0, None], area[area > 0.0]
        sample = np.array([np.argmin(((points - x) ** 2).sum(axis=1)) for x in place])
        return Samples(points, share, sample, face_of(normal), np.ones(len(area), bool), place, normal, area)


@functools.cache
def _read(file, mark, scale, thickness):
    from parsim.geometry.mesh import read

    return read(Path(file), scale, thickness)


@functools.cache
def _field(file, mark, scale, thickness, step):
    from parsim.geometry.field import field_of

    mesh = _read(file, mark, scale, thickness)
    return field_of(mesh.points, mesh.triangles, step)
