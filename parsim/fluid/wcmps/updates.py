"""What a step does to each particle by itself: kicks, drifts, growth of n, and the largest speed and travel."""

import numpy as np

from parsim.machine.jit import each, kernel, prange
from parsim.particles.state import FLUID


@each
def kick(at, gx, gy, gz, keep, dt, ax, ay, az, u, v, w):
    """Velocity of the particles `at` by their pair acceleration and gravity, times `keep` (1 but when settling)."""
    for row in prange(at.size):
        i = at[row]
        u[i] = (u[i] + dt * (ax[i] + gx)) * keep
        v[i] = (v[i] + dt * (ay[i] + gy)) * keep
        w[i] = (w[i] + dt * (az[i] + gz)) * keep


@each
def drift(kind, u, v, w, dt, x, y, z):
    """Positions of all fluid particles over dt at their velocity."""
    for i in prange(x.size):
        if kind[i] == FLUID:
            x[i] += dt * u[i]
            y[i] += dt * v[i]
            z[i] += dt * w[i]


@each
def grow(at, rate, dt, n):
    """Number density of the particles `at` over dt at their relative rate."""
    for row in prange(at.size):
        i = at[row]
        n[i] += dt * n[i] * rate[i]


@each
def damp(at, share, ex, ey, ez, u, v, w):
    """Velocity of the particles `at` less `share` of their twofold viscous sums."""
    for row in prange(at.size):
        i = at[row]
        u[i] -= share * ex[i]
        v[i] -= share * ey[i]
        w[i] -= share * ez[i]


@each
def displace(at, ax, ay, az, x, y, z):
    """Add the shifts of the particles `at`."""
    for row in prange(at.size):
        i = at[row]
        x[i] += ax[i]
        y[i] += ay[i]
        z[i] += az[i]


@kernel
def extremes(at, u, v, w, x, y, z, start):
    """Largest speed and largest distance from `start` (3, n), both squared; infinite when a speed is not finite."""
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
