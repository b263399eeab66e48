"""What a step does to each particle by itself: kicks, drifts, growth of n, state, and the largest speed and travel."""

import numpy as np

from parsim.machine.jit import each, kernel, prange
from parsim.particles.state import DETACHED, FLUID


@each
def predict(kind, surface, velocity, rate, state, place, n, p):
    """Fluid `half` a step on, halo included: positions, number density, pressure.

    State p = stiffness ((n/n0)^7 - 1), stiffness = c0^2 rho0 / 7 (Mellado 2021, eq. 5.17); zero in a splash. At the
    surface it comes out near zero by itself, for continuity lacks there what the pressure force lacks. Setting it to
    zero, as Mellado does, makes it jump by c0^2 dn/n0, more than the weight of some rows, whenever a particle is
    found at the surface or no longer: still water then boils at 0.1 m/s. `state`: half, s, n0, stiffness, Pa.
    """
    x, y, z = place.x, place.y, place.z
    u, v, w = velocity
    half, n0, stiffness = state
    for i in prange(n.size):
        if kind[i] == FLUID:
            x[i] += half * u[i]
            y[i] += half * v[i]
            z[i] += half * w[i]
            n[i] += half * n[i] * rate[i]
            s = n[i] / n0
            s2 = s * s
            p[i] = 0.0 if surface[i] == DETACHED else stiffness * (s2 * s2 * s2 * s - 1.0)


@kernel
def seventh_roots(y):
    """Seventh roots of 1 + y, y (n,) >= 0 and small, by Newton: no pow, whose last bit depends on the library."""
    out = np.empty(y.size)
    for i in range(y.size):
        s = 1.0 + y[i] / 7.0
        for _ in range(4):
            s2 = s * s
            s6 = s2 * s2 * s2
            s -= (s6 * s - 1.0 - y[i]) / (7.0 * s6)
        out[i] = s
    return out


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
def grow(at, rate, dt, n):
    """Number density of the particles `at` over dt at their relative rate."""
    for row in prange(at.size):
        i = at[row]
        n[i] += dt * n[i] * rate[i]


@each
def damp(at, share, twice, velocity):
    """Velocity of the particles `at` less `share` of their twofold viscous sums."""
    ex, ey, ez = twice
    u, v, w = velocity.x, velocity.y, velocity.z
    for row in prange(at.size):
        i = at[row]
        u[i] -= share * ex[i]
        v[i] -= share * ey[i]
        w[i] -= share * ez[i]


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
