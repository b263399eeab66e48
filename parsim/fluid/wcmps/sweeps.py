"""Sweeps of the explicit MPS scheme over neighbour lists.

Every sweep is in gather form: particle i sums over its own list and writes only to i. Per listed pair the two large
sweeps take 7 to 10 gathers and 35-50 flops. They are bound by the issue of instructions: `parsim bench` finds 8 to 13 %
less with all neighbours in the first cache, and two thirds of the time for the gathers alone. Boundary neighbours count
by their scale (share of a lattice volume), so that bodies sampled at another spacing weigh what they are.
"""

import math

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import kernel, prange, rows
from parsim.particles.state import SHUT_IN

LARGEST = 0.1  # correction of `isotropic`: what is less so is made isotropic by that much only
_PART, _FULL = 0.97, 0.99  # share of n0 that water and bodies fill from which a particle is made isotropic, and fully


@rows
def momentum(at, lists, kinematics, pressures, weight, forces, acceleration, around):
    """Pair accelerations, concentration, inward normal and viscous sums of fluid particles.

    Pressure gradient of Mellado 2021, eq. 5.15, with constant volumes, push = d / (n0 rho0), and (1 + t) p of each
    of a pair for its p, t from the tuple `isotropy` (`isotropic`): momentum is kept to the last bit; viscosity in the
    angular-momentum conserving form, drag = 2 d (d + 2) nu / n0, fluid-fluid only, whose sums b are what the noise
    damping works on (`continuity`); off walls and bodies, the collision of eqs 5.38-5.39 with the sign corrected, as
    the acceleration hit = (1 + eps) / (2 dt) times the approach, closer than sqrt(close2), at the boundary's
    velocity after dt. Water does not collide with water: shifting keeps it apart, collisions brake all that strains.
    own, whole: see `Lattice`. On entry `acceleration` holds that of the boundary.
    """
    start, middle, end, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    ax, ay, az = acceleration.x, acceleration.y, acceleration.z
    p, scale, isotropy, _ = pressures
    txx, txy, txz, tyz, tzz = isotropy
    own, whole, close2, push, drag, hit, dt, _ = forces
    c, inward, viscous = around.concentration, around.inward, around.viscous
    nx, ny, nz = inward.x, inward.y, inward.z
    bx, by, bz = viscous.x, viscous.y, viscous.z
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi, pi = x[i], y[i], z[i], u[i], v[i], w[i], p[i]
        sx, sy, sz, s = 0.0, 0.0, 0.0, own
        mx, my, mz = 0.0, 0.0, 0.0
        lx, ly, lz = 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            _, g, measure = weight_at(weight, r2, inverse)
            b = g * inverse * inverse * ((u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz)
            f = g * (pi + p[j])
            e = g * p[j]
            sx += f * dx + e * (txx[j] * dx + txy[j] * dy + txz[j] * dz)
            sy += f * dy + e * (txy[j] * dx - (txx[j] + tzz[j]) * dy + tyz[j] * dz)
            sz += f * dz + e * (txz[j] * dx + tyz[j] * dy + tzz[j] * dz)
            lx += b * dx
            ly += b * dy
            lz += b * dz
            s += measure
            mx += g * dx
            my += g * dy
            mz += g * dz
        sx, sy, sz = drag * lx - push * sx, drag * ly - push * sy, drag * lz - push * sz
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            _, g, measure = weight_at(weight, r2, inverse)
            f = -push * g * (pi + p[j])
            if r2 < close2:
                approach = (u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz
                if approach < 0.0:
                    approach += dt * (ax[j] * dx + ay[j] * dy + az[j] * dz)
                    f += hit * inverse * inverse * approach
            f *= scale[j]
            sx += f * dx
            sy += f * dy
            sz += f * dz
            s += measure * scale[j]
            e = g * scale[j]
            mx += e * dx
            my += e * dy
            mz += e * dz
        e = push * pi
        ax[i] = sx - e * (txx[i] * mx + txy[i] * my + txz[i] * mz)
        ay[i] = sy - e * (txy[i] * mx - (txx[i] + tzz[i]) * my + tyz[i] * mz)
        az[i] = sz - e * (txz[i] * mx + tyz[i] * my + tzz[i] * mz)
        c[i] = s / whole
        nx[i], ny[i], nz[i] = mx, my, mz
        bx[i], by[i], bz[i] = lx, ly, lz


@rows
def reaction(at, lists, kinematics, acceleration, pressures, weight, forces, out):
    """Pair accelerations that body samples give back to the water they see, times -1: rows of out.force.

    They are linear in the sample's acceleration a: its pressure changes by `lever` (samples, 3) . da, `force` by
    -`response` da, a symmetric matrix that is never negative, by its elements xx, xy, xz, yy, yz, zz (samples, 6).
    Which pairs collide is told by the velocities at the start of the step. Water that is shut in pushes nothing.
    """
    start, middle, index = lists.start, lists.middle, lists.index
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    ax, ay, az = acceleration
    p, scale, isotropy, surface = pressures
    txx, txy, txz, tyz, tzz = isotropy
    _, _, close2, push, _, hit, dt, density = forces
    force, lever, response = out.force, out.lever, out.response
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi, pi, share = x[i], y[i], z[i], u[i], v[i], w[i], p[i], scale[i]
        sx, sy, sz = 0.0, 0.0, 0.0
        every, mx, my, mz = 0.0, 0.0, 0.0, 0.0
        xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            if surface[j] == SHUT_IN:
                continue
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            _, g, _ = weight_at(weight, r2, inverse)
            every += g
            mx += g * dx
            my += g * dy
            mz += g * dz
            f = -push * g * (pi + p[j])
            if r2 < close2:
                approach = (u[j] - ui) * dx + (v[j] - vi) * dy + (w[j] - wi) * dz
                if approach < 0.0:
                    approach -= dt * (ax[i] * dx + ay[i] * dy + az[i] * dz)
                    e = hit * inverse * inverse
                    f += e * approach
                    e *= dt
                    xx, xy, xz = xx + e * dx * dx, xy + e * dx * dy, xz + e * dx * dz
                    yy, yz, zz = yy + e * dy * dy, yz + e * dy * dz, zz + e * dz * dz
            f *= share
            e = -push * g * p[j] * share
            sx += f * dx + e * (txx[j] * dx + txy[j] * dy + txz[j] * dz)
            sy += f * dy + e * (txy[j] * dx - (txx[j] + tzz[j]) * dy + tyz[j] * dz)
            sz += f * dz + e * (txz[j] * dx + tyz[j] * dy + tzz[j] * dz)
        force[row, 0], force[row, 1], force[row, 2] = sx, sy, sz
        e = density / every if every > 0.0 else 0.0
        f = push * e
        lever[row, 0], lever[row, 1], lever[row, 2] = e * mx, e * my, e * mz
        response[row, 0], response[row, 1] = share * (xx + f * mx * mx), share * (xy + f * mx * my)
        response[row, 2], response[row, 3] = share * (xz + f * mx * mz), share * (yy + f * my * my)
        response[row, 4], response[row, 5] = share * (yz + f * my * mz), share * (zz + f * mz * mz)


@kernel
def isotropic(xx, xy, xz, yy, yz, zz, dimensions, share):
    """`share` of what times which a symmetric matrix is isotropic, less one: xx, xy, xz, yz, zz. First order; no trace.

    With the sums of e e W of a particle, water under even pressure has no shear stress, however its particles lie.
    Without, it resists like a solid, by about 0.01 of its pressure: a shear wave under 0.05 rho c0^2 decayed a quarter
    too fast along the diagonal of its lattice, a block rose through 0.7 m of water at 0.73 of its speed, waves were 1
    to 2 % too fast. Such a force has no energy of which it is the slope. Deep inside, that does no harm; near a surface
    or a wall it shakes resting water without end, by 12 mm/s in 0.2 m of it, so there its `share` is none.
    """
    if share <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    mean = (xx + yy + zz) / dimensions
    xx, xy, xz, yz, zz = 1.0 - xx / mean, -xy / mean, -xz / mean, -yz / mean, 1.0 - zz / mean
    yy = xx + zz
    size = math.sqrt(xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + xz * xz + yz * yz))
    f = min(share, 1.0, LARGEST / size) if size > 0.0 else 0.0
    return f * xx, f * xy, f * xz, f * yz, f * zz


@rows
def continuity(at, lists, kinematics, density, viscous, weight, growth, out):
    """Relative rate of n (Mellado 2021, eq. 5.16) with diffusion; the sums of shifting and of noise damping.

    The sums of e e W are for the pressure force, see `isotropic`. The divergence is not made isotropic too: n would no
    longer follow the arrangement of the particles, and a shear wave lost a third of a pressure of 0.05 rho c0^2.
    widening = d / n0; spread = delta c0^2 dt 2 d / (lambda n0), fluid-fluid only, on n less its hydrostatic part, whose
    slope over n0 is h = g / c0^2 (Mellado's eq. 5.30 lets the hydrostatic pressure sag).
    `out.apart` receives sum (2 + crowd (close - r)+) e W / r: what pushes particles apart. Its first part, unlike the
    concentration gradient of eq. 5.33, is zero wherever the pressure force of even water is; the second keeps
    streams that strain from leaving the particles in files, which cost a Taylor-Green vortex a fifth of its energy.
    `out.twice` receives the viscous sums of the viscous sums b: twice applied, the viscosity damps what changes from
    particle to particle and leaves what changes over many.
    """
    start, middle, end, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    n, scale, body = density
    bx, by, bz = viscous
    n0, widening, spread, hx, hy, hz, crowd, close, dimensions = growth
    rate, apart, twice, isotropy = out.rate, out.apart, out.twice, out.isotropy
    ax, ay, az = apart.x, apart.y, apart.z
    ex, ey, ez = twice.x, twice.y, twice.z
    txx, txy, txz, tyz, tzz = isotropy.xx, isotropy.xy, isotropy.xz, isotropy.yz, isotropy.zz
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi, ni = x[i], y[i], z[i], u[i], v[i], w[i], n[i]
        bxi, byi, bzi = bx[i], by[i], bz[i]
        divergence, diffusion = 0.0, 0.0
        mxx, mxy, mxz, myy, myz, mzz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        sx, sy, sz = 0.0, 0.0, 0.0
        lx, ly, lz = 0.0, 0.0, 0.0
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            wt, g, _ = weight_at(weight, r2, inverse)
            gx, gy, gz = g * dx, g * dy, g * dz
            divergence += gx * (u[j] - ui) + gy * (v[j] - vi) + gz * (w[j] - wi)
            mxx, mxy, mxz = mxx + gx * dx, mxy + gx * dy, mxz + gx * dz
            myy, myz, mzz = myy + gy * dy, myz + gy * dz, mzz + gz * dz
            diffusion += wt * ((n[j] - ni) / n0 - (hx * dx + hy * dy + hz * dz))
            b = g * inverse * inverse * ((bx[j] - bxi) * dx + (by[j] - byi) * dy + (bz[j] - bzi) * dz)
            lx += b * dx
            ly += b * dy
            lz += b * dz
            f = 2.0 + crowd * max(close - r2 * inverse, 0.0)
            sx += f * gx
            sy += f * gy
            sz += f * gz
        filled = mxx + myy + mzz  # the sum of W
        for t in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            _, g, _ = weight_at(weight, r2, inverse)
            g *= scale[j]
            filled += g * r2 if body[j] >= 0 else 0.0
            gx, gy, gz = g * dx, g * dy, g * dz
            divergence += gx * (u[j] - ui) + gy * (v[j] - vi) + gz * (w[j] - wi)
            mxx, mxy, mxz = mxx + gx * dx, mxy + gx * dy, mxz + gx * dz
            myy, myz, mzz = myy + gy * dy, myz + gy * dz, mzz + gz * dz
            f = 2.0 + crowd * max(close - r2 * inverse, 0.0)
            sx += f * gx
            sy += f * gy
            sz += f * gz
        rate[i] = spread * diffusion - widening * divergence
        txx[i], txy[i], txz[i], tyz[i], tzz[i] = isotropic(
            mxx, mxy, mxz, myy, myz, mzz, dimensions, (filled / n0 - _PART) / (_FULL - _PART)
        )
        ax[i], ay[i], az[i] = sx, sy, sz
        ex[i], ey[i], ez[i] = lx, ly, lz
