"""What a stage does to each particle by itself: state, and the sums of its rates."""

from parsim.machine.jit import each, kernel, prange
from parsim.particles.state import FLUID


@each
def press(kind, omega, m, state, p):
    """Pressure of all water, halo included: p = stiffness ((rho / rho0)^7 - 1); `state`: rho0, stiffness."""
    density, stiffness = state
    for i in prange(p.size):
        if kind[i] == FLUID:
            s = m[i] / (density * omega[i])
            s2 = s * s
            p[i] = stiffness * (s2 * s2 * s2 * s - 1.0)


@each
def advance(at, before, rates, frame, step, kinematics, amounts):
    """Place, velocity, volume and mass of the particles `at` a stage on from `before` (8, n), by the rates now.

    `step`: its length, s; gravity, m/s2; share of velocity kept. `amounts`: omega and m.
    """
    dt, gx, gy, gz, keep = step
    grown, gained = rates.volume, rates.mass
    fx, fy, fz = rates.momentum
    sx, sy, sz = frame
    place, velocity = kinematics.place, kinematics.velocity
    x, y, z = place.x, place.y, place.z
    u, v, w = velocity.x, velocity.y, velocity.z
    omega, m = amounts[0], amounts[1]
    for row in prange(at.size):
        i = at[row]
        x[i] = before[0, row] + dt * (u[i] + sx[i])
        y[i] = before[1, row] + dt * (v[i] + sy[i])
        z[i] = before[2, row] + dt * (w[i] + sz[i])
        old, weight = before[7, row], dt * m[i]
        mass = old + dt * gained[i]
        u[i] = (old * before[3, row] + dt * fx[i] + weight * gx) / mass * keep
        v[i] = (old * before[4, row] + dt * fy[i] + weight * gy) / mass * keep
        w[i] = (old * before[5, row] + dt * fz[i] + weight * gz) / mass * keep
        omega[i] = before[6, row] + dt * grown[i]
        m[i] = mass


@kernel
def elastic(at, omega, m, state, out):
    """Elastic energy, J, of each particle `at`: the work of p on its volume; out (n,).

    m c0^2 / 7 (s^6 / 6 + 1 / s - 7 / 6), s = rho / rho0, the integral of the state. `state`: rho0, c0^2.
    """
    density, sound2 = state
    for row in range(at.size):
        i = at[row]
        s = m[i] / (density * omega[i])
        s2 = s * s
        out[row] = m[i] * sound2 / 7.0 * (s2 * s2 * s2 / 6.0 + 1.0 / s - 7.0 / 6.0)
