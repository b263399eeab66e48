"""What a step does to each particle by itself: growth of n, state, damping."""

from parsim.machine.jit import each, prange
from parsim.particles.state import DETACHED, FLUID


@each
def predict(kind, surface, velocity, rate, state, place, n, p):
    """Fluid `half` a step on, halo included: positions, number density, pressure.

    State p = stiffness ((n/n0)^7 - 1), stiffness = c0^2 rho0 / 7 (Mellado 2021, eq. 5.17); zero in a splash and
    where it is shut in. At the surface it comes out near zero by itself, for continuity lacks there what the pressure
    force lacks. Setting it to zero, as Mellado does, makes it jump by c0^2 dn/n0, more than the weight of some rows,
    whenever a particle is found at the surface or no longer: still water then boils at 0.1 m/s. `state`: half, s, n0,
    stiffness, Pa.
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
            p[i] = 0.0 if surface[i] >= DETACHED else stiffness * (s2 * s2 * s2 * s - 1.0)


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
