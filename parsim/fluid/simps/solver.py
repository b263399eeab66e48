"""Conjugate gradients for the pressure equation, preconditioned with its diagonal (Saad 2003, alg. 9.1).

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
    inverse diagonal. tolerance: of that; most: iterations.
    """

    def __init__(self, tolerance, most):
        self.tolerance, self.most = tolerance, most
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
        wanted, step, self.iterations = self.tolerance**2 * scale, z, 0
        while left > wanted or math.isnan(left):
            if self.iterations == self.most or math.isnan(left):
                raise RunError(self._told(left, scale, time))
            p.way[at] = step
            image, pushed = self._applied(flow, equation, mobility, factor, "way", out, send=True)
            unit = power_of_two(max(left, _SMALLEST))
            length = left / domain.dot(step, image, unit)
            x += length * step
            r -= length * image
            forces = None if forces is None else forces + length * pushed
            z = inverse * r
            before, left = left, domain.dot(r, z, unit)
            step = z + left / before * step
            self.iterations += 1
        self.residual = math.sqrt(left / scale) if scale > 0.0 else 0.0
        p.p[at] = x
        return forces

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
