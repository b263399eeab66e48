"""What every shape of a body is, in its own frame, whose origin is the centre of mass and whose axes are principal."""

from typing import ClassVar

import numpy as np

from parsim.case.types import Table
from parsim.solid.shapes.surface import volume_under

_MOST = 10**6  # samples that are made to be counted


class ShapeTable(Table):
    """What a case may say of a shape, and what follows from it. `planar`: of a 2D case, one metre across.

    NUMBER tells kernels what it is (`shapes.kernels`); ROUND: touches at one point, else by its contact elements. FLAT:
    a body of a plane alone.
    half (3,), m: half edges of the box around it, about its centre; volume, m3. turn: quaternion (4,) from its frame
    to that in which the case gives its angles.
    """

    NUMBER: ClassVar[int]
    ROUND: ClassVar[bool] = False
    FLAT: ClassVar[bool] = False

    @property
    def turn(self):
        """See above."""
        return 1.0, 0.0, 0.0, 0.0

    @property
    def half(self):
        """See above."""
        raise NotImplementedError

    @property
    def volume(self):
        """See above."""
        raise NotImplementedError

    def told(self):
        """Key and value of its size, for messages."""
        raise NotImplementedError

    def faults(self, planar):
        """What is wrong with it: messages."""
        raise NotImplementedError

    def completed(self):
        """The same with what is noted when a case is completed."""
        return self

    def hint(self, room):
        """What may be wrong where it does not fit into the room (3,), m: the end of a message."""
        return ""

    def radius(self, planar):
        """Radius of the ball, in a plane of the disc, around it, m."""
        raise NotImplementedError

    def reach(self, direction):
        """Half extent along a unit vector (3,) in its frame, m."""
        raise NotImplementedError

    def inertia(self, mass):
        """Principal moments (3,), kg m2."""
        raise NotImplementedError

    def thinnest(self, planar):
        """Half of its least width, m."""
        return min(self.half[a] for a in ((0, 2) if planar else (0, 1, 2)))

    def normals(self):
        """Normals (n, 3) of its faces, or of their pairs."""
        return np.eye(3)

    def away(self, points):
        """Signed distances (n,), m, of points (n, 3) in its frame from its surface, negative inside."""
        raise NotImplementedError

    def sides(self):
        """Sides of the polygon that it is in a plane, (k, 8): see `forms.Forms`."""
        return np.zeros((0, 8))

    @property
    def field(self):
        """`geometry.field.Field` of its signed distances, None where they have a closed form."""
        return None

    def under(self, up, level):
        """Volume, m3, of what lies under `level`, m, along the unit vector `up` (3,) from its centre."""
        points, quads = self.surface()
        return volume_under(points @ np.array(up) - level, points, quads)

    def afloat(self, share, up=(0.0, 0.0, 1.0)):
        """Height of its centre above the water, m, with `share` of its volume under it; `up` (3,) in its frame."""
        whole = self.under(up, self.reach(up))
        low, high = -self.reach([-v for v in up]), self.reach(up)
        for _ in range(60):
            level = 0.5 * (low + high)
            low, high = (level, high) if self.under(up, level) < share * whole else (low, level)
        return -low

    def draught(self, density, of_water):
        """How deep it floats level, m, by its density and that of the water, kg/m3."""
        return self.reach((0.0, 0.0, -1.0)) - self.afloat(density / of_water)

    def surface(self):
        """Its surface: points (k, 3), m, and quads (m, 4) of them, anticlockwise seen from outside."""
        raise NotImplementedError

    def elements(self, planar, spacing=None):
        """Contact elements (n, 6) and the distances between them (3,), m: see `shapes.elements_of`."""
        raise NotImplementedError

    def number_of_samples(self, spacing, depth, planar):
        """How many `samples` there are; of a vast number about how many, by volume and surface."""
        cell = spacing ** (2 if planar else 3)
        if self.volume <= _MOST * cell:
            return len(self.samples(spacing, depth, planar).shares)
        points, quads = self.surface()
        area = sum(
            0.5 * np.linalg.norm(np.cross(*(points[quads[:, k]] - points[quads[:, 0]] for k in pair)), axis=1)
            for pair in ((1, 2), (2, 3))
        ).sum()
        rim = area - 2.0 * self.volume if planar else area  # both ends of what is a metre across are no surface
        return round(min(self.volume, rim * depth) / cell)

    def samples(self, spacing, depth, planar):
        """`Samples` at about the `spacing`, m, down to a `depth`, m, below the surface."""
        raise NotImplementedError
