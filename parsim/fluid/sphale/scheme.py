"""SPH-ALE: volumes that exchange mass and momentum through Riemann problems (Vila 1999; Robb et al. 2016), explicit.

Every stage of a step takes its fluxes at the state that the stage before has found, and goes on from the start of the
step: of the last, at the half step, is all that is kept, so that what one particle or body gets another has lost, and
the bodies are pushed once (Jameson, Schmidt & Turkel 1981). Two or three stages are of the second order.
"""

import math

import numpy as np

from parsim.fluid import moves, recovery, shifting, surface, tait, walls
from parsim.fluid.reference import Lattice
from parsim.fluid.sphale import loads, sweeps, tables, updates
from parsim.fluid.sphale.fields import ALL_SLOPES, FORCE, NORMAL, SHIFT, SLOPES
from parsim.geometry.faces import period
from parsim.machine.timers import Timers
from parsim.particles.state import SURFACE

_BESIDE = 2.1  # spacings from a wall within which the concentration is not that of the lattice
_THIN = 2.5  # times the recovery of deep water is that of thin water
_LONGEST_SHIFT = 0.1  # speed of it over the largest expected one: in jets of an impact it would throw particles out
_STAGES = {2: (0.5, 1.0), 3: (1.0 / 3.0, 0.5, 1.0)}  # how far from the start of the step each stage goes


class SPHALE:
    """The scheme for one case: constants, and the sweeps in their order."""

    STATE = ("x", "y", "z", "u", "v", "w", "omega", "m")  # what the halos need of the full step

    def __init__(self, case, timers=None):
        water, choice = case.water, case.water.scheme
        self.timers = timers or Timers()
        self.lattice = lattice = Lattice(case.dimensions, case.spacing, choice.support, choice.weight)
        self.density, self.sound = water.density, case.sound_speed
        self.stiffness = self.sound**2 * water.density / 7.0
        self.mass = water.density * lattice.volume
        self.cfl, self.shifting, self._stages = case.run.cfl, choice.shifting, _STAGES[choice.stages]
        self._drag = 2.0 * (lattice.dimensions + 2.0) * water.viscosity * water.density
        self._least, self._even = choice.dissipation, choice.evening
        self._longest = _LONGEST_SHIFT * self.sound / choice.sound
        self._over = lattice.dimensions / (lattice.number * lattice.volume)
        gravity = math.hypot(*case.gravity)
        self._down = tuple(g / (gravity or 1.0) for g in case.gravity)
        self._recovery = 2.0 * choice.recovery * math.sqrt(gravity / case.depth) if case.depth else 0.0
        self._endless = np.isfinite(period(case))

    def time_step(self, speed, acceleration=0.0):
        """Stable time step, s, at the largest speed, m/s, and acceleration, m/s2."""
        spacing = self.lattice.spacing
        limits = [self.cfl * spacing / (self.sound + speed)]
        if self._drag > 0.0:
            limits.append(self.density / (self._drag * self._over * self.lattice.slopes * self.lattice.volume))
        if acceleration > 0.0:
            limits.append(math.sqrt(2.0 * spacing / acceleration))
        return min(limits)

    def at_rest(self, pressure):
        """Fields of water at rest at pressures (n,), Pa >= 0: full volumes, mass by the inverse state."""
        omega = np.full(len(pressure), self.lattice.volume)
        return {"omega": omega, "m": self.density * omega * tait.seventh_roots(pressure / self.stiffness)}

    def compression(self, p, at):
        """Density of the particles `at` over that of the water at no pressure, (n,)."""
        return p.m[at] / (self.density * p.omega[at])

    def shares(self, p, at):
        """Mass of the particles `at` over `mass`, (n,)."""
        return p.m[at] / self.mass

    def elastic(self, p, at):
        """Elastic energy of the particles `at`, J, (n,)."""
        out = np.empty(at.size)
        updates.elastic(at, p.omega, p.m, (self.density, self.sound**2), out)
        return out

    def rubbed(self, flow, solids, at):
        """No friction, (n, 3)."""
        return np.zeros((at.size, 3))

    def extremes(self, p, near, start):
        """Largest speed, m/s, of this rank's water, infinite when not finite, and largest distance from `start`, m."""
        return [math.sqrt(e) for e in moves.extremes(near.fluid, p.velocity, p.place, start)]

    def step(self, flow, solids, time, dt):
        """One step: see the module. `STATE` is left to be refreshed."""
        p, near, domain = flow.particles, flow.near, flow.domain
        constants = self._constants(flow.gravity)
        with self.timers("bodies"):
            solids.normals(flow, p.vectors(NORMAL))
        self._prepare(domain, near, constants, dt)
        before = np.stack([getattr(p, name)[near.fluid] for name in self.STATE])
        reached = 0.0
        for share in self._stages:
            if reached > 0.0:
                domain.refresh(*self.STATE)
                with self.timers("bodies"):
                    solids.place(flow, time, reached * dt)
                self._reconstruct(domain, near, constants)
            if share == 1.0:
                self._push(flow, solids, constants, (time, dt))
            self._flux(p, near, constants)
            with self.timers("move"):
                step = (share * dt, *flow.gravity, flow.keep if share == 1.0 else 1.0)
                updates.advance(near.fluid, before, _rates(p), p.vectors(SHIFT), step, p.kinematics, (p.omega, p.m))
            reached = share
        solids.advance(flow, time, dt)

    def _prepare(self, domain, near, constants, dt):
        """At the start of a step: slopes, the surface, shift velocities, and volumes that have drifted."""
        p, lattice = domain.particles, self.lattice
        normal, frame = p.vectors(NORMAL), p.vectors(SHIFT)
        self._slope(p, near, constants, tables.Around(p.c, normal, frame))
        with self.timers("surface"):
            bounds = surface.Bounds(lattice.spacing, lattice.lowest, lattice.highest)
            surface.classify(near.fluid, near.lists, p.place, p.c, bounds, p.surface, normal)
        domain.refresh(*ALL_SLOPES, *NORMAL, "surface")
        with self.timers("shifting"):
            marks = domain.near(SURFACE, "surface")
            surface.mark(near.fluid, near.lists, p.place, lattice.weight, marks, p.surface, normal)
            whole = shifting.Shifting(1.0 if self.shifting else 0.0, self._longest, 0.0, 0.0, 0.0, 0.0)
            shifting.shift(near.fluid, p.surface, normal, whole, frame, p.c)
            if self._recovery > 0.0:
                self._recover(p, near, dt)
        domain.refresh(*SHIFT, "omega")
        self._press(p)

    def _recover(self, p, near, dt):
        """Let volumes go back to the room that the arrangement of the particles leaves them: see `recovery.recover`."""
        lattice, at = self.lattice, near.fluid
        squares = lattice.radius**2, (_BESIDE * lattice.spacing) ** 2
        pull = self._recovery * dt
        pulled = recovery.Recovery(
            *squares, 1.0, lattice.own, lattice.whole, lattice.cut, *self._down, pull, _THIN * pull
        )
        n = np.empty(len(p))
        n[at] = lattice.volume / p.omega[at]
        recovery.recover(at, near.lists, p.place, (p.scale, p.body), (p.c, p.surface), lattice.weight, pulled, n)
        p.omega[at] = lattice.volume / n[at]

    def _reconstruct(self, domain, near, constants):
        """Pressures and slopes at a later stage, halos with them; all else stays as it was at the start of the step."""
        p = domain.particles
        spare = [np.empty(len(p)) for _ in range(7)]
        around = tables.Around(spare[0], tables.Vectors(*spare[1:4]), tables.Vectors(*spare[4:]))
        self._slope(p, near, constants, around)
        domain.refresh(*ALL_SLOPES)

    def _slope(self, p, near, constants, around):
        self._press(p)
        with self.timers("slopes"):
            given = near.fluid, near.lists, _state(p), p.scale, self.lattice.weight, constants
            sweeps.slopes(*given, _slopes(p), around)

    def _press(self, p):
        with self.timers("move"):
            updates.press(p.kind, p.omega, p.m, (self.density, self.stiffness), p.p)

    def _push(self, flow, solids, constants, step):
        """Push the bodies, whose samples get their accelerations and pressures, by what the water will get of them."""
        p, near, (time, dt) = flow.particles, flow.near, step
        with self.timers("boundary"):
            fall = (*flow.gravity, self.density)
            given = near.boundary, near.lists, (p.body, p.surface), p.place, p.acceleration, self.lattice.weight
            walls.boundary_pressure(*given, fall, p.p)
        with self.timers("bodies"):
            if solids.pushed():
                solids.push(flow, self._react(p, near, near.body, constants), time, dt)
            if solids.driven(time + 0.5 * dt):
                solids.drive(flow, self._react(p, near, near.gate, constants), time + 0.5 * dt, dt)

    def _react(self, p, near, at, constants):
        """Forces of the water on the samples `at`, N: (samples, 3), and how they depend on accelerations.

        Also `lever` (samples, 3), Pa s2/m, and `response` (samples, 6), kg: see `loads.reaction`.
        """
        out = tables.Reaction(np.empty((at.size, 3)), np.empty((at.size, 3)), np.empty((at.size, 6)))
        loads.reaction(at, near.lists, _state(p), _slopes(p), _solid(p), self.lattice.weight, constants, out)
        return out

    def _flux(self, p, near, constants):
        with self.timers("fluxes"):
            given = _state(p), _slopes(p), _solid(p), self.lattice.weight, constants
            sweeps.fluxes(near.fluid, near.lists, *given, _rates(p))

    def _constants(self, gravity):
        lattice, density = self.lattice, self.density
        gravity = tuple(float(g) for g in gravity)
        # what goes round has no head along its way
        head = tuple(0.0 if endless else density * g for g, endless in zip(gravity, self._endless, strict=True))
        return tables.Constants(
            self._over,
            lattice.volume,
            density,
            density * self.sound**2,
            density * self.sound,
            self._drag,
            self._least,
            3.0 / self.sound,
            self._even * self.sound,
            *gravity,
            *head,
            0.5 * lattice.radius**2 / lattice.spacing,
            lattice.own,
            lattice.whole,
            float(lattice.dimensions == 2),
        )


def _state(p):
    return tables.State(p.place, p.velocity, p.vectors(SHIFT), p.p, p.omega)


def _slopes(p):
    return tables.Slopes(*(p.vectors(names) for names in SLOPES))


def _solid(p):
    return tables.Solid(p.scale, p.acceleration, p.vectors(NORMAL))


def _rates(p):
    return tables.Rates(p.growth, p.gain, p.vectors(FORCE))
