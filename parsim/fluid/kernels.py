"""Sweeps of the explicit MPS scheme over neighbour lists.

Every sweep is in gather form: particle i sums over its own list and writes only to i. Per listed pair the two large
sweeps take 8 gathers and 35-45 flops. They are bound by the issue of instructions: `parsim bench` finds 8 to 13 % less
with all neighbours in the first cache, and two thirds of the time for the gathers alone. Boundary neighbours carry n
and q already multiplied by their scale (share of a lattice volume), so that bodies sampled at another spacing weigh
what they are.
"""

import math

import numpy as np

from parsim.jit import each, kernel, prange, rows
from parsim.state import FLUID, SURFACE


@each
def predict(kind, surface, u, v, w, rate, half, n0, stiffness, x, y, z, n, p, q):
    """Fluid `half` a step on, halo included: positions, number density, pressure.

    State p = stiffness ((n/n0)^7 - 1), stiffness = c0^2 rho0 / 7 (Mellado 2021, eq. 5.17); zero at the surface.
    """
    for i in prange(n.size):
        if kind[i] == FLUID:
            x[i] += half * u[i]
            y[i] += half * v[i]
            z[i] += half * w[i]
            n[i] += half * n[i] * rate[i]
            s = n[i] / n0
            s2 = s * s
            p[i] = 0.0 if surface[i] >= SURFACE else stiffness * (s2 * s2 * s2 * s - 1.0)
            q[i] = p[i] / n[i]


@kernel
def seventh_root(y):
    """Seventh root of 1 + y, y >= 0 and small, by Newton's method: no pow, whose last bit depends on the library."""
    s = 1.0 + y / 7.0
    for _ in range(4):
        s2 = s * s
        s6 = s2 * s2 * s2
        s -= (s6 * s - 1.0 - y) / (7.0 * s6)
    return s


@kernel
def seventh_roots(y):
    """`seventh_root` of each y (n,)."""
    out = np.empty(y.size)
    for i in range(y.size):
        out[i] = seventh_root(y[i])
    return out


@rows
def boundary_pressure(at, start, middle, index, x, y, z, ax, ay, az, scale, gx, gy, gz, density, radius, n0,
                      stiffness, n, p, q):
    """Pressure of boundary samples from the fluid they see (Adami, Hu & Adams 2012, eq. 27), n by the inverse state.

    `ax, ay, az` hold the acceleration of the boundary sample itself.
    """
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi = x[i], y[i], z[i]
        weight = 0.0
        total = 0.0
        hx, hy, hz = density * (gx - ax[i]), density * (gy - ay[i]), density * (gz - az[i])
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = xi - x[j], yi - y[j], zi - z[j]
            r = math.sqrt(dx * dx + dy * dy + dz * dz)
            wt = max(radius / r - 1.0, 0.0)
            weight += wt
            total += wt * (p[j] + hx * dx + hy * dy + hz * dz)
        p[i] = max(total / weight, 0.0) if weight > 0.0 else 0.0
        number = n0 * seventh_root(p[i] / stiffness)
        n[i] = number * scale[i]
        q[i] = p[i] / number * scale[i]


@rows
def momentum(at, start, middle, end, index, x, y, z, u, v, w, n, q, scale, radius, close2, push, drag, hit, n0,
             ax, ay, az, c, nx, ny, nz):
    """Pair accelerations, concentration and inward normal of fluid particles.

    Pressure gradient of Mellado 2021, eq. 5.15, with constant density, push = d / (n0 rho0); viscosity in the
    angular-momentum conserving form, drag = 2 d (d + 2) nu / n0, fluid-fluid only; collision of eqs 5.38-5.39 with
    the sign corrected, as the acceleration hit = (1 + eps) / (2 dt) times the approach, closer than sqrt(close2).
    """
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi, qi, ni = x[i], y[i], z[i], u[i], v[i], w[i], q[i], n[i]
        sx, sy, sz, s = 0.0, 0.0, 0.0, 0.0
        mx, my, mz = 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            inverse2 = inverse * inverse
            wt = max(radius * inverse - 1.0, 0.0)
            g = wt * inverse2
            approach = (u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz
            bounce = hit * min(approach, 0.0) if r2 < close2 else 0.0
            f = (drag * g * approach + bounce) * inverse2 - push * g * (ni * q[j] + qi * n[j])
            sx += f * dx
            sy += f * dy
            sz += f * dz
            s += wt
            e = wt * inverse
            mx += e * dx
            my += e * dy
            mz += e * dz
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            inverse2 = inverse * inverse
            wt = max(radius * inverse - 1.0, 0.0)
            approach = (u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz
            bounce = hit * scale[j] * min(approach, 0.0) if r2 < close2 else 0.0
            f = bounce * inverse2 - push * wt * inverse2 * (ni * q[j] + qi * n[j])
            sx += f * dx
            sy += f * dy
            sz += f * dz
            s += wt * scale[j]
            e = wt * inverse * scale[j]
            mx += e * dx
            my += e * dy
            mz += e * dz
        ax[i], ay[i], az[i] = sx, sy, sz
        c[i] = s / n0
        nx[i], ny[i], nz[i] = mx, my, mz


@rows
def reaction(at, start, middle, index, x, y, z, u, v, w, n, q, scale, radius, close2, push, hit, out):
    """Pair accelerations that body samples give back to the water they see, times -1: rows of out (samples, 3)."""
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi, qi, ni, share = x[i], y[i], z[i], u[i], v[i], w[i], q[i], n[i], scale[i]
        sx, sy, sz = 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            inverse2 = inverse * inverse
            wt = max(radius * inverse - 1.0, 0.0)
            approach = (u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz
            bounce = hit * share * min(approach, 0.0) if r2 < close2 else 0.0
            f = bounce * inverse2 - push * wt * inverse2 * (ni * q[j] + qi * n[j])
            sx += f * dx
            sy += f * dy
            sz += f * dz
        out[row, 0], out[row, 1], out[row, 2] = sx, sy, sz


@rows
def continuity(at, start, middle, end, index, x, y, z, u, v, w, n, c, scale, radius, n0, flow, spread, hx, hy, hz,
               rate, ax, ay, az):
    """Relative rate of n (Mellado 2021, eq. 5.16) with diffusion, and the sum of the concentration gradient (eq. 5.33).

    flow = d / n0; spread = delta c0^2 dt 2 d / (lambda n0), fluid-fluid only, on n less its hydrostatic part, whose
    slope over n0 is h = g / c0^2 (Mellado's eq. 5.30 lets the hydrostatic pressure sag). ax, ay, az receive
    sum (c_i + c_j) e W / r.
    """
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi, ci, ni = x[i], y[i], z[i], u[i], v[i], w[i], c[i], n[i]
        divergence, diffusion = 0.0, 0.0
        sx, sy, sz = 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            inverse = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
            wt = max(radius * inverse - 1.0, 0.0)
            g = wt * inverse * inverse
            divergence += n[j] * g * ((u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz)
            diffusion += wt * ((n[j] - ni) / n0 - (hx * dx + hy * dy + hz * dz))
            f = g * (ci + c[j])
            sx += f * dx
            sy += f * dy
            sz += f * dz
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            inverse = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
            wt = max(radius * inverse - 1.0, 0.0)
            g = wt * inverse * inverse
            divergence += n[j] * g * ((u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz)
            f = g * (ci + 1.0) * scale[j]
            sx += f * dx
            sy += f * dy
            sz += f * dz
        rate[i] = spread * diffusion - flow * divergence / ni
        ax[i], ay[i], az[i] = sx, sy, sz


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
