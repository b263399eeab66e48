"""Energy of water, bodies and contacts, and what the gate has done."""

import math

import numpy as np

from parsim.case.scales import scales
from parsim.machine.jit import kernel
from parsim.observe.observer import columns


class Energy:
    """One row: the step, the parts and their sum; work done and energy lost so far."""

    name = "energy"
    columns = columns(
        dt="s",
        kinetic_water="J",
        potential_water="J",
        elastic_water="J",
        kinetic_bodies="J",
        potential_bodies="J",
        elastic_contacts="J",
        work_gate="J",
        dissipated_contacts="J",
        total="J",
    )

    def __init__(self, case):
        self._gravity, self._unit = case.gravity, scales(case).energy

    def rows(self, s):
        """See `Observer`."""
        p, at, out = s.domain.particles, s.near.fluid, np.empty((s.near.fluid.size, 3))
        constants = s.scheme.mass, s.scheme.lattice.number, s.scheme.sound**2
        energies(at, p.kinematics, p.n, constants, self._gravity, out)
        b, c = s.bodies, s.contacts
        parts = [
            *map(float, s.domain.sum(out, self._unit)),
            b.kinetic_energy(),
            b.potential_energy(self._gravity),
            c.elastic_energy(),
        ]
        return [[s.dt, *parts, c.gate_work, c.dissipated, sum(parts)]]


@kernel
def energies(at, kinematics, n, water, gravity, out):
    """Kinetic, potential and elastic energy, J, of each fluid particle `at`: out (n, 3).

    Elastic: what the pair forces put into n, the integral of p / (rho0 s) over s = n / n0 of the state,
    c0^2 / 7 ((s^7 - 1) / 7 - ln s). `water`: mass of a particle, kg, n0, c0^2, m2/s2; gravity (3,), m/s2.
    """
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    mass, n0, sound2 = water
    gx, gy, gz = gravity
    for row in range(at.size):
        i = at[row]
        s = n[i] / n0
        s2 = s * s
        out[row, 0] = 0.5 * mass * (u[i] * u[i] + v[i] * v[i] + w[i] * w[i])
        out[row, 1] = -mass * (gx * x[i] + gy * y[i] + gz * z[i])
        out[row, 2] = mass * sound2 / 7.0 * ((s2 * s2 * s2 * s - 1.0) / 7.0 - math.log(s))
