"""Energy of water, bodies and contacts, and what the gate has done."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.case.scales import gravity_at, scales
from parsim.geometry.faces import period
from parsim.machine.jit import kernel
from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Energy:
    """One row: the step, the parts and their sum; work done and energy lost so far.

    Potential energy is told from the box's lowest corner, so that shares of the sum do not hang on where z = 0 is.
    """

    name = "energy"
    columns = columns(
        dt="s",
        kinetic_water="J",
        potential_water="J",
        elastic_water="J",
        kinetic_bodies="J",
        potential_bodies="J",
        elastic_contacts="J",
        work_driven="J",
        dissipated_contacts="J",
        total="J",
    )

    def __init__(self, case: Case) -> None:
        self._case, self._unit, self._period = case, scales(case).energy, period(case)
        corners = zip(case.gravity, case.box.min, case.box.max, strict=True)
        self._deep = np.array([high if pull > 0.0 else low for pull, low, high in corners])

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        p, at, out = s.domain.particles, s.near.fluid, np.empty((s.near.fluid.size, 3))
        # nothing falls along an axis that repeats
        pull = np.where(np.isinf(self._period), gravity_at(self._case, s.time), 0.0)
        gravity, floor = tuple(pull.tolist()), float(pull @ self._deep)
        energies(at, p.kinematics, s.scheme.mass, gravity, out)
        out[:, 1] += s.scheme.mass * floor
        out[:, :2] *= s.scheme.shares(p, at)[:, None]
        out[:, 2] = s.scheme.elastic(p, at)
        b, c = s.bodies, s.contacts
        held, dissipated = c.energies()
        parts = [
            *map(float, s.domain.sum(out, self._unit)),
            b.kinetic_energy(),
            b.potential_energy(gravity) + floor * float(b.mass[~b.gone].sum()),
            held,
        ]
        return [[s.dt, *parts, c.driven_work + s.solids.pull.work, dissipated, sum(parts)]]


@kernel
def energies(at, kinematics, mass, gravity, out):
    """Kinetic and potential energy, J, of each fluid particle `at`, of `mass`, kg: out (n, 2 or more)."""
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    gx, gy, gz = gravity
    for row in range(at.size):
        i = at[row]
        out[row, 0] = 0.5 * mass * (u[i] * u[i] + v[i] * v[i] + w[i] * w[i])
        out[row, 1] = -mass * (gx * x[i] + gy * y[i] + gz * z[i])
