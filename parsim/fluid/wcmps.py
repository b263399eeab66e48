"""Weakly compressible MPS (Mellado 2021, ch. 5; Jandaghian & Shakibaeinia 2020), explicit, symplectic in time.

One momentum and one continuity sweep a step. A step is three calls, between which the bodies move: `predict` to the
half step, `accelerate` there, `kick` and `finish` from there to the full step. Particles that see no halo are swept
while the messages to the neighbouring slabs travel.
"""

import math

import numpy as np

from parsim.fluid import kernels, surface
from parsim.fluid.weights import Lattice
from parsim.state import SURFACE
from parsim.timers import Timers

_LOWEST, _HIGHEST = 0.4, 0.9  # concentrations below which a particle is detached, above which never at the surface
_VICINITY = 2.1  # in spacings
_LONGEST_SHIFT = 0.1  # in spacings
_LARGEST_MACH = 0.2


class WCMPS:
    """The scheme for one case: constants, and the sweeps in their order."""

    STATE = ("x", "y", "z", "n", "rate")  # what the halos need of the full step

    def __init__(self, case, timers=None):
        water = case.water
        self.timers = timers or Timers()
        self.lattice = Lattice(case.dimensions, case.spacing, water.support)
        self.density, self.sound, self.gravity = water.density, case.sound_speed, case.gravity
        self.stiffness = self.sound**2 * water.density / 7.0
        self.viscosity = max(water.viscosity, water.damping_viscosity * self.sound * case.spacing)
        self.mass = water.density * self.lattice.volume
        self.cfl, self.diffusion, self.shifting = case.run.cfl, water.diffusion, water.shifting
        self.loosest = 0.5 / water.sound**2  # the stagnation pressure of the largest expected speed
        self.recovery = water.recovery * case.speed / case.depth if case.depth else 0.0
        self.restitution = water.restitution
        self._down = np.array(case.gravity) / (math.hypot(*case.gravity) or 1.0)
        self.close2 = (water.collision_distance * case.spacing) ** 2

    def time_step(self, speed):
        """Stable time step, s, at the largest speed, m/s (Mellado 2021, eq. 5.18)."""
        return self.cfl * self.lattice.spacing / (self.sound + speed)

    def number_at(self, pressure):
        """Number density (n,) at pressures (n,), Pa >= 0: the inverse state."""
        return self.lattice.number * kernels.seventh_roots(pressure / self.stiffness)

    def predict(self, p, dt):
        """Fluid to the half step, halo included: r, n, then the pressure."""
        kernels.predict(p.kind, p.surface, p.u, p.v, p.w, p.rate, 0.5 * dt, self.lattice.number, self.stiffness, p.x,
                        p.y, p.z, p.n, p.p, p.q)

    def accelerate(self, domain, near, dt):
        """Boundary pressures, then pair accelerations, concentration and surface of the fluid, at the half step."""
        p, lattice = domain.particles, self.lattice
        with self.timers("boundary"):
            kernels.boundary_pressure(near.boundary, near.start, near.middle, near.index, p.x, p.y, p.z, p.ax, p.ay,
                                      p.az, p.scale, *self.gravity, self.density, lattice.radius, lattice.number,
                                      self.stiffness, p.n, p.p, p.q)
        with domain.refreshing("n", "q"):
            self._momentum(p, near, near.inner, dt)
        self._momentum(p, near, near.border, dt)
        with self.timers("surface"):
            surface.classify(near.fluid, near.start, near.end, near.index, p.x, p.y, p.z, p.c, lattice.spacing, _LOWEST,
                             _HIGHEST, p.surface, p.nx, p.ny, p.nz)

    def _momentum(self, p, near, at, dt):
        with self.timers("momentum"):
            kernels.momentum(at, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n, p.q,
                             p.scale, self.lattice.radius, self.close2, self._push, self._drag, self._hit(dt),
                             self.lattice.number, p.ax, p.ay, p.az, p.c, p.nx, p.ny, p.nz)

    def react(self, domain, near, dt):
        """Forces of the water on the body samples `near.body`, N: (samples, 3)."""
        p, out = domain.particles, np.empty((near.body.size, 3))
        kernels.reaction(near.body, near.start, near.middle, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n, p.q,
                         p.scale, self.lattice.radius, self.close2, self._push, self._hit(dt), out)
        out *= self.mass
        return out

    def extremes(self, p, near, start):
        """Largest speed, m/s, of this rank's fluid (infinite when not finite) and largest distance from `start`, m."""
        return [math.sqrt(e) for e in kernels.extremes(near.fluid, p.u, p.v, p.w, p.x, p.y, p.z, start)]

    def kick(self, p, near, dt, keep):
        """Velocities to the full step; `keep` is the share of velocity kept (1 but when settling)."""
        kernels.kick(near.fluid, *self.gravity, keep, dt, p.ax, p.ay, p.az, p.u, p.v, p.w)

    def finish(self, domain, near, dt, speed):
        """Positions to the full step, continuity there, then shifting; `STATE` is left to be refreshed."""
        p, own = domain.particles, domain.own
        with domain.refreshing("u", "v", "w", "c", "nx", "ny", "nz", "surface"):
            self._drift(p, own, dt)
            self._continuity(p, near, near.inner, speed)
        for halo in (slice(0, own.start), slice(own.stop, len(p))):
            self._drift(p, halo, dt)
        self._continuity(p, near, near.border, speed)
        with self.timers("move"):
            kernels.grow(near.fluid, p.rate, 0.5 * dt, p.n)
        if self.shifting:
            with self.timers("shifting"):
                self._shift(domain, near, dt, speed)

    def _drift(self, p, at, dt):
        with self.timers("move"):
            kernels.drift(p.kind[at], p.u[at], p.v[at], p.w[at], 0.5 * dt, p.x[at], p.y[at], p.z[at])

    def _continuity(self, p, near, at, speed):
        slope = [g / self.sound**2 for g in self.gravity]
        spread = self.diffusion * self.sound**2 * self.time_step(speed) / self.cfl * self._laplacian
        with self.timers("continuity"):
            kernels.continuity(at, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n,
                               p.c, p.scale, self.lattice.radius, self.lattice.number, self._gradient, spread, *slope,
                               p.rate, p.ax, p.ay, p.az)

    def _shift(self, domain, near, dt, speed):
        p, lattice = domain.particles, self.lattice
        mach = min(speed / self.sound, _LARGEST_MACH)
        factor = 2.0 * lattice.spacing**2 * self.cfl * mach * self._gradient
        surface.shift(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.nx, p.ny, p.nz, p.c,
                      p.scale, p.body, domain.near(SURFACE, "surface"), lattice.radius,
                      (_VICINITY * lattice.spacing) ** 2, factor, _LONGEST_SHIFT * lattice.spacing, lattice.number,
                      lattice.cut, *self._down, self.recovery * dt, self.loosest, p.ax, p.ay, p.az, p.surface, p.n)
        kernels.displace(near.fluid, p.ax, p.ay, p.az, p.x, p.y, p.z)

    @property
    def _gradient(self):
        return self.lattice.dimensions / self.lattice.number

    @property
    def _laplacian(self):
        return 2.0 * self.lattice.dimensions / (self.lattice.spread * self.lattice.number)

    @property
    def _push(self):
        return self._gradient / self.density

    @property
    def _drag(self):
        return self.viscosity * 2.0 * self.lattice.dimensions * (self.lattice.dimensions + 2) / self.lattice.number

    def _hit(self, dt):
        return 0.5 * (1.0 + self.restitution) / dt
