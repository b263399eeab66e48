"""Which particles are at the free surface, and the shifting that must not push them through it."""

import math

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import kernel, prange, rows
from parsim.particles.state import DETACHED, INTERNAL, SURFACE, VICINITY

_BELOW2 = 0.92  # squared cosine of the widest angle between the way to a bed and the plumb line
_SQUEEZED = 2.5  # times the pull in deep water


@rows
def classify(at, start, end, index, x, y, z, c, spacing, lowest, highest, surface, nx, ny, nz):
    """Surface, detached or internal (Mellado 2021, eqs 5.34-5.35), by concentration, then by a scan outward.

    On entry nx, ny, nz hold the inward kernel sum; on exit the outward unit normal of surface particles, else zero.
    """
    for row in prange(at.size):
        i = at[row]
        mx, my, mz = nx[i], ny[i], nz[i]
        nx[i] = ny[i] = nz[i] = 0.0
        surface[i] = INTERNAL
        length = math.sqrt(mx * mx + my * my + mz * mz)
        if c[i] < lowest:
            surface[i] = DETACHED
        elif c[i] <= highest and length > 0.0:
            mx, my, mz = -mx / length, -my / length, -mz / length
            free = True
            for t in range(np.uint64(start[i]), np.uint64(end[i])):
                j = index[t]
                dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
                sx, sy, sz = dx - spacing * mx, dy - spacing * my, dz - spacing * mz
                far2 = sx * sx + sy * sy + sz * sz
                if dx * dx + dy * dy + dz * dz >= 2.0 * spacing * spacing:
                    free = far2 >= spacing * spacing
                else:
                    along = sx * mx + sy * my + sz * mz
                    free = abs(along) + math.sqrt(max(far2 - along * along, 0.0)) >= spacing
                if not free:
                    break
            if free:
                surface[i] = SURFACE
                nx[i], ny[i], nz[i] = mx, my, mz


@kernel
def packing(i, start, middle, end, index, x, y, z, scale, weight, cut):
    """Measure of the neighbours of particle i with an estimate of what a surface has cut off; cut: see `Lattice`."""
    s, mx, my, mz = 0.0, 0.0, 0.0, 0.0
    for t in range(np.uint64(start), np.uint64(end)):
        j = index[t]
        dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
        r2 = dx * dx + dy * dy + dz * dz
        inverse = 1.0 / math.sqrt(r2)
        _, _, measure = weight_at(weight, r2, inverse)
        measure *= scale[j] if t >= middle else 1.0
        s += measure
        mx += measure * inverse * dx
        my += measure * inverse * dy
        mz += measure * inverse * dz
    return s + cut * math.sqrt(mx * mx + my * my + mz * mz)


@rows
def shift(at, start, middle, end, index, x, y, z, nx, ny, nz, c, scale, body, near, weight, radius, near2, factor,
          longest, n0, own, whole, lost, hx, hy, hz, slope, pull, loosest, ax, ay, az, surface, n):
    """Shift -factor times the sums ax, ay, az of fluid particles, into them (Mellado 2021, eqs 5.31, 5.36-5.37).

    At most `longest`. Never outward through the surface: surface particles move along it, those that see one not toward
    it; detached ones stay. Marks the vicinity. Only where `near` (particles,) is true can a surface particle be listed;
    without it this scan for them took a fifth of a step. A shifted particle takes the hydrostatic density of its new
    place, whose slope along gravity over n0 is `slope`; hx, hy, hz is the unit vector down.

    Shifting moves particles but not the evolved n, which would drift. So n goes back to the concentration, by the share
    `pull`, where no surface or body is in the support and no wall within sqrt(near2). Water so thin that it has no such
    place is pulled where it sees the surface and a bed straight below, and more strongly, to the measure with what the
    surface has cut off (`packing`; lost is `Lattice.cut`). Under the waterline of other walls that would take 0.1 %
    off the level of a narrow tank.
    At the surface n stays within the share `loosest` of n0: a drop must not come back with another pressure than the
    flow can have.
    """
    for row in prange(at.size):
        i = at[row]
        if surface[i] >= SURFACE:
            n[i] = min(max(n[i], n0 * (1.0 - loosest)), n0 * (1.0 + loosest))
        if surface[i] == DETACHED:
            ax[i] = ay[i] = az[i] = 0.0
            continue
        mx, my, mz = nx[i], ny[i], nz[i]
        sx, sy, sz = -factor * ax[i], -factor * ay[i], -factor * az[i]
        inside, seen = surface[i] == INTERNAL, False
        if near[i] and inside:
            for t in range(np.uint64(start[i]), np.uint64(middle[i])):
                j = index[t]
                if surface[j] == SURFACE:
                    dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
                    r2 = dx * dx + dy * dy + dz * dz
                    wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
                    seen = seen or wt > 0.0
                    mx += nx[j] * wt
                    my += ny[j] * wt
                    mz += nz[j] * wt
        if seen:
            surface[i] = VICINITY
        if inside:
            t, beside = middle[i], False
            while not beside and t < end[i]:
                j = index[t]
                dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
                r2 = dx * dx + dy * dy + dz * dz
                if seen:
                    along = dx * hx + dy * hy + dz * hz
                    beside = r2 < radius * radius and along > 0.0 and along * along > _BELOW2 * r2
                else:
                    beside = r2 < (near2 if body[j] < 0 else radius * radius)
                t += 1
            if not seen and not beside:
                n[i] += pull * (n0 * c[i] - n[i])
            elif seen and beside:
                packed = own + packing(i, start[i], middle[i], end[i], index, x, y, z, scale, weight, lost)
                n[i] += _SQUEEZED * pull * (n0 * packed / whole - n[i])
        if surface[i] != INTERNAL:
            length2 = mx * mx + my * my + mz * mz
            out = sx * mx + sy * my + sz * mz
            if length2 > 0.0 and (surface[i] == SURFACE or out > 0.0):
                sx -= out / length2 * mx
                sy -= out / length2 * my
                sz -= out / length2 * mz
        length = math.sqrt(sx * sx + sy * sy + sz * sz)
        cut = longest / length if length > longest else 1.0
        ax[i], ay[i], az[i] = cut * sx, cut * sy, cut * sz
        n[i] += n0 * slope * cut * (hx * sx + hy * sy + hz * sz)
