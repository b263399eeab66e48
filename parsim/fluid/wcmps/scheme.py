"""Weakly compressible MPS (Mellado 2021, ch. 5; Jandaghian & Shakibaeinia 2020), explicit, symplectic in time.

One momentum and one continuity sweep a step. `_predict` goes to the half step; there `_press` finds the pressures of
the boundary, `_react` the load on the bodies, which get their accelerations, and `_accelerate` those of the water; kick
and `_finish` go from there to the full step, once the bodies have moved. Particles that see no halo are swept while the
messages to the neighbouring slabs travel.
"""

import math

import numpy as np

from parsim.fluid import friction, moves, recovery, shifting, surface, tait, turbulence, walls
from parsim.fluid.reference import Lattice
from parsim.fluid.wcmps import energy, sweeps, tables, updates
from parsim.fluid.wcmps.fields import ISOTROPY, NORMAL, TWICE_VISCOUS, VISCOUS, isotropy
from parsim.machine.timers import Timers
from parsim.particles.state import SURFACE, VELOCITY
from parsim.particles.tables import Vectors

_BESIDE = 2.1  # spacings from a wall within which the concentration is not that of the lattice
_CLOSE, _CROWD = 0.8, 100.0  # spacings below which shifting pushes harder, and by how much more for each spacing less
_LONGEST_SHIFT = 0.05  # in spacings
_LARGEST_MACH = 0.2
_THIN = 0.8  # times the recovery of deep water is that of thin water


class WCMPS:
    """The scheme for one case: constants, and the sweeps in their order."""

    STATE = ("x", "y", "z", "u", "v", "w", "n", "rate", *ISOTROPY)  # what the halos need of the full step

    def __init__(self, case, timers=None):
        water, choice = case.water, case.water.scheme
        self.timers = timers or Timers()
        self.lattice = lattice = Lattice(case.dimensions, case.spacing, choice.support, choice.weight)
        self.density, self.sound = water.density, case.sound_speed
        self.stiffness = self.sound**2 * water.density / 7.0
        self.viscosity, self.noise_damping = water.viscosity, choice.noise_damping
        self.mass = water.density * self.lattice.volume
        self.cfl, self.diffusion, self.shifting = case.run.cfl, choice.diffusion, choice.shifting
        stiffest = 2.0 * self._viscous * lattice.slopes / lattice.dimensions
        # 1/s: how fast viscosity and noise damping end what changes from particle to particle
        self._fading = stiffest * (self.viscosity + self.noise_damping * self.sound * lattice.spacing**3 * stiffest)
        self.loosest = 0.5 / choice.sound**2  # the stagnation pressure of the largest expected speed
        gravity = math.hypot(*case.gravity)
        # so much closer than the lattice does the model's water lie under half its depth: thus a fill keeps its level
        self._whole = lattice.whole / (1.0 + 0.5 * gravity * case.depth / self.sound**2)
        self.recovery = 2.0 * choice.recovery * math.sqrt(gravity / case.depth) if case.depth else 0.0
        self.restitution = choice.restitution
        self.eddies = turbulence.length_of(case) if water.eddies else None
        self._smooth = Lattice(case.dimensions, case.spacing, choice.support, friction.WEIGHT)
        no_slip = water.friction is not None and water.friction.kind == "no_slip"
        self._resolved = no_slip or water.eddies is not None  # viscosity is then no matter of the momentum sweep
        self._mixing = 2.0 * case.dimensions / self._smooth.number
        self._rub = self.viscosity * self._mixing if no_slip else 0.0
        self._leans = case.motion is not None
        self._lean(case.gravity)
        self.close2 = (choice.collision_distance * case.spacing) ** 2

    def _lean(self, gravity):
        """Note which way is down, and the slope of n over n0, 1/m, downward in water at rest, by gravity, m/s2."""
        size = math.hypot(*gravity)
        self._down = tuple(g / (size or 1.0) for g in gravity)
        self._steepness = size / self.sound**2

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

    def at_rest(self, pressure):
        """Fields of water at rest at pressures (n,), Pa >= 0: its number density, by the inverse state."""
        return {"n": self.lattice.number * tait.seventh_roots(pressure / self.stiffness)}

    def compression(self, p, at):
        """Density of the particles `at` over that of the water at no pressure, (n,)."""
        return p.n[at] / self.lattice.number

    def shares(self, p, at):
        """Mass of the particles `at` over `mass`: all have it, (n,)."""
        return np.ones(at.size)

    def elastic(self, p, at):
        """Elastic energy of the particles `at`, J, (n,)."""
        out = np.empty(at.size)
        energy.elastic(at, p.n, self.mass, self.lattice.number, self.sound**2, out)
        return out

    def step(self, flow, solids, time, dt):
        """One step: see the module. `STATE` is left to be refreshed."""
        p, near, domain = flow.particles, flow.near, flow.domain
        if self._leans:
            self._lean(flow.gravity)
        with self.timers("predict"):
            solids.place(flow, time, 0.5 * dt)
            self._predict(p, dt)
            solids.hold(flow, self.at_rest)
        self._press(p, near, flow)
        rubbing = solids.rub(flow)
        if (sliding := solids.sliding()) is not None:
            solids.slide(flow, self.rubbed(flow, solids, sliding), dt)
        with self.timers("bodies"):
            if solids.pushed():
                solids.push(flow, self._react(p, near, near.body, dt, rubbing), time, dt)
            if solids.driven(time + 0.5 * dt):
                solids.drive(flow, self._react(p, near, near.gate, dt, rubbing), time + 0.5 * dt, dt)
        self._accelerate(domain, near, dt)
        self._shear(domain, near, rubbing, solids.depths, dt)
        with self.timers("move"):
            if flow.turning:
                flow.turning.push(p, near.fluid, flow.gravity, dt)
            moves.kick(near.fluid, flow.gravity, flow.keep, dt, p.acceleration, p.velocity)
            solids.release(flow)
        solids.advance(flow, time, dt)
        self._finish(domain, near, dt, flow.speed)

    def _predict(self, p, dt):
        """Fluid to the half step, halo included: r, n, then the pressure."""
        state = 0.5 * dt, self.lattice.number, self.stiffness
        updates.predict(p.kind, p.surface, p.velocity, p.rate, state, p.place, p.n, p.p)

    def _press(self, p, near, flow):
        """Pressures of the boundary at the half step, for the accelerations that it has there."""
        with self.timers("boundary"):
            fall, at = (*flow.gravity, self.density), near.boundary
            own = flow.turning.less(p) if flow.turning else p.acceleration
            walls.boundary_pressure(at, near.lists, (p.body, p.surface), p.place, own, self.lattice.weight, fall, p.p)

    def _accelerate(self, domain, near, dt):
        """Pair accelerations, concentration and surface of the fluid at the half step."""
        p, lattice = domain.particles, self.lattice
        with domain.refreshing("p"):
            self._momentum(p, near, near.inner, dt)
        self._momentum(p, near, near.border, dt)
        with self.timers("surface"):
            bounds = surface.Bounds(lattice.spacing, lattice.lowest, lattice.highest)
            surface.classify(near.fluid, near.lists, p.place, p.c, bounds, p.surface, p.vectors(NORMAL))

    def _shear(self, domain, near, rubbing, depths, dt):
        """Add the stress of walls, of eddies and of resolved viscous layers to the acceleration of the fluid.

        Eddies take no more in a step than half of what changes from particle to particle.
        """
        p, smooth, given = domain.particles, self._smooth, (near.fluid, near.lists, domain.particles.kinematics)
        if self.eddies:
            length = self.eddies._replace(most=0.25 / (dt * self._mixing * smooth.slopes))
            with self.timers("eddies"):
                lattice = smooth.number, smooth.dimensions
                turbulence.eddy_viscosity(*given, smooth.weight, length, depths, lattice, p.eddy)
        if self._resolved:
            domain.refresh("eddy", "surface")
            with self.timers("eddies"):
                viscosities, viscous = (self.viscosity, p.eddy), (self._mixing, smooth.dimensions)
                turbulence.mix(*given, p.surface, smooth.weight, viscosities, viscous, p.acceleration)
        if rubbing:
            with self.timers("friction"):
                friction.drag_water(*given, smooth.weight, rubbing, self._rub, p.acceleration)

    def _momentum(self, p, near, at, dt):
        forces, around = self._forces(dt), tables.Around(p.c, p.vectors(NORMAL), p.vectors(VISCOUS))
        with self.timers("momentum"):
            given = at, near.lists, p.kinematics, _pressures(p), self.lattice.weight
            sweeps.momentum(*given, forces, p.acceleration, around)

    def _react(self, p, near, at, dt, rubbing):
        """Forces of the water on the samples `at`, N: (samples, 3), and how they depend on accelerations.

        Also `lever` (samples, 3), Pa s2/m, and `response` (samples, 6), kg: see `sweeps.reaction`.
        """
        forces, count = self._forces(dt), at.size
        out = tables.Reaction(np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 6)))
        sweeps.reaction(at, near.lists, p.kinematics, p.acceleration, _pressures(p), self.lattice.weight, forces, out)
        if rubbing:
            given = at, near.lists, p.kinematics, self._smooth.weight
            friction.drag_samples(*given, rubbing, self._rub, out.force)
        return self.mass * out.force, out.lever, self.mass * out.response

    def rubbed(self, flow, solids, at):
        """Force of friction, N, on the samples `at` as it was found last: (n, 3)."""
        out, p = np.zeros((at.size, 3)), flow.particles
        if rubbing := solids.rubbing(p):
            given = at, flow.near.lists, p.kinematics, self._smooth.weight
            friction.drag_samples(*given, rubbing, self._rub, out)
        return self.mass * out

    def extremes(self, p, near, start):
        """Largest speed, m/s, of this rank's fluid (infinite when not finite) and largest distance from `start`, m."""
        return [math.sqrt(e) for e in moves.extremes(near.fluid, p.velocity, p.place, start)]

    def _finish(self, domain, near, dt, speed):
        """Positions to the full step, continuity there, damping, shifting."""
        p, own = domain.particles, domain.own
        with domain.refreshing(*VELOCITY, *VISCOUS, *NORMAL, "surface"):
            self._drift(p, own, dt)
            self._continuity(p, near, near.inner, speed)
        for halo in (slice(0, own.start), slice(own.stop, len(p))):
            self._drift(p, halo, dt)
        self._continuity(p, near, near.border, speed)
        with self.timers("move"):
            updates.grow(near.fluid, p.rate, 0.5 * dt, p.n)
            share = self.noise_damping * self.sound * self.lattice.spacing**3 * self._viscous**2 * dt
            updates.damp(near.fluid, share, p.vectors(TWICE_VISCOUS), p.velocity)
        if self.shifting:
            with self.timers("shifting"):
                self._shift(domain, near, dt, speed)

    def _drift(self, p, at, dt):
        with self.timers("move"):
            place, velocity = (Vectors(*(component[at] for component in which)) for which in (p.place, p.velocity))
            moves.drift(p.kind[at], velocity, 0.5 * dt, place)

    def _continuity(self, p, near, at, speed):
        lattice = self.lattice
        spread = self.diffusion * self.sound**2 * self._passage(speed) * self._laplacian
        slope = tuple(component * self._steepness for component in self._down)
        growth = tables.Growth(
            lattice.number,
            self._gradient,
            spread,
            *slope,
            _CROWD / lattice.spacing,
            _CLOSE * lattice.spacing,
            float(lattice.dimensions),
        )
        out = tables.Change(p.rate, _shifts(p), p.vectors(TWICE_VISCOUS), isotropy(p))
        with self.timers("continuity"):
            density, viscous = tables.Density(p.n, p.scale, p.body), p.vectors(VISCOUS)
            sweeps.continuity(at, near.lists, p.kinematics, density, viscous, lattice.weight, growth, out)

    def _shift(self, domain, near, dt, speed):
        p, lattice = domain.particles, self.lattice
        mach = min(speed / self.sound, _LARGEST_MACH)
        factor = 2.0 * lattice.spacing**2 * dt / self._passage(speed) * mach * self._gradient
        at, lists, place, n0 = near.fluid, near.lists, p.place, lattice.number
        surface.clamp(at, lists, p.surface, n0, self.loosest, p.n)
        surface.mark(at, lists, place, lattice.weight, domain.near(SURFACE, "surface"), p.surface, p.vectors(NORMAL))
        squares, pull = (lattice.radius**2, (_BESIDE * lattice.spacing) ** 2), self.recovery * dt
        pulled = recovery.Recovery(*squares, n0, lattice.own, self._whole, lattice.cut, *self._down, pull, _THIN * pull)
        recovery.recover(at, lists, place, (p.scale, p.body), (p.c, p.surface), lattice.weight, pulled, p.n)
        shifted = shifting.Shifting(factor, _LONGEST_SHIFT * lattice.spacing, *self._down, n0 * self._steepness)
        shifting.shift(at, p.surface, p.vectors(NORMAL), shifted, _shifts(p), p.n)
        moves.displace(at, _shifts(p), place)

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

    def _forces(self, dt):
        return tables.Forces(
            self.lattice.own,
            self._whole,
            self.close2,
            self._push,
            0.0 if self._resolved else self.viscosity * self._viscous,
            0.5 * (1.0 + self.restitution) / dt,
            dt,
            self.density,
        )


def _pressures(p):
    return tables.Pressures(p.p, p.scale, isotropy(p), p.surface)


def _shifts(p):
    """Where shifts are collected: accelerations of water are made anew in the next step."""
    return p.acceleration
