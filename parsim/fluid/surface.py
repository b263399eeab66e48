"""Which particles are at the free surface, and what is near it."""

import math
from typing import NamedTuple

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import each, prange, rows
from parsim.particles.state import DETACHED, INTERNAL, SURFACE, VICINITY

_DROP = 3  # other particles of water near one, at most, in a drop


class Bounds(NamedTuple):
    """spacing, m; lowest, highest: the concentrations between which a particle may be at the surface."""

    spacing: float
    lowest: float
    highest: float


@rows
def classify(at, lists, place, c, bounds, surface, normal):
    """Surface, detached or internal (Mellado 2021, eqs 5.34-5.35), by concentration, then by a scan outward.

    On entry `normal` holds the inward kernel sum; on exit the outward unit normal of surface particles, else zero.
    """
    start, end, index = lists.start, lists.end, lists.index
    x, y, z = place
    nx, ny, nz = normal.x, normal.y, normal.z
    spacing, lowest, highest = bounds
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


@each
def clamp(at, lists, surface, n0, loosest, n):
    """Hold n at the surface within `loosest` n0 of n0: a drop must not come back under more than the flow can have.

    A drop of a few particles does not pull: on a body, which turns it out all the time, it would lift that for ever.
    """
    start, middle = lists.start, lists.middle
    for row in prange(at.size):
        i = at[row]
        if surface[i] >= SURFACE:
            lowest = 1.0 if middle[i] - start[i] <= _DROP else 1.0 - loosest
            n[i] = min(max(n[i], n0 * lowest), n0 * (1.0 + loosest))


@rows
def mark(at, lists, place, weight, near, surface, normal):
    """Mark what sees the surface as its vicinity, and give it the sum of the normals that it sees, by weight.

    Only where `near` (particles,) can a surface particle be listed; without it this scan took a fifth of a step.
    """
    start, middle, index = lists.start, lists.middle, lists.index
    x, y, z = place
    nx, ny, nz = normal.x, normal.y, normal.z
    for row in prange(at.size):
        i = at[row]
        if surface[i] != INTERNAL or not near[i]:
            continue
        mx, my, mz, seen = 0.0, 0.0, 0.0, False
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
            nx[i], ny[i], nz[i] = mx, my, mz
