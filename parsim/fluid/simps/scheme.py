"""Semi-implicit MPS (Amaro et al. 2021, sec. 4.1): pressures by one equation for all water and the bodies in it.

A step looks at the particles half way: viscosity, friction, gravity and collisions predict velocities, the pressure
equation finds what these lack to keep the volume of the water, with the accelerations that the same pressures give to
bodies, and the gradient of the pressures corrects them. Only the flow limits the time step.
"""

import math

import numpy as np

from parsim.coupling.sides import press
from parsim.fluid import friction, moves, surface, walls
from parsim.fluid.reference import Lattice
from parsim.fluid.simps import sweeps, tables
from parsim.fluid.simps.coarse import Coarse
from parsim.fluid.simps.fields import NORMAL, STEEP, VISCOUS
from parsim.fluid.simps.solver import Solver
from parsim.geometry.faces import period
from parsim.machine.timers import Timers
from parsim.particles.state import SURFACE, VELOCITY

_SLOWEST = 0.05  # of the largest expected speed: what the time step takes water at rest for


class SIMPS:
    """The scheme for one case: constants, and the sweeps in their order. solver: of the pressure equation."""

    STATE = ("x", "y", "z", "u", "v", "w", "p")

    def __init__(self, case, timers=None):
        water, choice = case.water, case.water.scheme
        self.timers, self._choice = timers or Timers(), choice
        self.lattice = lattice = Lattice(case.dimensions, case.spacing, choice.support, choice.weight)
        self.density, self.sound, self.viscosity = water.density, case.sound_speed, water.viscosity
        self.mass = water.density * lattice.volume
        coarse = Coarse(case, lattice) if choice.preconditioner == "lattice" else None
        self.solver = Solver(choice.tolerance, choice.iterations, coarse)
        self._give = 1.0 / (water.density * self.sound**2)  # 1/Pa: compressibility
        self._endless = np.isfinite(period(case))
        self._courant, self._slowest = case.run.cfl * choice.courant, _SLOWEST * case.speed
        self._laplacian = 2.0 * lattice.dimensions / (lattice.spread * lattice.number)
        self._kappa = _mirrored(lattice, 0), _mirrored(lattice, 1)
        self._fading = 2.0 * self.viscosity * self._laplacian * lattice.number  # 1/s
        self._rest = self.time_step(0.0, math.hypot(*case.gravity))
        self._smooth = Lattice(case.dimensions, case.spacing, choice.support, friction.WEIGHT)
        self._pairs = np.zeros(0)

    def time_step(self, speed, acceleration=0.0):
        """Stable time step, s, at the largest speed, m/s (eq. 32), and acceleration, m/s2."""
        spacing = self.lattice.spacing
        limits = [self._courant * spacing / max(speed, self._slowest)]
        if acceleration > 0.0:
            limits.append(self._courant * math.sqrt(2.0 * spacing / acceleration))
        if self._fading > 0.0:
            limits.append(1.0 / self._fading)
        return min(limits)

    def at_rest(self, pressure):
        """Fields of water at rest at pressures (n,), Pa: these."""
        return {"p": pressure}

    def compression(self, p, at):
        """Density of the particles `at` over that of the water at no pressure, (n,)."""
        return 1.0 + self._give * p.p[at]

    def shares(self, p, at):
        """Mass of the particles `at` over `mass`: all have it, (n,)."""
        return np.ones(at.size)

    def elastic(self, p, at):
        """Elastic energy of the particles `at`, J, (n,)."""
        return 0.5 * self._give * self.lattice.volume * p.p[at] ** 2

    def rubbed(self, flow, solids, at):
        """Force of friction, N, on the samples `at` as it was found last: (n, 3)."""
        out, p = np.zeros((at.size, 3)), flow.particles
        if rubbing := solids.rubbing(p):
            friction.drag_samples(at, flow.near.lists, p.kinematics, self._smooth.weight, rubbing, 0.0, out)
        return self.mass * out

    def extremes(self, p, near, start):
        """Largest speed, m/s, of this rank's fluid (infinite when not finite) and largest distance from `start`, m."""
        return [math.sqrt(e) for e in moves.extremes(near.fluid, p.velocity, p.place, start)]

    def step(self, flow, solids, time, dt):
        """One step: see the module. `STATE` is left to be refreshed."""
        p, near, domain = flow.particles, flow.near, flow.domain
        with self.timers("predict"):
            solids.place(flow, time, 0.5 * dt)
            moves.drift(p.kind, p.velocity, 0.5 * dt, p.place)
            sides = solids.sides(flow, self.lattice.weight, dt)
            self._predict(flow, solids, dt)
        with self.timers("bodies"):
            mobility = self._loosen(flow, solids, sides, time, dt)
        with self.timers("pressure"):
            equation, factor = self._assemble(flow, mobility, sides, dt)
            forces = self.solver.solve(flow, equation, mobility, factor, time)
            domain.refresh("p")
        with self.timers("bodies"):
            if mobility:
                solids.give_way(flow, mobility.accelerations(forces), dt)
            fall = (*(h / self.density for h in self._rise(flow)), self.density)
            given = near.boundary, near.lists, (p.body, p.surface), p.place, p.acceleration, self.lattice.weight
            walls.boundary_pressure(*given, fall, p.p)
            if solids.pushed():
                solids.push(flow, self._press(flow, solids, sides, 1.0), time, dt)
            if solids.driven(time + 0.5 * dt):
                solids.drive(flow, self._react(flow, solids), time + 0.5 * dt, dt)
        with self.timers("move"):
            self._correct(flow, dt)
        solids.advance(flow, time, dt)
        with self.timers("move"):
            moves.drift(p.kind, p.velocity, 0.5 * dt, p.place)

    def _rise(self, flow):
        """Rise of the pressure of water at rest, (3,), Pa/m; nothing rises along an axis that repeats."""
        return tuple(0.0 if off else self.density * g for off, g in zip(self._endless, flow.gravity, strict=True))

    def _predict(self, flow, solids, dt):
        """Velocities without the pressure, and which particles are at the surface."""
        p, near, domain, lattice, choice = flow.particles, flow.near, flow.domain, self.lattice, self._choice
        close2 = (choice.collision_distance * lattice.spacing) ** 2
        drag = self.viscosity * self._laplacian
        given = tables.Prediction(lattice.own, lattice.whole, drag, close2, 1.0 + choice.restitution, dt)
        around = tables.Around(p.c, p.n, p.vectors(NORMAL), p.vectors(VISCOUS))
        at, lists = near.fluid, near.lists
        sweeps.predict(at, lists, p.kinematics, p.scale, lattice.weight, given, p.acceleration, around)
        if rubbing := solids.rub(flow):
            friction.drag_water(at, lists, p.kinematics, self._smooth.weight, rubbing, 0.0, p.acceleration)
        moves.kick(at, flow.gravity, 1.0, dt, p.acceleration, p.velocity)
        bounds = surface.Bounds(lattice.spacing, lattice.lowest, lattice.highest)
        surface.classify(at, lists, p.place, p.c, bounds, p.surface, p.vectors(NORMAL))
        domain.refresh(*VELOCITY, *NORMAL, *VISCOUS, "surface", "n")
        surface.mark(at, lists, p.place, lattice.weight, domain.near(SURFACE, "surface"), p.surface, p.vectors(NORMAL))

    def _loosen(self, flow, solids, sides, time, dt):
        """How the bodies give way, a `Mobility`, or None; their samples then have what they do without pressures."""
        if not solids.pushed():
            return None
        faces = sides, self.lattice.weight, flow.particles.n
        return solids.loosen(flow, self._press(flow, solids, sides, 0.0), faces, time, dt)

    def _assemble(self, flow, mobility, sides, dt):
        """The pressure equation, a `tables.Equation`, and what the bodies' part of it is times."""
        p, near, choice, lattice = flow.particles, flow.near, self._choice, self.lattice
        if self._pairs.size != near.index.size:
            self._pairs = np.empty(near.index.size)
        equation = tables.Equation(self._pairs, *np.zeros((3, len(p))))
        stiff = self.density / (dt * dt * self._laplacian)
        balance = tables.Balance(
            0.5 * lattice.spread,
            self.density / dt,
            stiff * self._give,
            stiff * choice.relaxation * dt / self._rest,
            lattice.number,
            *self._kappa,
            dt,
            choice.divergence,
            *self._rise(flow),
        )
        state = p.p, p.c, p.n, p.surface, p.scale
        swept = 1.0 / (self._laplacian * lattice.volume)
        motion, bodies = (p.kinematics, p.acceleration, p.vectors(STEEP)), (p.body, sides, swept)
        sweeps.assemble(near.fluid, near.lists, motion, state, lattice.weight, bodies, balance, equation)
        return equation, self.density * swept

    def _press(self, flow, solids, sides, share):
        """Forces of the water on the samples of bodies, N, a `tables.Reaction`; `share` of its pressures."""
        p, at = flow.particles, flow.near.body
        out, water = _reaction(at.size), (self.lattice.weight, p.p, p.n, share, self.density, self._rise(flow))
        press(at, flow.near.lists, p.place, p.acceleration, water, sides, out)
        return out._replace(force=out.force + self.rubbed(flow, solids, at))

    def _react(self, flow, solids):
        """Forces of the water on the samples of the gate, N, a `tables.Reaction`."""
        p, at, lattice = flow.particles, flow.near.gate, self.lattice
        out, unit = _reaction(at.size), 0.5 * self._laplacian * lattice.volume
        forces = (unit, self.density, *self._rise(flow))
        sweeps.reaction(at, flow.near.lists, p.place, p.acceleration, (p.p, p.scale), lattice.weight, forces, out.force)
        return out._replace(force=out.force + self.rubbed(flow, solids, at))

    def _correct(self, flow, dt):
        """Velocities by the gradient of the pressure, whose negative part does nothing: water does not pull."""
        p, near, lattice = flow.particles, flow.near, self.lattice
        even, planar = lattice.number / lattice.dimensions, float(lattice.dimensions == 2)
        calm = self._choice.noise_damping / (dt * lattice.number**2)
        slope = tables.Slope(self._choice.least_pressure, self.density, even, planar, calm, *self._rise(flow))
        acceleration, fields = p.acceleration, (np.maximum(p.p, 0.0), p.scale, *p.vectors(VISCOUS))
        sweeps.gradient(
            near.fluid,
            near.lists,
            p.place,
            acceleration,
            fields,
            lattice.weight,
            slope,
            (acceleration, p.vectors(STEEP)),
        )
        moves.kick(near.fluid, (0.0, 0.0, 0.0), flow.keep, dt, acceleration, p.velocity)


def _reaction(count):
    return tables.Reaction(np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 6)))


def _mirrored(lattice, rows):
    """What the missing weight of a particle with so many rows above it is times: pressure zero on a flat surface.

    The pressures above it are those below, mirrored; half a spacing above the first row they are zero.
    """
    missing = [(w, up) for w, _, _, up in lattice.points() if up > (rows + 0.5) * lattice.spacing]
    weight, moment = math.fsum(w for w, _ in missing), math.fsum(w * up for w, up in missing)
    return moment / (weight * (rows + 0.5) * lattice.spacing) if weight > 0.0 else 0.0
