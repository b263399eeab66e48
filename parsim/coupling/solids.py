"""All that is solid, as a scheme of the water sees it: placed, pushed, advanced."""

import functools

import numpy as np

from parsim.boundary.gate import Gate, GateSamples
from parsim.boundary.wall_samples import Walls
from parsim.case.scales import power_of_two, scales
from parsim.coupling.buried import buried
from parsim.coupling.depths import Columns
from parsim.coupling.films import Films
from parsim.coupling.friction import Friction, Rubbing
from parsim.coupling.normals import Normals
from parsim.coupling.openings import Openings
from parsim.coupling.pull import Pull
from parsim.coupling.samples import BodySamples
from parsim.coupling.sides import Faces, wet
from parsim.coupling.stray import Stray
from parsim.fluid.friction import slip_of
from parsim.solid.bodies import from_case
from parsim.solid.contacts import Contacts


class Solids:
    """Walls, gate and bodies of a case with the samples that they show to the water, as attributes.

    bodies, contacts; pull, on all that is free; openings; gate, or None; samples, of the bodies; films; walls.
    `sources`: all that has samples. shares: see `Contacts`.
    """

    def __init__(self, case, layers, lattice, timers, shares=None):
        self.timers, self._scales = timers, scales(case)
        self.bodies = from_case(case)
        self.samples = BodySamples(case, self.bodies, layers, _units(case, self._scales, self.bodies))
        self.samples.seen = ~buried(self.bodies, self.samples)
        self.films = Films(case, self.bodies, self.samples, lattice)
        self.stray = Stray(case, self.samples)
        self._lattice = lattice
        self.walls = Walls(case, layers)
        self.gate = Gate(case) if case.gate is not None else None
        self.pull = Pull(case)
        self.contacts = Contacts(self.bodies, case, [self.gate] if self.gate else [], self.pull.at, shares)
        self.friction = None
        if case.water.friction is not None:
            self.friction = Friction(case, self.bodies, self.samples, self.gate)
        self._columns = Columns(case, self.bodies) if case.water.eddies is not None else None
        self.openings = Openings(case, layers, self.bodies)
        self._gate_samples = GateSamples(case, self.gate, layers) if self.gate else None
        self._normals = Normals(case, self.bodies, self.samples)
        self._wet = case.water.scheme.WET
        self._load, self._felt = np.zeros((2, len(self.bodies), 6))  # of the water, and of a box that turns

    @property
    def sources(self):
        """What gives the domain samples at a rebuild: nothing where there is no water to see them."""
        if not self._wet:
            return []
        return [
            source
            for source in (self.samples, self._gate_samples, self.openings.inlet, self.walls)
            if source is not None
        ]

    @property
    def depths(self):
        """`Depths` of the water where eddies ask for them, else None."""
        return self._columns.depths if self._columns else None

    @property
    def parts(self):
        """What a restart needs, by name: objects with `kept` and `restore`."""
        parts = {"bodies": self.bodies, "contacts": self.contacts}
        parts |= {"pull": self.pull} if self.pull else {}
        return parts | ({"openings": self.openings} if self.openings else {})

    def find(self, flow):
        """Note, after a rebuild, which of this rank's particles are near bodies."""
        self.samples.note_shifts(flow.particles)
        self.openings.find(flow.particles, flow.domain.own)
        if self.pushed():
            self.stray.find(flow.domain, flow.near)
            self.films.find(flow.domain)
        if self.friction:
            self.friction.find(flow.particles, flow.near)
        if self._columns:
            self._columns.find(flow)

    def place(self, flow, time, ahead):
        """Bring the samples of gate and bodies to where these are `ahead` s after `time`."""
        self._place(flow.particles, *self.bodies.drifted(ahead), time + ahead)
        self.openings.place(flow.particles, ahead)

    @functools.cached_property
    def _faces(self):
        return Faces(self.samples, self._lattice)

    def normals(self, flow, out):
        """Write to `out`, Vectors of the particles, the unit normals of all samples into the water."""
        self._normals.place(flow.particles, out)

    def hold(self, flow, at_rest):
        """Give the water that goes out the pressure that is there; `at_rest`: see `Scheme`."""
        if self.openings.outlet:
            self.openings.outlet.hold(flow.particles, at_rest)

    def release(self, flow):
        """Give it the velocity that it goes on with."""
        if self.openings.outlet:
            self.openings.outlet.release(flow.particles)

    def rub(self, flow):
        """What walls and bodies make the water feel of their friction, a `friction.Rubbing`; None if nothing."""
        if not self.friction:
            return None
        with self.timers("friction"):
            self.friction.find_slip(flow)
        return self.rubbing(flow.particles)

    def rubbing(self, p):
        """The same as it was found last."""
        return Rubbing(slip_of(p), self.friction.share) if self.friction else None

    def sliding(self):
        """Samples of this rank, of sides that move; none if nothing does."""
        return self.friction.sliding if self.friction and self.friction.slides else None

    def slide(self, flow, force, dt):
        """Account for the work that sides do on the water, whose friction on `sliding` is `force`, N, in `dt`, s."""
        power = self.friction.power(force)[:, None]
        self.contacts.driven_work += dt * float(flow.domain.sum(power, self._scales.energy / self._scales.time)[0])

    def pushed(self):
        """Whether there is water, and bodies for it to push."""
        return self._wet and len(self.bodies) > 0

    def push(self, flow, reaction, time, dt):
        """Give the bodies, and their samples, the accelerations that the water's load gives them; see `Scheme`."""
        pose, load, rims, inertia = self._found(flow, reaction, time, dt)
        self.films.keep(*rims)
        step = (time, dt)
        self._load = self.samples.answer(
            flow.particles, flow.near, pose, load, inertia, reaction[1], step, flow.gravity
        )

    def sides(self, flow, weight, dt):
        """The `Sides` of the bodies at the middle of the step, whose wetness is noted in the field `n` of samples."""
        p, near = flow.particles, flow.near
        sides = self._faces.at(p, self.bodies.drifted(0.5 * dt)[1])
        wet(near.body, near.lists, p.place, weight, sides.area, p.n)
        return sides

    def loosen(self, flow, reaction, faces, time, dt):
        """Give the bodies the accelerations that they have without the water's pressures; what these add: `Mobility`.

        `reaction` is as in `push`, without them; `faces`: see `Mobility`. None where nothing gives way.
        """
        pose, load, _, inertia = self._found(flow, reaction, time, dt)
        step = (time, dt)
        self.samples.answer(flow.particles, flow.near, pose, load, inertia, reaction[1], step, flow.gravity)
        return self.samples.mobility(flow.domain, flow.near, self.stray.beside, pose, inertia, faces, step) or None

    def give_way(self, flow, change, dt):
        """Change the accelerations of the bodies, and of their samples, by `change` (bodies, 6), m/s2 and 1/s2."""
        self.bodies.acceleration += change[:, :3]
        self.bodies.angular_acceleration += change[:, 3:]
        self.samples.place(flow.particles, *self.bodies.drifted(0.5 * dt))

    def _found(self, flow, reaction, time, dt):
        """Pose at the middle of the step, loads, films, inertia that the water adds: see `BodySamples.loads`."""
        domain, near, pose = flow.domain, flow.near, self.bodies.drifted(0.5 * dt)
        force, _, response = reaction
        added = self.films.loads(domain, near, self._plate(time + 0.5 * dt), *pose, flow.gravity)
        load, rims, inertia = self.samples.loads(domain, near, force, response, pose[0], *added)
        load += self._turn(flow, dt)
        return pose, load, rims, inertia

    def _plate(self, time):
        return self.gate.outline(time) if self.gate else np.zeros(4)

    def driven(self, time):
        """Whether the gate moves at `time`, s."""
        return self.gate is not None and self.gate.velocity(time) != 0.0

    def drive(self, flow, reaction, time, dt):
        """Account for the work that the gate does on the water, whose `reaction` on `near.gate` it is, in `dt`, s."""
        (force,) = flow.domain.sum(reaction[0][:, 2:], self._scales.force)
        self.contacts.driven_work -= float(force) * self.gate.velocity(time) * dt

    def advance(self, flow, time, dt):
        """Move the bodies over `dt`, s, under what has pushed them, and place the samples there."""
        if len(self.bodies):
            if self._wet:
                pose = self.bodies.drifted(0.5 * dt)
                with self.timers("move"):
                    self.stray.turn_out(flow, pose, self.films.around(self._plate(time + 0.5 * dt), *pose), dt)
            with self.timers("contacts"):
                self.contacts.step(self.bodies, self._load if self._wet else self._turn(flow, dt), time, dt)
                if flow.turning:
                    self.bodies.water_load -= self._felt
                    self.bodies.gravity_load += self._felt
                self.bodies.velocity *= flow.keep
                self.bodies.spin *= flow.keep
        with self.timers("bodies"):
            self._place(flow.particles, self.bodies.position, self.bodies.quaternion, time + dt)
            self.openings.advance(flow.particles, dt)

    def lead_out(self, p, dt):
        """Move water that is shut in beside bodies along its gap: see `Stray`. Last in a step of dt, s."""
        if self.pushed():
            self.stray.lead_out(p, dt)

    def _turn(self, flow, dt):
        """Find what bodies feel of a box that turns besides gravity, (bodies, 6), N and N m, in a step of dt, s."""
        if flow.turning:
            self._felt = flow.turning.load(self.bodies, 0.5 * dt)
        return self._felt

    def _place(self, p, position, quaternion, time):
        if self.gate:
            self._gate_samples.place(p, time)
        if len(self.bodies):
            self.samples.place(p, position, quaternion)


def _units(case, scale, bodies):
    """Units (8, 6) of the sums in `BodySamples.loads`, by their rows for one body: see `Domain.sum`."""
    units, radius = np.ones((8, 6)), float(bodies.radius.max(initial=case.spacing))
    arms = np.repeat([1.0, power_of_two(radius)], 3)
    mass = power_of_two(case.water.density * radius**case.dimensions)
    units[0], units[3, 0] = scale.force * arms, scale.pressure(case.dimensions)
    units[4:].flat[:21] = (mass * arms[:, None] * arms)[np.triu_indices(6)]
    return units
