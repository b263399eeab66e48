"""Walls of the box: fixed particles that continue the lattice of the water outward, layer by layer."""

import numpy as np

from parsim.geometry.faces import SIDES
from parsim.particles.state import WALL, Particles, make_id


def lattice_axis(case, axis, layers):
    """Lattice coordinates along an axis, m, `layers` beyond each wall, and which side each is on (-1, 0, 1).

    Where the walls beside a side go on, the coordinates do too, as if they were in the box.
    """
    if case.dimensions == 2 and axis == 1:
        return np.array([0.5]), np.zeros(1, np.int64)
    count = round(case.box.size[axis] / case.spacing)
    low, high = (getattr(case.box.faces, side) for side in SIDES[axis])
    below, above = (layers if side.holds_water or side.continues else 0 for side in (low, high))
    index = np.arange(-below, count + above)
    side = ((index >= count) & high.holds_water).astype(np.int64) - ((index < 0) & low.holds_water)
    return case.box.min[axis] + (index + 0.5) * case.spacing, side


def samples_of(kind, x, y, z):
    """Particles of one kind on the product of three coordinate arrays, z fastest, numbered in that order."""
    grid = np.meshgrid(x, y, z, indexing="ij")
    flat = [axis.ravel() for axis in grid]
    count = flat[0].size
    return Particles(count, id=make_id(kind, np.arange(count)), kind=kind, x=flat[0], y=flat[1], z=flat[2])


class Walls:
    """The wall particles of a case; those that see no water sleep and cost one look each per rebuild."""

    def __init__(self, case, layers):
        axes = [lattice_axis(case, axis, layers) for axis in range(3)]
        sides = np.meshgrid(*(side for _, side in axes), indexing="ij", sparse=True)
        outside = np.nonzero((sides[0] != 0) | (sides[1] != 0) | (sides[2] != 0))
        self._x, self._y, self._z = (axis[0][index] for axis, index in zip(axes, outside, strict=True))
        self._id = make_id(WALL, np.arange(self._x.size))
        self._layers = self._here = self._cells = None

    def __len__(self):
        return self._x.size

    def samples(self, slab, time):
        """Wall particles of the slab that may see water."""
        if self._layers != (slab.begin, slab.end):
            self._layers = (slab.begin, slab.end)
            cells = slab.cells(self._x, self._y, self._z)
            self._here = np.flatnonzero(cells >= 0)
            self._cells = cells[self._here]
        at = self._here[slab.awake(self._cells)]
        return Particles(at.size, id=self._id[at], kind=WALL, x=self._x[at], y=self._y[at], z=self._z[at])
