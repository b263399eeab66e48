"""What every shape has that is a closed surface of triangles with a field of signed distances."""

import functools
import hashlib
from pathlib import Path

import numpy as np

from parsim.solid.shapes.shape import ShapeTable

DIGEST = "SHA-256 of the file, noted when the case is completed"


class Meshed(ShapeTable):
    """A closed surface of triangles: `_mesh`, a `geometry.mesh.Mesh`, and its `field`, a `geometry.field.Field`, that
    come from `file`, whose SHA-256 is `digest`."""

    NUMBER = 7

    def completed(self):
        """See `ShapeTable`."""
        return self if self.digest else self.model_copy(update={"digest": digest_of(self.file, mark_of(self.file))})

    def changed(self):
        """Whether its file has changed since the case was completed: messages."""
        if self.digest and self.digest != digest_of(self.file, mark_of(self.file)):
            yield f'shape.file = "{self.file}": has changed; its SHA-256 is not {self.digest[:12]}... any more'

    @property
    def turn(self):
        """See `ShapeTable`."""
        return self._mesh.turn

    @property
    def half(self):
        """See `ShapeTable`."""
        return tuple(float(v) for v in np.abs(self._mesh.points).max(axis=0))

    @property
    def volume(self):
        """Volume, m3."""
        return self._mesh.volume

    def radius(self, planar):
        """See `ShapeTable`."""
        return float(np.linalg.norm(self._mesh.points, axis=1).max())

    def reach(self, direction):
        """See `ShapeTable`."""
        return float((self._mesh.points @ direction).max())

    def inertia(self, mass):
        """See `ShapeTable`."""
        return [float(moment) * mass / self.volume for moment in self._mesh.moments]

    def thinnest(self, planar):
        """Radius of the largest ball inside, m."""
        return float(-self.field.value.min())

    def away(self, points):
        """See `ShapeTable`; by its field."""
        from parsim.geometry.field import distances

        return distances(np.asarray(points, float), *flat(self.field))

    def surface(self):
        """See `ShapeTable`; the last corner of a triangle is there twice."""
        return self._mesh.points, self._mesh.triangles[:, [0, 1, 2, 2]]

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: at the corners of its triangles, cut to that size; each has a third of those around."""
        wanted = spacing or self.thinnest(False)
        points, triangles = cut(self._mesh, wanted)
        share = np.cross(*(points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))) / 6.0
        area = np.zeros_like(points)
        for k in range(3):
            np.add.at(area, triangles[:, k], share)
        return np.hstack([points, area]), [wanted] * 3


def flat(field):
    """(values (n,), grid (8,)) of a field as kernels take it: where it begins, nodes along the axes, step, start."""
    return field.value.ravel(), np.array([0.0, *field.value.shape, field.step, *field.start])


def cut(mesh, size):
    """Points (k, 3), m, and triangles (n, 3) of a mesh, cut until their edges are at most `size`, m, long."""
    import trimesh

    from parsim.geometry.mesh import joined

    return joined(*trimesh.remesh.subdivide_to_size(mesh.points, mesh.triangles, size, max_iter=20), 1e-6 * size)


def mark_of(file):
    """What tells whether a file has been written anew."""
    try:
        told = Path(file).stat()
    except OSError:
        return None
    return told.st_mtime_ns, told.st_size


@functools.cache
def digest_of(file, mark):
    """SHA-256 of a file with that mark, None where it cannot be read."""
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except OSError:
        return None
