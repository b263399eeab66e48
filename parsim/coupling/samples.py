"""Water on bodies, bodies on water: the samples that a body shows to the water, and the loads they bring back."""

import functools
from typing import NamedTuple

import numpy as np

from parsim.coupling.mobility import Mobility
from parsim.coupling.response import added_inertia, arms_of, levers, respond
from parsim.geometry.faces import period
from parsim.geometry.rotation import matrices
from parsim.machine.jit import kernel
from parsim.particles.state import BODY, Particles, make_id
from parsim.particles.tables import Vectors
from parsim.solid.acceleration import Given, accelerate_bodies, mobilities


class Motion(NamedTuple):
    """Of all bodies: position, velocity, spin, acceleration, angular acceleration (b, 3), turn (b, 3, 3)."""

    position: np.ndarray
    turn: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    acceleration: np.ndarray
    angular: np.ndarray


class BodySamples:
    """Even samplings of all bodies at about the spacing, down to a support below their surface.

    Each sample carries its share of the volume of its body (`shapes.shape.Samples`), and is placed from the pose, never
    integrated. `here`: numbers of those that lay in this slab when last asked for; `seen` (n,): whether water may see
    one. `units` (8, 6) are those of the sums in `loads`, by their rows for one body: see `Domain.sum`. `of_body`: the
    `Samples` of each body. Bodies cross periodic sides: their places go on beyond, and `shift` (particles, 3), m, leads
    from there to where a sample is.
    """

    def __init__(self, case, bodies, layers, units):
        self.bodies = bodies
        self._units, self._low, self._period = units, np.array(case.box.min), period(case)
        sampled = functools.cache(lambda shape: shape.samples(case.spacing, case.spacing * layers, bodies.planar))
        self.of_body = [sampled(shape) for shape in bodies.shapes]
        self.offsets = np.concatenate([np.zeros((0, 3)), *(s.offsets for s in self.of_body)])
        self.scale = np.concatenate([np.zeros(0), *(s.shares for s in self.of_body)])
        self.body = np.repeat(np.arange(len(bodies), dtype=np.int32), [len(s.offsets) for s in self.of_body])
        self.seen = np.ones(len(self), bool)

    def __len__(self):
        return len(self.offsets)

    def samples(self, slab, time):
        """Body samples of the slab that may see water."""
        b = self.bodies
        reached = slab.reached(b.position[:, 0], b.radius) if np.isinf(self._period[0]) else np.ones(len(b), bool)
        at, place = self._located(reached & ~b.gone)
        place = Vectors(*(x + shift for x, shift in zip(place, self.home(*place).T, strict=True)))
        cells = slab.cells(*place)
        self.here = at[cells >= 0]
        awake = np.flatnonzero(slab.awake(cells))
        at, (x, y, z) = at[awake], (along[awake] for along in place)
        return Particles(
            at.size, id=make_id(BODY, at), kind=BODY, body=self.body[at], sample=at, x=x, y=y, z=z, scale=self.scale[at]
        )

    def home(self, x, y, z):
        """Shifts (n, 3), m, by whole periods that bring places into the box."""
        out, places = np.zeros((len(x), 3)), (x, y, z)
        for axis in np.flatnonzero(np.isfinite(self._period)):
            out[:, axis] = -self._period[axis] * np.floor((places[axis] - self._low[axis]) / self._period[axis])
        return out

    def _located(self, which):
        """Numbers (n,) of the samples that may be seen of `which` bodies (bodies,) bool, and their places (3, n)."""
        at = np.flatnonzero(which[self.body] & self.seen)
        place = Vectors(*np.empty((3, at.size)))
        locate(self.offsets[at], self.body[at], self.bodies.position, matrices(self.bodies.quaternion), place)
        return at, place

    def note_shifts(self, p):
        """Note, after a rebuild, from which periodic image of its body each sample among the particles `p` is."""
        self.shift = np.zeros((len(p), 3))
        at = np.flatnonzero(p.kind == BODY)
        place = Vectors(*np.empty((3, at.size)))
        locate(self.offsets[p.sample[at]], p.body[at], self.bodies.position, matrices(self.bodies.quaternion), place)
        for axis in np.flatnonzero(np.isfinite(self._period)):
            apart = (p.x, p.y, p.z)[axis][at] - place[axis]
            self.shift[at, axis] = self._period[axis] * np.rint(apart / self._period[axis])

    def place(self, p, position, quaternion):
        """Put the body samples among the particles `p`, halo included, where the given pose has them.

        Velocity and acceleration are those of the rigid motion; returns nothing.
        """
        motion = self.motion(position, quaternion)
        place_samples(p.kind, (p.body, p.sample), self.offsets, self.shift, motion, p.kinematics, p.acceleration)

    def motion(self, position, quaternion):
        """`Motion` of the bodies at a pose."""
        b = self.bodies
        return Motion(position, matrices(quaternion), b.velocity, b.spin, b.acceleration, b.angular_acceleration)

    def loads(self, domain, near, force, response, centre, others, rows):
        """Sums over all ranks about `centre` (bodies, 3): loads, N and N m, films (3 arrays), added inertia.

        `force` (samples, 3), `response` (samples, 6): see `WCMPS._react`; `others` (n, 6) at `rows` (n,): see
        `Films.loads`. Loads and films are (bodies, 6); the inertia that the water adds is (bodies, 24): the upper
        triangle of a symmetric matrix of six by rows, kg, kg m and kg m2, then zeros.
        """
        p, at, count = domain.particles, near.body, len(centre)
        each, added = np.empty((at.size, 6)), np.empty((at.size, 24))
        arms = self.arms(p, at, centre)
        levers(arms, force, each)
        added_inertia(arms, response, added)
        body = p.body[at].astype(np.int64)
        rows = np.concatenate([body, rows, *(body + k * count for k in range(4, 8))])
        values = np.concatenate([each, others, *np.split(added, 4, axis=1)])
        units = np.repeat(self._units, count, axis=0)
        load, *rims, a, b, c, d = np.split(domain.sum(values, units, rows, 8 * count), 8)
        return load, rims, np.concatenate([a, b, c, d], axis=1)

    def arms(self, p, at, centre):
        """Where the samples `at` are from the centres (bodies, 3) of their bodies: (n, 3), m."""
        out = np.empty((at.size, 3))
        arms_of(at, p.body, p.place, self.shift, centre, out)
        return out

    def answer(self, p, near, pose, load, added, lever, step, gravity):
        """Find the accelerations of the bodies, give the samples those and their pressures; loads (bodies, 6), N, N m.

        pose: position and quaternion; step: its beginning and length, s; gravity (3,), m/s2.

        The water's load is linear in a body's acceleration: `load` less `added` times its change. A load at the
        acceleration of the step before, which is the explicit way, grows without end where the water near a body
        outweighs it. Contacts count as they were in the step before.
        """
        b, change = self.bodies, np.zeros((len(self.bodies), 6))
        given = self._given(pose, step)
        accelerate_bodies(load, added, given, np.array(gravity), b.acceleration, b.angular_acceleration, change)
        respond(near.body, p.body, self.arms(p, near.body, pose[0]), change, lever, p.p)
        self.place(p, *pose)
        return load

    def mobility(self, domain, near, beside, pose, added, faces, step):
        """How the bodies answer to pressures of the water: a `Mobility`. The rest: see `answer`, `Solids.loosen`."""
        inverse = np.empty((len(self.bodies), 6, 6))
        mobilities(added, self._given(pose, step), inverse)
        return Mobility(domain, near, beside, self, pose[0], inverse, faces, self._units[0])

    def _given(self, pose, step):
        b = self.bodies
        return Given(b.mass, b.inertia, pose[1], b.contact_load + b.spring_load, b.spin, *b.constraints(*step))


@kernel
def locate(offsets, body, position, turn, place):
    """Global positions of samples: centre plus turned offset."""
    x, y, z = place
    for s in range(body.size):
        b = body[s]
        o = offsets[s]
        x[s] = position[b, 0] + (turn[b, 0, 0] * o[0] + turn[b, 0, 1] * o[1] + turn[b, 0, 2] * o[2])
        y[s] = position[b, 1] + (turn[b, 1, 0] * o[0] + turn[b, 1, 1] * o[1] + turn[b, 1, 2] * o[2])
        z[s] = position[b, 2] + (turn[b, 2, 0] * o[0] + turn[b, 2, 1] * o[1] + turn[b, 2, 2] * o[2])


@kernel
def place_samples(kind, which, offsets, shift, motion, kinematics, out):
    """Position, velocity and acceleration `out` of every body sample from the rigid motion of its body.

    `which`: body and sample of each particle; `shift`: see `BodySamples`.
    """
    body, sample = which
    position, turn, velocity, spin, acceleration, angular = motion
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    ax, ay, az = out
    for i in range(kind.size):
        if kind[i] != BODY:
            continue
        b = body[i]
        o = offsets[sample[i]]
        dx = turn[b, 0, 0] * o[0] + turn[b, 0, 1] * o[1] + turn[b, 0, 2] * o[2]
        dy = turn[b, 1, 0] * o[0] + turn[b, 1, 1] * o[1] + turn[b, 1, 2] * o[2]
        dz = turn[b, 2, 0] * o[0] + turn[b, 2, 1] * o[1] + turn[b, 2, 2] * o[2]
        x[i] = position[b, 0] + dx + shift[i, 0]
        y[i] = position[b, 1] + dy + shift[i, 1]
        z[i] = position[b, 2] + dz + shift[i, 2]
        p, q, r = spin[b]
        du, dv, dw = q * dz - r * dy, r * dx - p * dz, p * dy - q * dx
        u[i], v[i], w[i] = velocity[b, 0] + du, velocity[b, 1] + dv, velocity[b, 2] + dw
        e, f, g = angular[b]
        ax[i] = acceleration[b, 0] + (f * dz - g * dy) + (q * dw - r * dv)
        ay[i] = acceleration[b, 1] + (g * dx - e * dz) + (r * du - p * dw)
        az[i] = acceleration[b, 2] + (e * dy - f * dx) + (p * dv - q * du)
