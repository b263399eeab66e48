"""What the water does to samples of what is solid: the fluxes that it gets of them, with their signs turned."""

import math

import numpy as np

from parsim.fluid.sphale.riemann import wall_pressure
from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import prange, rows


@rows
def reaction(at, lists, state, slope, solid, weight, constants, out):
    """Forces of the water on the samples `at`, N: rows of out.force (Robb et al. 2016, eqs 4 and 5).

    They are linear in the sample's acceleration a: `force` changes by -`response` da, a symmetric matrix that is never
    negative, by its elements xx, xy, xz, yy, yz, zz, kg (samples, 6); the sample's own pressure by `lever` . da
    (samples, 3), Pa s2/m.
    """
    start, middle, index = lists.start, lists.middle, lists.index
    x, y, z = state.place
    u, v, w = state.velocity
    p, omega = state.p, state.omega
    ux, uy, uz = slope.u
    vx, vy, vz = slope.v
    wx, wy, wz = slope.w
    scale = solid.scale
    ax, ay, az = solid.acceleration
    nx, ny, nz = solid.normal
    gx, gy, gz, over = constants.gx, constants.gy, constants.gz, constants.over * constants.volume
    rho, modulus, impedance = constants.density, constants.modulus, constants.impedance
    least, ease = constants.least, constants.ease
    force, lever, response = out.force, out.lever, out.response
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi = x[i], y[i], z[i], u[i], v[i], w[i]
        hx, hy, hz = gx - ax[i], gy - ay[i], gz - az[i]
        face = (nx[i], ny[i], nz[i])
        sx, sy, sz, every, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = xi - x[j], yi - y[j], zi - z[j]
            r2 = dx * dx + dy * dy + dz * dz
            _, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            every += g
            mx, my, mz = mx + g * dx, my + g * dy, mz + g * dz
            g *= omega[j]
            along_u = ux[j] * dx + uy[j] * dy + uz[j] * dz
            along_v = vx[j] * dx + vy[j] * dy + vz[j] * dz
            along_w = wx[j] * dx + wy[j] * dy + wz[j] * dz
            toward, meeting = hx * dx + hy * dy + hz * dz, (ui - u[j], vi - v[j], wi - w[j])
            way, slopes = (dx, dy, dz), (along_u, along_v, along_w)
            f = (
                2.0
                * g
                * wall_pressure(p[j], way, toward, face, meeting, slopes, (rho, modulus, impedance, least, ease))
            )
            sx += f * dx
            sy += f * dy
            sz += f * dz
            xx, xy, xz = xx + g * dx * dx, xy + g * dx * dy, xz + g * dx * dz
            yy, yz, zz = yy + g * dy * dy, yz + g * dy * dz, zz + g * dz * dz
        f = over * scale[i]
        force[row, 0], force[row, 1], force[row, 2] = f * sx, f * sy, f * sz
        f *= rho
        response[row, 0], response[row, 1], response[row, 2] = f * xx, f * xy, f * xz
        response[row, 3], response[row, 4], response[row, 5] = f * yy, f * yz, f * zz
        e = rho / every if every > 0.0 else 0.0
        lever[row, 0], lever[row, 1], lever[row, 2] = -e * mx, -e * my, -e * mz
