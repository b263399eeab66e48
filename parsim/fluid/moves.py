"""What moves the particles of any scheme, each by itself, and the largest speed and travel."""

import numpy as np

from parsim.machine.jit import each, kernel, prange
from parsim.particles.state import FLUID


@each
def kick(at, gravity, keep, dt, acceleration, velocity):
    """Velocity of the particles `at` by their pair acceleration and gravity, times `keep` (1 but when settling)."""
    gx, gy, gz = gravity
    ax, ay, az = acceleration
    u, v, w = velocity.x, velocity.y, velocity.z
    for row in prange(at.size):
        i = at[row]
        u[i] = (u[i] + dt * (ax[i] + gx)) * keep
        v[i] = (v[i] + dt * (ay[i] + gy)) * keep
        w[i] = (w[i] + dt * (az[i] + gz)) * keep


@each
def drift(kind, velocity, dt, place):
    """Positions of all fluid particles over dt at their velocity."""
    u, v, w = velocity
    x, y, z = place.x, place.y, place.z
    for i in prange(x.size):
        if kind[i] == FLUID:
            x[i] += dt * u[i]
            y[i] += dt * v[i]
            z[i] += dt * w[i]


@each
def displace(at, shift, place):
    """Add the shifts of the particles `at`."""
    sx, sy, sz = shift
    x, y, z = place.x, place.y, place.z
    for row in prange(at.size):
        i = at[row]
        x[i] += sx[i]
        y[i] += sy[i]
        z[i] += sz[i]


@kernel
def extremes(at, velocity, place, start):
    """Largest speed and largest distance from `start` (3, n), both squared; infinite when a speed is not finite."""
    u, v, w = velocity
    x, y, z = place
    fastest, farthest = 0.0, 0.0
    for row in range(at.size):
        i = at[row]
        speed = u[i] * u[i] + v[i] * v[i] + w[i] * w[i]
        if not speed < np.inf:
            return np.inf, farthest
        dx, dy, dz = x[i] - start[0, row], y[i] - start[1, row], z[i] - start[2, row]
        fastest = max(fastest, speed)
        farthest = max(farthest, dx * dx + dy * dy + dz * dz)
    return fastest, farthest
