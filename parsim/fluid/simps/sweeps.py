"""Sweeps of the semi-implicit scheme over neighbour lists, in gather form: particle i writes only to i.

Pressures beyond a wall or in a body are those of the particle that looks there, rising by density times gravity less
the acceleration of what is there: the linear field of water at rest then solves all equations to round-off.
"""

import math

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import kernel, prange, rows
from parsim.particles.state import INTERNAL, VICINITY

_SINGULAR = 0.05  # determinant over that of the lattice below which a gradient is not corrected


@rows
def predict(at, lists, kinematics, scale, weight, given, change, around):
    """Velocity changes by viscosity (eq. 7) and collision (eqs 11-13), concentration, sum of the weights, inward sum.

    Numbers of equations: Amaro et al. 2021. drag = 2 d nu / (lambda n0), fluid-fluid only. Pairs closer than
    sqrt(close2) that approach collide, all at once; of two particles of water each takes half.
    """
    start, middle, end, index = lists.start, lists.middle, lists.end, lists.index
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    own, whole, drag, close2, bounce, dt = given
    ax, ay, az = change.x, change.y, change.z
    c, n, inward, viscous = around.concentration, around.number, around.inward, around.viscous
    nx, ny, nz = inward.x, inward.y, inward.z
    bx, by, bz = viscous.x, viscous.y, viscous.z
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi = x[i], y[i], z[i], u[i], v[i], w[i]
        lx, ly, lz, hx, hy, hz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        mx, my, mz, every, filled = 0.0, 0.0, 0.0, 0.0, own
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            wt, g, measure = weight_at(weight, r2, inverse)
            du, dv, dw = u[j] - ui, v[j] - vi, w[j] - wi
            lx += wt * du
            ly += wt * dv
            lz += wt * dw
            f = min(du * dx + dv * dy + dw * dz, 0.0) * inverse * inverse
            f = 0.5 * f if r2 < close2 else 0.0
            hx += f * dx
            hy += f * dy
            hz += f * dz
            every += wt
            filled += measure
            mx += g * dx
            my += g * dy
            mz += g * dz
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            wt, g, measure = weight_at(weight, r2, inverse)
            f = min((u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz, 0.0) * inverse * inverse
            f = f * scale[j] if r2 < close2 else 0.0
            hx += f * dx
            hy += f * dy
            hz += f * dz
            every += wt * scale[j]
            filled += measure * scale[j]
            g *= scale[j]
            mx += g * dx
            my += g * dy
            mz += g * dz
        ax[i] = drag * lx + bounce / dt * hx
        ay[i] = drag * ly + bounce / dt * hy
        az[i] = drag * lz + bounce / dt * hz
        c[i], n[i] = filled / whole, every
        nx[i], ny[i], nz[i] = mx, my, mz
        bx[i], by[i], bz[i] = lx, ly, lz


@rows
def assemble(at, lists, motion, state, weight, bodies, balance, equation):
    """The pressure equation (eqs 14-15), times lambda n0 / (2 d), with all that is not pressure on its right.

    Water: sum W (p_i - p_j) + kappa (n0 - n)+ p_i + soft p_i; right: minus the divergence over dt, what is compressed,
    and what lies too close. kappa (n0 - n) stands for the water that is wanting at the surface, with the pressure that
    mirrors it there, zero half a spacing above its first row. At walls and bodies, whose pressures are mirrored too,
    what is left of sum W (p_i - p_j) is the divergence by the velocity that they have after dt without any pressure;
    of bodies it is what their faces sweep, `coupling.sides`, and for their places the rise of water at rest, (3,), Pa/m.
    Inside, where particles lie unevenly, the linear field of water at rest is no solution of that; what its sum wants
    is added on the right. Without, still water loses a per cent of its level. motion: kinematics, acceleration; state:
    p (n,), Pa, of the step before, concentration, sum of the weights (of samples: `sides.wet`), surface, scale;
    bodies: number, area (n, 3), least weight before a wet face, 1 / (laplacian times the volume of a particle).
    """
    start, middle, end, index = lists.start, lists.middle, lists.end, lists.index
    kinematics, acceleration = motion
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    ax, ay, az = acceleration
    p, c, n, surface, scale = state
    body, area, least, swept = bodies
    half, rate, soft, relaxed, number, top, below, dt, share, hx, hy, hz = balance
    pairs, diagonal, right = equation.pairs, equation.diagonal, equation.right
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi = x[i], y[i], z[i], u[i], v[i], w[i]
        every, opens, rises, still = 0.0, 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            wt, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            pairs[t] = wt
            every += wt
            rises += wt * (hx * dx + hy * dy + hz * dz)
            opens += g * ((u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz)
        opens *= half
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            du, dv, dw = u[j] + dt * ax[j] - ui, v[j] + dt * ay[j] - vi, w[j] + dt * az[j] - wi
            bare = wt
            wt *= scale[j]
            rise = wt * (hx * dx + hy * dy + hz * dz)
            rises += rise
            if body[j] < 0:
                opens += wt * (du * dx + dv * dy + dw * dz)
            else:
                still += rise
                if dx * area[j, 0] + dy * area[j, 1] + dz * area[j, 2] < 0.0:
                    f = (du + hx / rate) * area[j, 0] + (dv + hy / rate) * area[j, 1] + (dw + hz / rate) * area[j, 2]
                    opens -= swept * f * bare / max(n[j], least)
        closer = c[i] - 1.0
        if surface[i] != INTERNAL:
            every += (below if surface[i] == VICINITY else top) * max(number - n[i], 0.0)
            closer = max(closer, 0.0)
            rises = 0.0
        diagonal[i] = every + soft
        right[i] = soft * p[i] + relaxed * closer - share * rate * opens + still - rises


@rows
def apply(at, lists, equation, values, out):
    """The water's part of the matrix times `values` (n,): out (n,), at the particles `at`."""
    start, middle, index = lists.start, lists.middle, lists.index
    pairs, diagonal = equation.pairs, equation.diagonal
    for row in prange(at.size):
        i = at[row]
        s = 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            s += pairs[t] * values[index[t]]
        out[i] = diagonal[i] * values[i] - s


@kernel
def solved(xx, xy, xz, yy, yz, zz, right, least):
    """Solution (3,) of a symmetric 3x3 system, and whether its determinant is more than `least`."""
    bx, by, bz = right
    cxx, cxy, cxz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    whole = xx * cxx + xy * cxy + xz * cxz
    if not whole > least:
        return 0.0, 0.0, 0.0, False
    cyy, cyz, czz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    f = 1.0 / whole
    return (
        f * (cxx * bx + cxy * by + cxz * bz),
        f * (cxy * bx + cyy * by + cyz * bz),
        f * (cxz * bx + cyz * by + czz * bz),
        True,
    )


@rows
def gradient(at, lists, place, acceleration, fields, weight, slope, out):
    """Acceleration by the pressure of the fluid particles `at`: the gradient of first order (eq. 18) over -density.

    It counts from p_i and by a share from the least pressure around instead, which pushes particles apart. Less `calm`
    times the viscous sum of the viscous sums b of `predict`: what changes from particle to particle, which the equation
    sees and this gradient does not quite undo, grows from step to step without. fields: p, scale, b (n,).
    `acceleration` holds that of what is solid; `out` is the same.
    """
    start, middle, end, index = lists.start, lists.middle, lists.end, lists.index
    x, y, z = place
    ax, ay, az = acceleration
    ox, oy, oz = out.x, out.y, out.z
    p, scale, bx, by, bz = fields
    least, density, even, planar, calm, hx, hy, hz = slope
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, pi = x[i], y[i], z[i], p[i]
        lowest, bxi, byi, bzi = pi, bx[i], by[i], bz[i]
        lx, ly, lz = 0.0, 0.0, 0.0
        sx, sy, sz, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, planar * even, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            wt, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            lx += wt * (bx[j] - bxi)
            ly += wt * (by[j] - byi)
            lz += wt * (bz[j] - bzi)
            lowest = min(lowest, p[j] if g > 0.0 else lowest)
            ex, ey, ez = g * dx, g * dy, g * dz
            f = p[j] - pi
            sx += f * ex
            sy += f * ey
            sz += f * ez
            mx += ex
            my += ey
            mz += ez
            xx, xy, xz, yy, yz, zz = xx + ex * dx, xy + ex * dy, xz + ex * dz, yy + ey * dy, yz + ey * dz, zz + ez * dz
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            _, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            g *= scale[j]
            ex, ey, ez = g * dx, g * dy, g * dz
            f = (hx - density * ax[j]) * dx + (hy - density * ay[j]) * dy + (hz - density * az[j]) * dz
            sx += f * ex
            sy += f * ey
            sz += f * ez
            mx += ex
            my += ey
            mz += ez
            xx, xy, xz, yy, yz, zz = xx + ex * dx, xy + ex * dy, xz + ex * dz, yy + ey * dy, yz + ey * dz, zz + ez * dz
        f = least * (pi - lowest)
        right = sx + f * mx, sy + f * my, sz + f * mz
        sx, sy, sz, regular = solved(xx, xy, xz, yy, yz, zz, right, _SINGULAR * even * even * even)
        if not regular:
            sx, sy, sz = right[0] / even, right[1] / even, right[2] / even
        ox[i], oy[i], oz[i] = -sx / density - calm * lx, -sy / density - calm * ly, -sz / density - calm * lz


@rows
def reaction(at, lists, place, acceleration, pressures, weight, forces, force):
    """Forces of the water on the samples `at`, N: rows of `force` (samples, 3).

    Each pair of water and sample presses with the mean of the two pressures, as the pressure equation has it. forces:
    unit = V d / (lambda n0); density; rise of the pressure of water at rest, Pa/m.
    """
    start, middle, index = lists.start, lists.middle, lists.index
    x, y, z = place
    ax, ay, az = acceleration
    p, scale = pressures
    unit, density, fx, fy, fz = forces
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi = x[i], y[i], z[i]
        hx, hy, hz = fx - density * ax[i], fy - density * ay[i], fz - density * az[i]
        sx, sy, sz = 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = xi - x[j], yi - y[j], zi - z[j]
            r2 = dx * dx + dy * dy + dz * dz
            wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            f = wt * (2.0 * p[j] + hx * dx + hy * dy + hz * dz)
            sx += f * dx
            sy += f * dy
            sz += f * dz
        e = unit * scale[i]
        force[row, 0], force[row, 1], force[row, 2] = e * sx, e * sy, e * sz
