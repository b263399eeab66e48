"""Sweeps of the semi-implicit scheme over neighbour lists, in gather form: particle i writes only to i.

Pressures beyond a wall or in a body are those of the particle that looks there, rising by density times gravity less
the acceleration of what is there: the linear field of water at rest then solves all equations to round-off.
"""

import math

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import kernel, prange, rows
from parsim.particles.state import INTERNAL, VICINITY

_CLOSER = 0.02  # excess of concentration that is pushed apart in one go, at most: a start may have any
_OPEN = 0.85  # of n0: less have only particles that see the air, though beside bodies none may look like a surface
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


@kernel
def slopes(xx, xy, xz, yy, yz, zz, right, limits):
    """The gradient (3,) of what has the sums `right` over the neighbours, by the inverse of the sum of e e W (eq. 18).

    limits: determinant below which that is taken for the one of a full lattice, and its elements, n0 / d.
    """
    bx, by, bz = right
    least, even = limits
    cxx, cxy, cxz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    whole = xx * cxx + xy * cxy + xz * cxz
    if not whole > least:
        return bx / even, by / even, bz / even
    cyy, cyz, czz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    f = 1.0 / whole
    return (
        f * (cxx * bx + cxy * by + cxz * bz),
        f * (cxy * bx + cyy * by + cyz * bz),
        f * (cxz * bx + cyz * by + czz * bz),
    )


@rows
def assemble(at, lists, motion, state, weight, bodies, balance, equation):
    """The pressure equation (eqs 14-15), times lambda n0 / (2 d), with all that is not pressure on its right.

    Left: sum W (p_i - p_j) + kappa (n0 - n)+ p_i + soft p_i over the water; kappa (n0 - n) stands for the water that is
    wanting at the surface, with the pressure that mirrors it there, zero half a spacing above its first row. Right:
    minus the change that the velocities make of n, over dt, walls and bodies with it; what walls and bodies at rest
    have to hold, the rise of the pressure of water at rest; what the faces of bodies sweep by their accelerations
    (`coupling.sides`); what is compressed; what lies too close. Inside, where particles lie unevenly, the sum over a
    linear field is not zero as its Laplacian is: what the gradient of the step before makes of it is taken off, or
    still water loses a per cent of its level. motion: kinematics, acceleration, that gradient; state: p (n,), Pa, of
    the step before, concentration, n (of samples: `sides.wet`), surface, scale; bodies: number, `Sides`, 1 / (2 d /
    (lambda n0) times the volume of a particle).
    """
    start, middle, end, index = lists.start, lists.middle, lists.end, lists.index
    kinematics, acceleration, (sx, sy, sz) = motion
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    ax, ay, az = acceleration
    p, c, n, surface, scale = state
    body, (area, _, wet), volume = bodies
    half, rate, soft, relaxed, number, top, below, dt, share, hx, hy, hz = balance
    pairs, diagonal, right, water = equation.pairs, equation.diagonal, equation.right, equation.water
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi = x[i], y[i], z[i], u[i], v[i], w[i]
        ex, ey, ez = sx[i], sy[i], sz[i]
        every, opens, rises, still, swept = 0.0, 0.0, 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            wt, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            pairs[t] = wt
            every += wt
            rises += wt * (ex * dx + ey * dy + ez * dz)
            opens += g * ((u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz)
        water[i] = every
        ui, vi, wi = ui - hx / rate, vi - hy / rate, wi - hz / rate
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            bare, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            wt = scale[j] * bare
            rises += wt * (ex * dx + ey * dy + ez * dz)
            still += wt * (hx * dx + hy * dy + hz * dz)
            opens += scale[j] * g * ((u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz)
            if body[j] >= 0 and dx * area[j, 0] + dy * area[j, 1] + dz * area[j, 2] < 0.0:
                f = ax[j] * area[j, 0] + ay[j] * area[j, 1] + az[j] * area[j, 2]
                swept += f * bare / max(n[j], wet)
        closer = min(c[i] - 1.0, _CLOSER)
        if surface[i] != INTERNAL:
            every += (below if surface[i] == VICINITY else top) * max(number - n[i], 0.0)
            closer = max(closer, 0.0)
            rises = 0.0
        else:
            every += top * max(_OPEN * number - n[i], 0.0)
        diagonal[i] = every + soft
        source = rate * (dt * volume * swept - half * opens) + still
        right[i] = soft * p[i] + relaxed * closer + share * source - rises


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


@rows
def gradient(at, lists, place, acceleration, fields, weight, slope, out):
    """Acceleration by the pressure of the fluid particles `at`: the gradient of first order (eq. 18) over -density.

    The gradient itself is kept in out for the next step. It counts from p_i and by a share from the least pressure
    around instead, which pushes particles apart. Less `calm` times the viscous sum of the viscous sums b of `predict`:
    what changes from particle to particle, which the equation sees and this gradient does not quite undo, grows from
    step to step without. fields: p, scale, b (n,). `acceleration` holds that of what is solid; out: the same, to be set
    for the water, and the gradient.
    """
    start, middle, end, index = lists.start, lists.middle, lists.end, lists.index
    x, y, z = place
    ax, ay, az = acceleration
    change, steep = out
    ox, oy, oz = change.x, change.y, change.z
    kx, ky, kz = steep.x, steep.y, steep.z
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
        sx, sy, sz = slopes(xx, xy, xz, yy, yz, zz, right, (_SINGULAR * even * even * even, even))
        kx[i], ky[i], kz[i] = sx, sy, sz
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
