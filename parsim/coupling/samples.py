"""Water on bodies, bodies on water: the samples that a body shows to the water, and the loads they bring back."""

import functools
import math
from typing import NamedTuple

import numpy as np

from parsim.coupling.response import added_inertia, levers, respond
from parsim.errors import InputError
from parsim.geometry.rotation import matrices, to_body, to_global
from parsim.machine.jit import kernel
from parsim.particles.state import BODY, Particles, make_id
from parsim.particles.tables import Vectors
from parsim.solid.acceleration import Given, accelerate_bodies
from parsim.solid.shapes.kernels import distance

_WAY_OUT = 5.0  # spacings that the fastest water goes while a particle inside a body comes out


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
    integrated. `here`: numbers of those that lay in this slab when last asked for. `units` (8, 6) are those of the sums
    in `loads`, by their rows for one body: see `Domain.sum`. `of_body`: the `Samples` of each body.
    """

    def __init__(self, case, bodies, layers, units):
        self.bodies, self._gravity = bodies, np.array(case.gravity, float)
        self._way_out = _WAY_OUT * case.spacing / case.speed if case.speed else math.inf
        self._units = units
        sampled = functools.cache(lambda shape: shape.samples(case.spacing, case.spacing * layers, bodies.planar))
        self.of_body = [sampled(shape) for shape in bodies.shapes]
        self.offsets = np.concatenate([np.zeros((0, 3)), *(s.offsets for s in self.of_body)])
        self.scale = np.concatenate([np.zeros(0), *(s.shares for s in self.of_body)])
        self.body = np.repeat(np.arange(len(bodies), dtype=np.int32), [len(s.offsets) for s in self.of_body])

    def __len__(self):
        return len(self.offsets)

    def samples(self, slab, time):
        """Body samples of the slab that may see water; InputError for a body that comes to a periodic side."""
        self._keep_off(slab, time)
        b = self.bodies
        at, place = self._located(slab.reached(b.position[:, 0], b.radius) & ~b.gone)
        cells = slab.cells(*place)
        self.here = at[cells >= 0]
        awake = np.flatnonzero(slab.awake(cells))
        at, (x, y, z) = at[awake], (along[awake] for along in place)
        return Particles(
            at.size, id=make_id(BODY, at), kind=BODY, body=self.body[at], sample=at, x=x, y=y, z=z, scale=self.scale[at]
        )

    def _located(self, which):
        """Numbers (n,) of the samples of `which` bodies (bodies,) bool, and where they are now: three arrays (n,)."""
        at = np.flatnonzero(which[self.body])
        place = Vectors(*np.empty((3, at.size)))
        locate(self.offsets[at], self.body[at], self.bodies.position, matrices(self.bodies.quaternion), place)
        return at, place

    def _keep_off(self, slab, time):
        """Refuse a body that comes to a periodic side; the same on every rank."""
        at, place = self._located(slab.beside_period(*self.bodies.position.T, self.bodies.radius) & ~self.bodies.gone)
        beside = slab.beside_period(*place)
        if beside.any():
            name = self.bodies.names[self.body[at[beside.argmax()]]]
            raise InputError(
                f"bodies.{name}: reaches a periodic side at t = {time:.6g} s; water and bodies do not see "
                "each other across it: keep off, or use walls"
            )

    def place(self, p, position, quaternion):
        """Put the body samples among the particles `p`, halo included, where the given pose has them.

        Velocity and acceleration are those of the rigid motion; returns nothing.
        """
        motion = self._motion(position, quaternion)
        place_samples(p.kind, p.body, p.sample, self.offsets, motion, p.kinematics, p.acceleration)

    def _motion(self, position, quaternion):
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
        levers(at, p.body, p.place, centre, force, each)
        added_inertia(at, p.body, p.place, centre, response, added)
        body = p.body[at].astype(np.int64)
        rows = np.concatenate([body, rows, *(body + k * count for k in range(4, 8))])
        values = np.concatenate([each, others, *np.split(added, 4, axis=1)])
        units = np.repeat(self._units, count, axis=0)
        load, *rims, a, b, c, d = np.split(domain.sum(values, units, rows, 8 * count), 8)
        return load, rims, np.concatenate([a, b, c, d], axis=1)

    def answer(self, p, near, pose, load, added, lever, step):
        """Find the accelerations of the bodies, give the samples those and their pressures; loads (bodies, 6), N, N m.

        pose: position and quaternion; step: its beginning and length, s.

        The water's load is linear in a body's acceleration: `load` less `added` times its change. A load at the
        acceleration of the step before, which is the explicit way, grows without end where the water near a body
        outweighs it. Contacts count as they were in the step before.
        """
        b = self.bodies
        change = np.zeros((len(b), 6))
        (position, quaternion), others = pose, b.contact_load + b.spring_load
        given = Given(b.mass, b.inertia, quaternion, others, b.spin, *b.constraints(*step))
        accelerate_bodies(load, added, given, self._gravity, b.acceleration, b.angular_acceleration, change)
        respond(near.body, p.body, p.place, position, change, lever, p.p)
        self.place(p, position, quaternion)
        return load

    def find(self, domain, near):
        """Note, after a rebuild, which of this rank's water may meet a body."""
        self._beside = near.fluid[domain.near(BODY, "kind")[near.fluid]]

    def keep_out(self, p, near, position, quaternion):
        """Turn the velocity of water that is inside a body at the given pose, so that it comes out again.

        Water one layer thick has no pressure, so it can sink into what it lies on. The impulse is not given back: these
        are single particles.
        """
        motion = self._motion(position, quaternion)
        expel(self._beside, near.lists, p.body, motion, self.bodies.forms, self._way_out, p.kinematics)


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
def place_samples(kind, body, sample, offsets, motion, kinematics, out):
    """Position, velocity and acceleration `out` of every body sample from the rigid motion of its body."""
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
        x[i], y[i], z[i] = position[b, 0] + dx, position[b, 1] + dy, position[b, 2] + dz
        p, q, r = spin[b]
        du, dv, dw = q * dz - r * dy, r * dx - p * dz, p * dy - q * dx
        u[i], v[i], w[i] = velocity[b, 0] + du, velocity[b, 1] + dv, velocity[b, 2] + dw
        e, f, g = angular[b]
        ax[i] = acceleration[b, 0] + (f * dz - g * dy) + (q * dw - r * dv)
        ay[i] = acceleration[b, 1] + (g * dx - e * dz) + (r * du - p * dw)
        az[i] = acceleration[b, 2] + (e * dy - f * dx) + (p * dv - q * du)


@kernel
def expel(at, lists, body, motion, forms, way_out, kinematics):
    """Velocity of fluid inside a body: outward where the surface is nearest, at least its depth in `way_out` s."""
    _, middle, end, index = lists
    position, turn, velocity, spin, _, _ = motion
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    for i in at:
        last = -1
        for s in range(middle[i], end[i]):
            b = body[index[s]]
            if b < 0 or b == last:
                continue
            last = b
            dx, dy, dz = x[i] - position[b, 0], y[i] - position[b, 1], z[i] - position[b, 2]
            t = turn[b].ravel()
            high, n = distance(forms, b, to_body(t, dx, dy, dz))
            depth = -high
            if depth <= 0.0:
                continue
            nx, ny, nz = to_global(t, n[0], n[1], n[2])
            p, q, r = spin[b]
            away = (
                (u[i] - velocity[b, 0] - (q * dz - r * dy)) * nx
                + (v[i] - velocity[b, 1] - (r * dx - p * dz)) * ny
                + (w[i] - velocity[b, 2] - (p * dy - q * dx)) * nz
            )
            more = max(depth / way_out - away, 0.0)
            u[i] += more * nx
            v[i] += more * ny
            w[i] += more * nz
