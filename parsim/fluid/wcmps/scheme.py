"""Weakly compressible MPS (Mellado 2021, ch. 5; Jandaghian & Shakibaeinia 2020), explicit, symplectic in time.

One momentum and one continuity sweep a step. `predict` goes to the half step; there `press` finds the pressures of the
boundary, `react` the load on the bodies, which get their accelerations, and `accelerate` those of the water; `kick` and
`finish` go from there to the full step, once the bodies have moved. Particles that see no halo are swept while the
messages to the neighbouring slabs travel.
"""

import math

import numpy as np

from parsim.fluid import surface
from parsim.fluid.reference import Lattice
from parsim.fluid.wcmps import sweeps, updates
from parsim.machine.timers import Timers
from parsim.particles.state import ISOTROPY, SURFACE

_BESIDE = 2.1  # spacings from a wall within which the concentration is not that of the lattice
_CLOSE, _CROWD = 0.8, 100.0  # spacings below which shifting pushes harder, and by how much more for each spacing less
_LONGEST_SHIFT = 0.05  # in spacings
_LARGEST_MACH = 0.2


class WCMPS:
    """The scheme for one case: constants, and the sweeps in their order."""

    STATE = ("x", "y", "z", "u", "v", "w", "n", "rate", *ISOTROPY)  # what the halos need of the full step

    def __init__(self, case, timers=None):
        water = case.water
        self.timers = timers or Timers()
        self.lattice = lattice = Lattice(case.dimensions, case.spacing, water.support, water.weight)
        self.density, self.sound, self.gravity = water.density, case.sound_speed, case.gravity
        self.stiffness = self.sound**2 * water.density / 7.0
        self.viscosity, self.noise_damping = water.viscosity, water.noise_damping
        self.mass = water.density * self.lattice.volume
        self.cfl, self.diffusion, self.shifting = case.run.cfl, water.diffusion, water.shifting
        stiffest = 2.0 * self._viscous * lattice.slopes / lattice.dimensions
        # 1/s: how fast viscosity and noise damping end what changes from particle to particle
        self._fading = stiffest * (self.viscosity + self.noise_damping * self.sound * lattice.spacing**3 * stiffest)
        self.loosest = 0.5 / water.sound**2  # the stagnation pressure of the largest expected speed
        gravity = math.hypot(*case.gravity)
        # so much closer than the lattice does the model's water lie under half its depth: thus a fill keeps its level
        self._whole = lattice.whole / (1.0 + 0.5 * gravity * case.depth / self.sound**2)
        self.recovery = 2.0 * water.recovery * math.sqrt(gravity / case.depth) if case.depth else 0.0
        self.restitution = water.restitution
        self._down, self._slope = np.array(case.gravity) / (gravity or 1.0), gravity / self.sound**2
        self.close2 = (water.collision_distance * case.spacing) ** 2

    def time_step(self, speed, acceleration=0.0):
        """Stable time step, s, at the largest speed, m/s (Mellado 2021, eq. 5.18), and acceleration, m/s2.

        Within it viscosity and noise damping together take no more than all of what changes from particle to particle,
        and nothing is accelerated over more than a spacing.
        """
        spacing = self.lattice.spacing
        limits = [self.cfl * self._passage(speed)]
        if self._fading > 0.0:
            limits.append(1.0 / self._fading)
        if acceleration > 0.0:
            limits.append(math.sqrt(2.0 * spacing / acceleration))
        return min(limits)

    def _passage(self, speed):
        """Time, s, in which sound at the largest speed, m/s, passes a spacing."""
        return self.lattice.spacing / (self.sound + speed)

    def number_at(self, pressure):
        """Number density (n,) at pressures (n,), Pa >= 0: the inverse state."""
        return self.lattice.number * sweeps.seventh_roots(pressure / self.stiffness)

    def predict(self, p, dt):
        """Fluid to the half step, halo included: r, n, then the pressure."""
        sweeps.predict(p.kind, p.surface, p.u, p.v, p.w, p.rate, 0.5 * dt, self.lattice.number, self.stiffness, p.x,
                        p.y, p.z, p.n, p.p)

    def press(self, p, near):
        """Pressures of the boundary at the half step, for the accelerations that it has there."""
        with self.timers("boundary"):
            sweeps.boundary_pressure(near.boundary, near.start, near.middle, near.index, p.body, p.x, p.y, p.z, p.ax,
                                      p.ay, p.az, *self.gravity, self.density, self.lattice.weight, p.p)

    def accelerate(self, domain, near, dt):
        """Pair accelerations, concentration and surface of the fluid at the half step."""
        p, lattice = domain.particles, self.lattice
        with domain.refreshing("p"):
            self._momentum(p, near, near.inner, dt)
        self._momentum(p, near, near.border, dt)
        with self.timers("surface"):
            surface.classify(near.fluid, near.start, near.end, near.index, p.x, p.y, p.z, p.c, lattice.spacing,
                             lattice.lowest, lattice.highest, p.surface, p.nx, p.ny, p.nz)

    def _momentum(self, p, near, at, dt):
        lattice = self.lattice
        with self.timers("momentum"):
            sweeps.momentum(at, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.p,
                             p.isotropy, p.scale, lattice.weight, lattice.own, self._whole, self.close2, self._push,
                             self.viscosity * self._viscous, self._hit(dt), dt, p.ax, p.ay, p.az, p.c, p.nx, p.ny, p.nz,
                             p.bx, p.by, p.bz)

    def react(self, domain, near, dt):
        """Forces of the water on the body samples `near.body`, N: (samples, 3), and how they depend on accelerations.

        Also `lever` (samples, 3), Pa s2/m, and `response` (samples, 6), kg: see `sweeps.reaction`.
        """
        p, count = domain.particles, near.body.size
        out, lever, response = np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 6))
        sweeps.reaction(near.body, near.start, near.middle, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.ax, p.ay, p.az,
                         p.p, p.isotropy, p.scale, self.lattice.weight, self.density, self.close2, self._push,
                         self._hit(dt), dt, out, lever, response)
        out *= self.mass
        response *= self.mass
        return out, lever, response

    def extremes(self, p, near, start):
        """Largest speed, m/s, of this rank's fluid (infinite when not finite) and largest distance from `start`, m."""
        return [math.sqrt(e) for e in updates.extremes(near.fluid, p.u, p.v, p.w, p.x, p.y, p.z, start)]

    def kick(self, p, near, dt, keep):
        """Velocities to the full step; `keep` is the share of velocity kept (1 but when settling)."""
        updates.kick(near.fluid, *self.gravity, keep, dt, p.ax, p.ay, p.az, p.u, p.v, p.w)

    def finish(self, domain, near, dt, speed):
        """Positions to the full step, continuity there, damping, shifting; `STATE` is left to be refreshed."""
        p, own = domain.particles, domain.own
        with domain.refreshing("u", "v", "w", "bx", "by", "bz", "nx", "ny", "nz", "surface"):
            self._drift(p, own, dt)
            self._continuity(p, near, near.inner, speed)
        for halo in (slice(0, own.start), slice(own.stop, len(p))):
            self._drift(p, halo, dt)
        self._continuity(p, near, near.border, speed)
        with self.timers("move"):
            updates.grow(near.fluid, p.rate, 0.5 * dt, p.n)
            share = self.noise_damping * self.sound * self.lattice.spacing**3 * self._viscous**2 * dt
            updates.damp(near.fluid, share, p.ex, p.ey, p.ez, p.u, p.v, p.w)
        if self.shifting:
            with self.timers("shifting"):
                self._shift(domain, near, dt, speed)

    def _drift(self, p, at, dt):
        with self.timers("move"):
            updates.drift(p.kind[at], p.u[at], p.v[at], p.w[at], 0.5 * dt, p.x[at], p.y[at], p.z[at])

    def _continuity(self, p, near, at, speed):
        lattice = self.lattice
        spread = self.diffusion * self.sound**2 * self._passage(speed) * self._laplacian
        with self.timers("continuity"):
            sweeps.continuity(at, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n,
                               p.bx, p.by, p.bz, p.scale, lattice.weight, lattice.number, self._gradient, spread,
                               *(self._down * self._slope), _CROWD / lattice.spacing, _CLOSE * lattice.spacing,
                               float(lattice.dimensions), p.body, p.rate, p.ax, p.ay, p.az, p.ex, p.ey, p.ez,
                               p.isotropy)

    def _shift(self, domain, near, dt, speed):
        p, lattice = domain.particles, self.lattice
        mach = min(speed / self.sound, _LARGEST_MACH)
        factor = 2.0 * lattice.spacing**2 * dt / self._passage(speed) * mach * self._gradient
        surface.shift(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.nx, p.ny, p.nz, p.c,
                      p.scale, p.body, domain.near(SURFACE, "surface"), lattice.weight, lattice.radius,
                      (_BESIDE * lattice.spacing) ** 2, factor, _LONGEST_SHIFT * lattice.spacing, lattice.number,
                      lattice.own, self._whole, lattice.cut, *self._down, self._slope, self.recovery * dt,
                      self.loosest, p.ax, p.ay, p.az, p.surface, p.n)
        updates.displace(near.fluid, p.ax, p.ay, p.az, p.x, p.y, p.z)

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
    def _viscous(self):
        return 2.0 * self.lattice.dimensions * (self.lattice.dimensions + 2) / self.lattice.number

    def _hit(self, dt):
        return 0.5 * (1.0 + self.restitution) / dt
