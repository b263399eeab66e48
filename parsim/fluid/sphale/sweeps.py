"""Sweeps of SPH-ALE over neighbour lists, in gather form: particle i sums over its list and writes only to i.

Both particles of a pair find the same state between them, so that what one loses the other gains. Pairs of water and
samples of what is solid have no mass flux.
"""

import math

import numpy as np

from parsim.fluid.sphale.riemann import interface, minmod, wall_pressure
from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import kernel, prange, rows

_FASTEST = 6.0  # times the mean speed of approach: a largest one, which is no sum, doubles the time of the sweep
_THIN = 0.02  # determinant of the moments below which a slope is taken as it is: a splash


@kernel
def inverse_of(xx, xy, xz, yy, yz, zz):
    """Inverse of a symmetric matrix, by elements xx, xy, xz, yy, yz, zz; of one close to singular the unit matrix."""
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    det = xx * a + xy * b + xz * c
    if not det > _THIN:
        return 1.0, 0.0, 0.0, 1.0, 0.0, 1.0
    f = 1.0 / det
    return f * a, f * b, f * c, f * (xx * zz - xz * xz), f * (xy * xz - xx * yz), f * (xx * yy - xy * xy)


@kernel
def times(matrix, x, y, z):
    """A symmetric matrix, by elements xx, xy, xz, yy, yz, zz, times a vector."""
    xx, xy, xz, yy, yz, zz = matrix
    return xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z


@rows
def slopes(at, lists, state, scale, weight, constants, out, around):
    """Slopes of what is reconstructed (Robb et al. 2016, eq. 2, made exact for linear fields), and what is `around`.

    `around.apart` receives the slope of the concentration times `spread`, at most 1/2, times the speed at which the
    neighbours approach, m/s.
    """
    start, middle, end, index = lists
    x, y, z = state.place
    u, v, w = state.velocity
    p, omega = state.p, state.omega
    hx, hy, hz, over, volume = constants.hx, constants.hy, constants.hz, constants.over, constants.volume
    own, whole, spread, flat = constants.own, constants.whole, constants.spread, constants.flat
    qx, qy, qz = out.q.x, out.q.y, out.q.z
    ux, uy, uz = out.u.x, out.u.y, out.u.z
    vx, vy, vz = out.v.x, out.v.y, out.v.z
    wx, wy, wz = out.w.x, out.w.y, out.w.z
    concentration = around.concentration
    nx, ny, nz = around.inward.x, around.inward.y, around.inward.z
    sx, sy, sz = around.apart.x, around.apart.y, around.apart.z
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi, pi = x[i], y[i], z[i], u[i], v[i], w[i], p[i]
        mxx, mxy, mxz, myy, myz, mzz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        ax, ay, az = 0.0, 0.0, 0.0
        bx, by, bz = 0.0, 0.0, 0.0
        cx, cy, cz = 0.0, 0.0, 0.0
        dx, dy, dz = 0.0, 0.0, 0.0
        ix, iy, iz, s = 0.0, 0.0, 0.0, own
        kx, ky, kz, nearing = 0.0, 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            ex, ey, ez = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = ex * ex + ey * ey + ez * ez
            inverse = 1.0 / math.sqrt(r2)
            _, g, measure = weight_at(weight, r2, inverse)
            du, dv, dw = u[j] - ui, v[j] - vi, w[j] - wi
            s += measure
            ix, iy, iz = ix + g * ex, iy + g * ey, iz + g * ez
            approach = -inverse * (du * ex + dv * ey + dw * ez)
            nearing += measure * max(approach, 0.0)
            g *= over * omega[j]
            gx, gy, gz = g * ex, g * ey, g * ez
            mxx, mxy, mxz = mxx + gx * ex, mxy + gx * ey, mxz + gx * ez
            myy, myz, mzz = myy + gy * ey, myz + gy * ez, mzz + gz * ez
            dq = p[j] - pi - (hx * ex + hy * ey + hz * ez)
            ax, ay, az = ax + dq * gx, ay + dq * gy, az + dq * gz
            bx, by, bz = bx + du * gx, by + du * gy, bz + du * gz
            cx, cy, cz = cx + dv * gx, cy + dv * gy, cz + dv * gz
            dx, dy, dz = dx + dw * gx, dy + dw * gy, dz + dw * gz
            kx, ky, kz = kx + gx, ky + gy, kz + gz
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            ex, ey, ez = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = ex * ex + ey * ey + ez * ez
            inverse = 1.0 / math.sqrt(r2)
            _, g, measure = weight_at(weight, r2, inverse)
            approach = -inverse * ((u[j] - ui) * ex + (v[j] - vi) * ey + (w[j] - wi) * ez)
            nearing += measure * scale[j] * max(approach, 0.0)
            g *= scale[j]
            s += measure * scale[j]
            ix, iy, iz = ix + g * ex, iy + g * ey, iz + g * ez
            g *= over * volume
            kx, ky, kz = kx + g * ex, ky + g * ey, kz + g * ez
        matrix = inverse_of(mxx, mxy, mxz, myy + flat, myz, mzz)
        qx[i], qy[i], qz[i] = times(matrix, ax, ay, az)
        ux[i], uy[i], uz[i] = times(matrix, bx, by, bz)
        vx[i], vy[i], vz[i] = times(matrix, cx, cy, cz)
        wx[i], wy[i], wz[i] = times(matrix, dx, dy, dz)
        concentration[i] = s / whole
        nx[i], ny[i], nz[i] = ix, iy, iz
        length = math.sqrt(kx * kx + ky * ky + kz * kz)
        f = _FASTEST * nearing / s * (spread if spread * length < 0.5 else 0.5 / length)
        sx[i], sy[i], sz[i] = f * kx, f * ky, f * kz


@rows
def fluxes(at, lists, state, slope, solid, weight, constants, out):
    """Rates of volume, mass and momentum of the particles `at` (Vila 1999; Robb et al. 2016, eqs 1 and 3, sign turned).

    Particles move at the velocity of the water and `state.frame`; what is reconstructed, by minmod, is the velocity and
    p less its hydrostatic part. Volume changes at samples count twice, as the pressure there does: the work of both is
    then the same. Neighbours swap water until their volumes are even, which would else drift apart by the fluxes.
    Viscosity in the form that conserves angular momentum, between particles of water only.
    """
    start, middle, end, index = lists
    x, y, z = state.place
    u, v, w = state.velocity
    p, omega = state.p, state.omega
    qx, qy, qz = slope.q
    ux, uy, uz = slope.u
    vx, vy, vz = slope.v
    wx, wy, wz = slope.w
    sx, sy, sz = state.frame
    scale = solid.scale
    ax, ay, az = solid.acceleration
    nx, ny, nz = solid.normal
    rho, modulus, impedance = constants.density, constants.modulus, constants.impedance
    least, ease, even = constants.least, constants.ease, constants.even
    gx, gy, gz, hx, hy, hz = constants.gx, constants.gy, constants.gz, constants.hx, constants.hy, constants.hz
    over, full, stress = constants.over, constants.volume, constants.drag
    grown, gained = out.volume, out.mass
    fx, fy, fz = out.momentum.x, out.momentum.y, out.momentum.z
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi, pi = x[i], y[i], z[i], u[i], v[i], w[i], p[i]
        u0, v0, w0 = ui + sx[i], vi + sy[i], wi + sz[i]
        volume, mass, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            _, g, _ = weight_at(weight, r2, inverse)
            g *= omega[j]
            ex, ey, ez = dx * inverse, dy * inverse, dz * inverse
            du, dv, dw = u[j] - ui, v[j] - vi, w[j] - wi
            half = 0.5 * (hx * dx + hy * dy + hz * dz)
            dq = p[j] - pi - 2.0 * half
            left = pi + half + 0.5 * minmod(dq, 2.0 * (qx[i] * dx + qy[i] * dy + qz[i] * dz) - dq)
            right = p[j] - half - 0.5 * minmod(dq, 2.0 * (qx[j] * dx + qy[j] * dy + qz[j] * dz) - dq)
            ul = ui + 0.5 * minmod(du, 2.0 * (ux[i] * dx + uy[i] * dy + uz[i] * dz) - du)
            ur = u[j] - 0.5 * minmod(du, 2.0 * (ux[j] * dx + uy[j] * dy + uz[j] * dz) - du)
            vl = vi + 0.5 * minmod(dv, 2.0 * (vx[i] * dx + vy[i] * dy + vz[i] * dz) - dv)
            vr = v[j] - 0.5 * minmod(dv, 2.0 * (vx[j] * dx + vy[j] * dy + vz[j] * dz) - dv)
            wl = wi + 0.5 * minmod(dw, 2.0 * (wx[i] * dx + wy[i] * dy + wz[i] * dz) - dw)
            wr = w[j] - 0.5 * minmod(dw, 2.0 * (wx[j] * dx + wy[j] * dy + wz[j] * dz) - dw)
            nl, nr = ul * ex + vl * ey + wl * ez, ur * ex + vr * ey + wr * ez
            pressure, normal, density = interface((left, nl), (right, nr), (rho, modulus, impedance, least, ease))
            ou, ov, ow = u[j] + sx[j], v[j] + sy[j], w[j] + sz[j]
            flux = density * (normal - 0.5 * ((u0 + ou) * ex + (v0 + ov) * ey + (w0 + ow) * ez))
            swap = even * (omega[i] - omega[j]) / (omega[i] + omega[j])
            flux += density * swap
            upwind = flux > 0.0
            along = normal - (nl if upwind else nr)
            f = 2.0 * g / inverse
            e = f * flux
            mass += e
            pressure *= f
            drag = stress * g * inverse * inverse * (du * dx + dv * dy + dw * dz)
            mx += e * ((ul if upwind else ur) + along * ex) + pressure * ex - drag * dx
            my += e * ((vl if upwind else vr) + along * ey) + pressure * ey - drag * dy
            mz += e * ((wl if upwind else wr) + along * ez) + pressure * ez - drag * dz
            volume -= f * swap
            volume += g * ((ou - u0) * dx + (ov - v0) * dy + (ow - w0) * dz)
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            _, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            g *= 2.0 * full * scale[j]
            toward = (gx - ax[j]) * dx + (gy - ay[j]) * dy + (gz - az[j]) * dz
            along_u = ux[i] * dx + uy[i] * dy + uz[i] * dz
            along_v = vx[i] * dx + vy[i] * dy + vz[i] * dz
            along_w = wx[i] * dx + wy[i] * dy + wz[i] * dz
            meeting = (u[j] - ui, v[j] - vi, w[j] - wi)
            way, face = (dx, dy, dz), (nx[j], ny[j], nz[j])
            pressure = g * wall_pressure(
                pi, way, toward, face, meeting, (along_u, along_v, along_w), (rho, modulus, impedance, least, ease)
            )
            mx += pressure * dx
            my += pressure * dy
            mz += pressure * dz
            volume += g * ((u[j] - u0) * dx + (v[j] - v0) * dy + (w[j] - w0) * dz)
        f = over * omega[i]
        grown[i], gained[i] = f * volume, -f * mass
        fx[i], fy[i], fz[i] = -f * mx, -f * my, -f * mz
