"""Conjugate gradients for the pressure equation, preconditioned (Saad 2003, alg. 9.1) with its diagonal and a lattice.

All sums are exact, and everything else is of one particle or one row: the same bits on any ranks and threads.
"""

import math

import numpy as np

from parsim.case.scales import power_of_two
from parsim.errors import RunError
from parsim.fluid.simps import sweeps

_SMALLEST = 1e-280  # of what units are made of


class Solver:
    """Solves for the field `p` of a domain, beginning with what it holds, by a direction in the field `way`.

    iterations, residual: those of the last solution; the residual is over the right-hand side, both in the norm of the
    inverse diagonal. tolerance: of that; most: iterations; coarse: a `Coarse`, or None for the diagonal alone.
    """

    def __init__(self, tolerance, most, coarse=None):
        self.tolerance, self.most, self.coarse = tolerance, most, coarse
        self.iterations, self.residual = 0, 0.0

    def solve(self, flow, equation, mobility, factor, time):
        """Set p of this rank's water; `mobility` of the bodies or None, `factor` that of `Mobility.open`.

        Returns the forces of these pressures on the bodies, (bodies, 6), N and N m, or None. Raises RunError, on all
        ranks alike, where the tolerance is not met.
        """
        p, domain, at = flow.particles, flow.domain, flow.near.fluid
        diagonal, out = equation.diagonal.copy(), np.zeros(len(p))
        if mobility:
            mobility.diagonal(factor, diagonal)
        inverse = 1.0 / diagonal[at]
        x, right = p.p[at], equation.right[at]
        image, forces = self._applied(flow, equation, mobility, factor, "p", out)
        r = right - image
        z = inverse * r
        sizes = np.stack([r * z, right * inverse * right, x * image], axis=1)
        unit = power_of_two(max(float(domain.max(np.abs(sizes).max(initial=0.0))[0]), _SMALLEST))
        left, whole, held = domain.sum(sizes, unit).tolist()
        scale = max(whole, held)
        wanted, slope, self.iterations = self.tolerance**2 * scale, left, 0
        if self.coarse and left > wanted:
            self.coarse.prepare(flow, equation, diagonal)
            left, slope = self._look_through(flow, r, z, left)
        step = z
        while left > wanted or math.isnan(left):
            if self.iterations == self.most or math.isnan(left):
                raise RunError(self._told(left, scale, time))
            p.way[at] = step
            image, pushed = self._applied(flow, equation, mobility, factor, "way", out, send=True)
            unit = power_of_two(max(slope, _SMALLEST))
            length = slope / domain.dot(step, image, unit)
            x += length * step
            r -= length * image
            forces = None if forces is None else forces + length * pushed
            z = inverse * r
            before, (left, slope) = slope, self._look_through(flow, r, z, left)
            step = z + slope / before * step
            self.iterations += 1
        self.residual = math.sqrt(left / scale) if scale > 0.0 else 0.0
        p.p[at] = x
        return forces

    def _look_through(self, flow, r, z, left):
        """Add to z (fluid,), r (fluid,) times the inverse diagonal, what the lattice has of it.

        left: about the product of r and the first z. Returns that, and the product of r and the last.
        """
        unit = power_of_two(max(left, _SMALLEST))
        if self.coarse is None:
            left = flow.domain.dot(r, z, unit)
            return left, left
        sums = self.coarse.gather(r, math.sqrt(left))
        left = flow.domain.dot(r, z, unit, sums)
        return left, left + self.coarse.spread(sums, z)

    def _applied(self, flow, equation, mobility, factor, name, out, send=False):
        """The matrix times the field of this `name`, (fluid,), and its forces on bodies; `send`: to the halos first."""
        near, domain, values = flow.near, flow.domain, getattr(flow.particles, name)
        if send:
            with domain.refreshing(name):
                sweeps.apply(near.inner, near.lists, equation, values, out)
        else:
            sweeps.apply(near.inner, near.lists, equation, values, out)
        sweeps.apply(near.border, near.lists, equation, values, out)
        if mobility is None:
            return out[near.fluid], None
        forces = mobility.forces(values)
        mobility.open(mobility.accelerations(forces), factor, out)
        return out[near.fluid], forces

    def _told(self, left, scale, time):
        residual = math.sqrt(left / scale) if scale > 0.0 and left >= 0.0 else math.nan
        return (
            f"t = {time:.6g} s: the pressure equation is not solved: residual {residual:.3g} after {self.iterations} "
            f"iterations, wanted {self.tolerance:.3g}. water.scheme.iterations is too few, water.scheme.tolerance too "
            "small, or what moves has gone wrong before: a smaller run.cfl then helps"
        )
