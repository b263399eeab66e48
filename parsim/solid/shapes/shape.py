"""What every shape of a body is, in its own frame, whose origin is the centre of mass and whose axes are principal."""

from typing import ClassVar, NamedTuple

import numpy as np

from parsim.case.types import Table


class Samples(NamedTuple):
    """Points at which a body is sampled for the water.

    offsets (n, 3), m; shares (n,), the volume of each over that of a lattice point. Of the patches of its surface, one
    for each sample of the outer layer and side it belongs to: sample (p,); face (p,), 2 axis + 1 of the direction in
    which it looks most, less 1 where that is downwards; rim (p,), whether water comes to the side there; place (p, 3),
    m, on the surface; normal (p, 3), outwards; area (p,), m2.
    """

    offsets: np.ndarray
    shares: np.ndarray
    sample: np.ndarray
    face: np.ndarray
    rim: np.ndarray
    place: np.ndarray
    normal: np.ndarray
    area: np.ndarray


class ShapeTable(Table):
    """What a case may say of a shape, and what follows from it. `planar`: of a 2D case, one metre across.

    NUMBER tells kernels what it is (`shapes.kernels`); ROUND: touches at one point, else by its contact elements.
    half (3,), m: half edges of the box around it; volume, m3.
    """

    NUMBER: ClassVar[int]
    ROUND: ClassVar[bool] = False

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

    def radius(self, planar):
        """Radius of the ball, in a plane of the disc, around it, m."""
        raise NotImplementedError

    def reach(self, direction):
        """Half extent along a unit vector (3,) in its frame, m."""
        raise NotImplementedError

    def inertia(self, mass):
        """Principal moments (3,), kg m2."""
        raise NotImplementedError

    def draught(self, density, of_water):
        """How deep it floats level, m, by its density and that of the water, kg/m3."""
        raise NotImplementedError

    def surface(self):
        """Its surface: points (k, 3), m, and quads (m, 4) of them, anticlockwise seen from outside."""
        raise NotImplementedError

    def elements(self, planar, spacing=None):
        """Contact elements (n, 6) and the distances between them (3,), m: see `shapes.elements_of`."""
        raise NotImplementedError

    def number_of_samples(self, spacing, depth, planar):
        """How many `samples` there are, without making them."""
        raise NotImplementedError

    def samples(self, spacing, depth, planar):
        """`Samples` at about the `spacing`, m, down to a `depth`, m, below the surface."""
        raise NotImplementedError
