"""Shifting, which keeps the particles evenly apart and must not push them through the surface."""

import math
from typing import NamedTuple

from parsim.machine.jit import each, prange
from parsim.particles.state import DETACHED, INTERNAL, SURFACE


class Shifting(NamedTuple):
    """Constants of `shift`: factor, m2; longest, m; the way h down, and how n grows that way in water at rest, 1/m."""

    factor: float
    longest: float
    hx: float
    hy: float
    hz: float
    slope: float


@each
def shift(at, surface, normal, shifting, shifts, n):
    """What pushes particles apart, in `shifts`, becomes their shift, m (Mellado 2021, eqs 5.31, 5.36-5.37).

    It is -factor times the sums, at most `longest`, and never outward through the surface: surface particles move along
    it, those that see one not toward it; detached and shut in ones stay. A shifted particle takes the hydrostatic
    density of its new place.
    """
    nx, ny, nz = normal.x, normal.y, normal.z
    ax, ay, az = shifts.x, shifts.y, shifts.z
    factor, longest, hx, hy, hz, slope = shifting
    for row in prange(at.size):
        i = at[row]
        if surface[i] >= DETACHED:
            ax[i] = ay[i] = az[i] = 0.0
            continue
        mx, my, mz = nx[i], ny[i], nz[i]
        sx, sy, sz = -factor * ax[i], -factor * ay[i], -factor * az[i]
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
        n[i] += slope * cut * (hx * sx + hy * sy + hz * sz)
