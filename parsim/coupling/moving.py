"""What is felt in a box that moves: gravity turned into it, and the accelerations that come of its own.

Euler, centrifugal and Coriolis terms: Goldstein, Classical Mechanics, sec. 4.10.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.geometry.rotation import matrices
from parsim.particles.tables import Vectors

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.particles.state import Particles
    from parsim.solid.bodies import Bodies


class Turning(NamedTuple):
    """A box that turns about an axis along y through x, z, m, at a rate, rad/s, that grows, rad/s2."""

    x: float
    z: float
    rate: float
    growth: float

    def felt(self, x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Euler's and the centrifugal acceleration along x and z, m/s2, at places x, z (n,), m."""
        dx, dz, square = x - self.x, z - self.z, self.rate * self.rate
        return square * dx - self.growth * dz, square * dz + self.growth * dx

    def less(self, p: Particles) -> Vectors:
        """Accelerations of all particles, m/s2, less what is felt where they are: what pressure has to balance."""
        ax, az = self.felt(p.x, p.z)
        return Vectors(p.ax - ax, p.ay, p.az - az)

    def push(self, p: Particles, at: np.ndarray, gravity: tuple[float, float, float], dt: float) -> None:
        """Add what the particles `at` feel, Coriolis' too, to their acceleration by pairs, in a step of dt, s."""
        ax, az = self.felt(p.x[at], p.z[at])
        ax, az = p.ax[at] + ax, p.az[at] + az
        u = p.u[at] + 0.5 * dt * (ax + gravity[0])  # at the middle of the step, or it makes energy
        w = p.w[at] + 0.5 * dt * (az + gravity[2])
        p.ax[at], p.az[at] = ax - 2.0 * self.rate * w, az + 2.0 * self.rate * u

    def load(self, b: Bodies, ahead: float) -> np.ndarray:
        """What each body feels `ahead` s on from where it is, Coriolis' too: force, N, and torque, N m, (bodies, 6).

        With S the integral of r r^T over the mass, Omega the turning and omega the spin, the torque is
        -I dOmega/dt - (S Omega) x (2 omega + Omega).
        """
        (x, _, z), (u, _, w) = (b.position + ahead * b.velocity).T, (b.velocity + ahead * b.acceleration).T
        (ax, az), out, turn = self.felt(x, z), np.zeros((len(b), 6)), matrices(b.quaternion)
        out[:, 0], out[:, 2] = b.mass * (ax - 2.0 * self.rate * w), b.mass * (az + 2.0 * self.rate * u)
        about = np.einsum("bij,bj,bj->bi", turn, b.inertia, turn[:, 1])  # I along y
        spread = 0.5 * b.inertia.sum(axis=1)[:, None] * (0.0, 1.0, 0.0) - about
        both = 2.0 * (b.spin + ahead * b.angular_acceleration) + np.array([0.0, self.rate, 0.0])
        out[:, 3:] = -self.growth * about - self.rate * np.cross(spread, both)
        return out


class Moving:
    """How the box of a case moves: a function of time alone."""

    def __init__(self, case: Case) -> None:
        self._motion, self._gravity = case.motion, case.gravity
        self._course = case.motion.course() if case.motion else None

    def __bool__(self) -> bool:
        return self._course is not None

    def gravity(self, time: float) -> tuple[float, float, float]:
        """What is felt everywhere in the box, m/s2, at a time, s."""
        value, _, second = self._course(time)
        x, y, z = self._gravity
        if self._motion.kind == "sway":
            return x - second, y, z
        c, s = math.cos(value), math.sin(value)
        return c * x - s * z, y, s * x + c * z

    def turning(self, time: float) -> Turning | None:
        """How the box turns at a time, s; None where it does not."""
        if self._course is None or self._motion.kind == "sway":
            return None
        about = self._motion.about
        return Turning(about[0], about[2], *self._course(time)[1:])

    def power(self, time: float, place: Vectors, velocity: Vectors) -> np.ndarray:
        """Work, W/kg, that all but the gravity of the case does on water in the box at a time, s: (n,)."""
        x, y, z = np.subtract(self.gravity(time), self._gravity).tolist()
        turning = self.turning(time)
        if turning:
            ax, az = turning.felt(place.x, place.z)
            x, z = ax + x, az + z
        return x * velocity.x + y * velocity.y + z * velocity.z

    def power_on(self, time: float, bodies: Bodies) -> np.ndarray:
        """The same on bodies, W, (bodies,)."""
        load, turning = np.zeros((len(bodies), 6)), self.turning(time)
        load[:, :3] = bodies.mass[:, None] * np.subtract(self.gravity(time), self._gravity)
        if turning:
            load += turning.load(bodies, 0.0)
        return (load * np.hstack([bodies.velocity, bodies.spin])).sum(axis=1)
