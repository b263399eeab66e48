"""Rigid bodies: what they are, where they are and how they move. Every rank holds all of them and moves them alike."""

import math

import numpy as np

from parsim.geometry.rotation import from_angles, matrices, turned
from parsim.solid.kinetics import drift, kinetic, largest_speed, reaches
from parsim.solid.shapes.forms import forms_of
from parsim.solid.ties import joints_of

_KEPT = (
    "position",
    "quaternion",
    "velocity",
    "spin",
    "acceleration",
    "angular_acceleration",
    "water_load",
    "contact_load",
    "gravity_load",
    "spring_load",
    "joint_load",
    "film",
    "entered",
    "left",
    "lead",
)
_FAR = 1e6  # m off where bodies are that have left or are yet to come, out of reach of everything
_APART = 2.1  # radii that each has there, lest they be looked at as neighbours
_CALM = 0.1  # s in which what is led comes to go straight along


class Bodies:
    """All bodies as arrays of nb rows; a 2D run is per metre of width and turns about y only (`planar`).

    shapes: tables of `solid.shapes`, and their `Forms`; of these radius (nb,), m, volume (nb,), m3.
    mass (nb,), kg; inertia (nb, 3), principal moments in the body frame, kg m2; material (nb,), number of the material;
    fixed (nb,), never moves; released (nb,), s, held in place before and then let go from rest. position (nb, 3), m;
    quaternion (nb, 4), body to global; velocity (nb, 3), m/s; spin (nb, 3), global axes, rad/s.
    joints: what ties them to the world (`solid.ties`). Of the last step: acceleration, angular_acceleration (nb, 3);
    water_load, contact_load, gravity_load, spring_load (to the world) and joint_load (all joints, those springs too)
    (nb, 6): mean force, N, and torque about the centre, N m. film (nb, 7): head of the water around, Pa, at the origin,
    and how well each face is fed with it, 0 to 1 (`coupling.films`). entered (nb,): time, s, at which it came in, inf
    before, -inf of what was there from the start; left (nb,): at which it was taken out, inf before. lead (nb,), m/s:
    what is led goes along x with this, whatever pushes it; nan of what is not.
    """

    def __init__(
        self,
        shapes,
        mass,
        position,
        quaternion=None,
        velocity=0.0,
        spin=0.0,
        *,
        names=None,
        material=0,
        fixed=False,
        released=-math.inf,
        waits=False,
        planar=False,
        joints=(),
    ):
        self.shapes, self.planar = list(shapes), bool(planar)
        count = len(self.shapes)
        self.forms = forms_of(self.shapes, self.planar)
        self.names = list(names) if names is not None else [f"body{b}" for b in range(count)]
        self.mass, self.released = _column(mass, count), _column(released, count)
        self.fixed, self.material = _column(fixed, count, bool), _column(material, count, np.int64)
        self.radius = np.array([s.radius(self.planar) for s in self.shapes], float)
        self.volume = np.array([s.volume for s in self.shapes], float)
        moments = [s.inertia(mass) for s, mass in zip(self.shapes, self.mass, strict=True)]
        self.inertia = np.array(moments, float).reshape(-1, 3)
        self.position, self.velocity, self.spin = (_rows(v, count, 3) for v in (position, velocity, spin))
        still = self.fixed | (self.released > -math.inf)
        self.velocity[still], self.spin[still] = 0.0, 0.0
        self.quaternion = _rows((1.0, 0.0, 0.0, 0.0) if quaternion is None else quaternion, count, 4)
        self.acceleration, self.angular_acceleration = np.zeros((count, 3)), np.zeros((count, 3))
        self.film, self.lead = np.zeros((count, 7)), np.full(count, math.nan)
        self.entered = np.where(_column(waits, count, bool), math.inf, -math.inf)
        self.left = np.full(count, math.inf)
        self.water_load, self.contact_load, self.gravity_load = (np.zeros((count, 6)) for _ in range(3))
        self.spring_load, self.joint_load = (np.zeros((count, 6)) for _ in range(2))
        frames = matrices(np.array([s.turn for s in self.shapes], float).reshape(-1, 4))
        self.joints = joints_of(joints, self.names, self.position, self.quaternion, frames)
        self._berth = _APART * np.cumsum(self.radius)
        for b in np.flatnonzero(self.gone):
            self._send_off(b, 0, -1.0)

    def __len__(self):
        return len(self.mass)

    def kept(self):
        """What a restart needs: name -> array."""
        return {name: getattr(self, name).copy() for name in _KEPT}

    def restore(self, kept):
        """Go on from what `kept` returned."""
        for name in _KEPT:
            getattr(self, name)[:] = kept[name]

    def held(self, time):
        """Which bodies do not move in a step that begins at `time`, s: (nb,) bool."""
        return self.fixed | (time < self.released) | self.gone

    def constraints(self, time, dt):
        """What joints and a plane make of accelerations in the step `dt`, s: the last four of `acceleration.Given`."""
        free, given = self.joints.free.copy(), np.zeros((len(self), 6))
        if self.planar:
            free[:, [1, 3, 5]] = 0.0
        free[self.held(time)] = 0.0
        for b, velocity, spin in self.drives(time, dt):
            free[b] = 0.0
            given[b] = (*(velocity - self.velocity[b]) / dt, *(spin - self.spin[b]) / dt)
        rod, inwards = np.zeros((len(self), 3)), np.zeros(len(self))
        for b in np.flatnonzero((self.joints.rod[:, 3] > 0.0) & free[:, 0].astype(bool)):
            *pivot, length = self.joints.rod[b]
            rod[b] = (self.position[b] - pivot) / length
            inwards[b] = (self.velocity[b] @ self.velocity[b]) / length
        return free, given, rod, inwards

    @property
    def springs(self):
        """The springs of the joints (k, 14) whose bodies are there."""
        springs = self.joints.springs
        return springs[~self.gone[springs[:, 0].astype(int)]] if len(springs) else springs

    def drives(self, time, dt):
        """(number, velocity, spin) of what is there and driven by joints, see `Joints.drives`, or led."""
        driven = [drive for drive in self.joints.drives(time, dt) if not self.gone[drive[0]]]
        keep = max(1.0 - dt / _CALM, 0.0)
        for b in np.flatnonzero(np.isfinite(self.lead)):
            driven.append((b, np.array([self.lead[b], *(keep * self.velocity[b, 1:])]), keep * self.spin[b]))
        return driven

    @property
    def gone(self):
        """Which bodies are not there: have been taken out, or are yet to come in: (nb,) bool."""
        return (self.left < math.inf) | (self.entered == math.inf)

    def reaches(self):
        """How far all reach from their centres along the axes (nb, 3), m."""
        return reaches(self.forms, matrices(self.quaternion))

    def bring_in(self, b, position, quaternion, time):
        """Let body `b` come in at a pose, at rest."""
        self.position[b], self.quaternion[b], self.entered[b] = position, quaternion, time

    def _send_off(self, b, axis, sign):
        self.position[b, axis] = sign * (_FAR + self._berth[b])

    def take_out(self, low, high, time):
        """Take out the bodies that lie wholly outside `low` to `high` (3,), m: numbers, place and velocity (n, 6).

        They stay, at rest, far out on the side where they left. What is led in is not taken out before it is there.
        """
        if not len(self):
            return np.zeros(0, int), np.zeros((0, 6))
        reach = self.reaches()
        below, above = self.position + reach < low, self.position - reach > high
        below[:, 0] &= np.isnan(self.lead)
        at = np.flatnonzero((below | above).any(1) & ~self.gone)
        rows = np.hstack([self.position[at], self.velocity[at]])
        for b in at:
            axis = int(np.argmax(below[b] | above[b]))
            self._send_off(b, axis, -1.0 if below[b, axis] else 1.0)
            self.lead[b] = math.nan
            for of in (
                self.velocity,
                self.spin,
                self.acceleration,
                self.angular_acceleration,
                self.water_load,
                self.contact_load,
                self.gravity_load,
                self.spring_load,
                self.joint_load,
                self.film,
            ):
                of[b] = 0.0
        self.left[at] = time
        return at, rows

    def shown(self, name):
        """The attribute `name`, with nan in the rows of bodies that have been taken out."""
        values = getattr(self, name).copy()
        values[self.gone] = math.nan
        return values

    def drifted(self, dt):
        """Pose after `dt`, s, at the present velocity and angular momentum: (position, quaternion), new arrays."""
        position, quaternion = self.position.copy(), self.quaternion.copy()
        drift(self.mass, self.inertia, self.velocity, self.spin, dt, position, quaternion)
        return position, quaternion

    def surface(self, shift=None):
        """The closed surface of what is there: points (n, 3), m; quads (m, 4), anticlockwise seen from outside.

        Also the body of each quad, (m,). Bodies are drawn with their `shift` (bodies, 3), m, if one is given.
        """
        place = self.position if shift is None else self.position + shift
        turn, first = matrices(self.quaternion), 0
        points, quads, owners = [np.zeros((0, 3))], [np.zeros((0, 4), np.int64)], [np.zeros(0, np.int64)]
        for b in np.flatnonzero(~self.gone):
            corners, faces = self.shapes[b].surface()
            points.append(place[b] + (corners * turn[b][:, None]).sum(-1).T)
            quads.append(faces + first)
            owners.append(np.full(len(faces), b))
            first += len(corners)
        return np.concatenate(points), np.concatenate(quads), np.concatenate(owners)

    def surface_speed(self):
        """Bound of the speed of any point of any body, m/s: |v| + |w| R."""
        return float(largest_speed(self.radius, self.velocity, self.spin))

    def surface_acceleration(self):
        """Bound of the acceleration of any point of any body in the last step, m/s2: |a| + (|dw/dt| + |w|^2) R."""
        a, turn, w = (np.sqrt((v * v).sum(1)) for v in (self.acceleration, self.angular_acceleration, self.spin))
        return float(np.max(a + (turn + w * w) * self.radius, initial=0.0))

    def at_fault(self, limit):
        """Names of the bodies that are not slower than `limit`, m/s, at every point."""
        return [name for name, speed in zip(self.names, self._speeds(), strict=True) if not speed < limit]

    def fastest(self):
        """Name and bound of the speed, m/s, of the fastest body."""
        speeds = self._speeds()
        return self.names[int(np.argmax(speeds))], float(np.max(speeds))

    def _speeds(self):
        return [
            largest_speed(*(each[b : b + 1] for each in (self.radius, self.velocity, self.spin)))
            for b in range(len(self))
        ]

    def kinetic_energy(self):
        """Kinetic energy of all bodies, J (2D: per metre of width)."""
        return float(kinetic(self.mass, self.inertia, self.quaternion, self.velocity, self.spin))

    def potential_energy(self, gravity):
        """Potential energy of all bodies in `gravity` (3,), m/s2; zero at the origin; J."""
        return -math.fsum(
            m * g * x
            for m, at, gone in zip(self.mass, self.position, self.gone, strict=True)
            if not gone
            for g, x in zip(gravity, at, strict=True)
        )


def from_case(case):
    """The bodies of a case, at its start."""
    bodies, numbers = case.bodies, {name: number for number, name in enumerate(case.materials)}
    return Bodies(
        shapes=[b.shape for b in bodies],
        mass=[case.mass_of(b) for b in bodies],
        position=[b.position for b in bodies],
        quaternion=[turned(from_angles(b.angles), b.shape.turn) for b in bodies],
        velocity=[b.velocity for b in bodies],
        spin=[b.spin for b in bodies],
        names=[b.name for b in bodies],
        material=[numbers[b.material] for b in bodies],
        fixed=[b.fixed for b in bodies],
        released=[-math.inf if b.released is None else b.released for b in bodies],
        waits=[b.enters for b in bodies],
        planar=case.dimensions == 2,
        joints=case.joints,
    )


def _column(value, count, kind=float):
    return np.array(np.broadcast_to(np.asarray(value, kind), count), order="C")


def _rows(value, count, width):
    value = np.asarray(value, float)
    value = value if value.size else value.reshape(0, width)
    return np.array(np.broadcast_to(value, (count, width)), order="C")  # kernels are compiled for this layout
