"""What of the pressure equation is smooth, on a lattice of nodes fixed in space (Xu 1996: auxiliary space).

The diagonal alone takes as many iterations as the water is particles deep. What it leaves is smooth: a node every four
spacings can hold it, particles between nodes having their multilinear mean. The lattice's equation is made for it, with
the energy that pairs of particles give to linear pressures between two nodes, and it is solved, about, by one cycle of
`multigrid` on all ranks alike. Added to the inverse diagonal that is symmetric and positive, and since all that
particles give to nodes is summed in whole numbers, the same on any ranks.
"""

import math

import numpy as np

from parsim.case.scales import power_of_two
from parsim.fluid.simps import nodes
from parsim.fluid.simps.multigrid import Multigrid
from parsim.geometry.faces import repeats

_PITCH = 4.0  # spacings from node to node: 3 takes a tenth fewer iterations, with twice the nodes
_FINE = 2.0**40  # parts of the largest term in sums that are made once
_PARTS = 2.0**36  # of the norm of all of them in sums of every iteration, see `nodes.LARGEST`
_SMALLEST = 1e-280  # of what units are made of


class Coarse:
    """The lattice of a case, of the box that holds its water in a step; `lattice` is that of the weights.

    `prepare` comes before the others. r (fluid,) is a residual of the equation, in the order of `near.fluid`.
    """

    def __init__(self, case, lattice):
        pitch, size = np.full(3, _PITCH * lattice.spacing), np.array(case.box.size, float)
        self._ring = np.array(repeats(case), np.int64)
        around = np.maximum(np.floor(size / pitch * (1.0 + 1e-12)), 1.0)
        pitch = np.where(self._ring == 1, size / around, pitch)
        self._around, self._low = around.astype(np.int64), np.array(case.box.min, float)
        self._inverse, self._sides = 1.0 / pitch, lattice.dimensions - 1
        if lattice.dimensions == 2:
            self._inverse[1], self._ring[1], self._around[1] = 0.0, 0, 1
        self._stiff = lattice.spread / (2.0 * lattice.dimensions) * self._inverse**2
        self._frame = self._grid = self._places = None
        self._unit = self._largest = 0.0

    def prepare(self, flow, equation, diagonal):
        """Make the lattice's equation from `equation`; `diagonal` (particles,) has the bodies in it."""
        at, place = flow.near.fluid, flow.particles.place
        held = np.maximum(equation.diagonal[at] - equation.water[at], 0.0)
        ends = [[-v[at].min(initial=np.inf), v[at].max(initial=-np.inf)] for v in place]
        sizes = [each.max(initial=0.0) for each in (equation.water[at], held, diagonal[at])]
        *ends, water, most, self._largest = flow.domain.max(*np.ravel(ends), *sizes).tolist()
        self._enclose(np.reshape(ends, (3, 2)) * [-1.0, 1.0])
        unit = power_of_two(max(most, _SMALLEST))
        units = np.array([*(power_of_two(max(s * water, _SMALLEST)) for s in self._stiff), unit]) / _FINE
        sums = np.zeros((4, self._grid.size), np.int64)
        places = self._places = nodes.Places(*np.empty((3, at.size, 2), np.int32), np.empty((at.size, 3)), self._sides)
        nodes.find(at, place, self._frame, places)
        nodes.lay(places, (equation.water[at], held), self._stiff, 1.0 / units, sums)
        sums = flow.domain.whole(sums.ravel()).reshape(4, -1) * units[:, None]
        self._grid.edges[:, : self._grid.size], self._grid.held[: self._grid.size] = sums[:3], sums[3]
        self._grid.prepare()

    def _enclose(self, ends):
        """The nodes around `ends` (3, 2), m."""
        first, last = np.floor((np.where(np.isfinite(ends), ends, 0.0).T - self._low) * self._inverse).astype(np.int64)
        count = np.where(self._inverse > 0.0, last - first + 2, 1)
        ring = self._ring == 1
        first, count = np.where(ring, 0, first), np.where(ring, self._around, count)
        if self._grid is None or (self._frame.count != count).any():
            self._grid = Multigrid(count, ring)
        self._frame = nodes.Frame(self._low, self._inverse, first, count, self._ring)

    def gather(self, r, norm):
        """What r gives to the nodes, whole numbers (nodes,) of this rank.

        norm: about that of r by the inverse diagonal; an r that has grown out of all bounds becomes nan.
        """
        self._unit = power_of_two(max(norm * math.sqrt(self._largest), _SMALLEST)) / _PARTS
        sums = np.zeros(self._grid.size, np.int64)
        if not nodes.gather(self._places, r, 1.0 / self._unit, sums):
            r[:] = np.nan
        return sums

    def spread(self, sums, z):
        """Add to z (fluid,) what the lattice makes of the `sums` of all ranks; returns the product of r and that."""
        values, product = self._grid.solve(sums * self._unit)
        nodes.spread(self._places, values, z)
        return product
