"""Density that has drifted from the arrangement of the particles goes back to it."""

import math
from typing import NamedTuple

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import kernel, prange, rows
from parsim.particles.state import INTERNAL, VICINITY

_BELOW2 = 0.92  # squared cosine of the widest angle between the way to a bed and the plumb line


class Recovery(NamedTuple):
    """Constants of `recover`: pull, the share of a step, thin, that of thin water; near2, m2; the way h down.

    The rest: see `Lattice`.
    """

    radius2: float
    near2: float
    n0: float
    own: float
    whole: float
    cut: float
    hx: float
    hy: float
    hz: float
    pull: float
    thin: float


@kernel
def beside(i, lists, place, body, seen, recovery):
    """Whether i has a body in its support or a wall within sqrt(near2); where the surface is `seen`, a bed below."""
    middle, end, index = lists.middle, lists.end, lists.index
    x, y, z = place
    for t in range(middle[i], end[i]):
        j = index[t]
        dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
        r2 = dx * dx + dy * dy + dz * dz
        if seen:
            along = dx * recovery.hx + dy * recovery.hy + dz * recovery.hz
            if r2 < recovery.radius2 and along > 0.0 and along * along > _BELOW2 * r2:
                return True
        elif r2 < (recovery.near2 if body[j] < 0 else recovery.radius2):
            return True
    return False


@kernel
def packing(i, lists, place, scale, weight, cut):
    """Measure of the neighbours of particle i with an estimate of what a surface has cut off."""
    start, middle, end, index = lists
    x, y, z = place
    s, mx, my, mz = 0.0, 0.0, 0.0, 0.0
    for t in range(np.uint64(start[i]), np.uint64(end[i])):
        j = index[t]
        dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
        r2 = dx * dx + dy * dy + dz * dz
        inverse = 1.0 / math.sqrt(r2)
        _, _, measure = weight_at(weight, r2, inverse)
        measure *= scale[j] if t >= middle[i] else 1.0
        s += measure
        mx += measure * inverse * dx
        my += measure * inverse * dy
        mz += measure * inverse * dz
    return s + cut * math.sqrt(mx * mx + my * my + mz * mz)


@rows
def recover(at, lists, place, solid, around, weight, recovery, n):
    """Share of the way of n back to the concentration. `around`: concentration (n,) and surface (n,), marked.

    Shifting moves particles but not the evolved n, which would drift. So n is pulled where no surface or body is in the
    support and no wall within sqrt(near2). Water so thin that it has no such place is pulled where it sees the surface
    and a bed straight below, to the measure with what the surface has cut off (`packing`). Under the
    waterline of other walls that would take 0.1 % off the level of a narrow tank. `solid`: scale (n,) and body (n,).
    """
    c, surface = around
    scale, body = solid
    n0, whole, pull = recovery.n0, recovery.whole, recovery.pull
    for row in prange(at.size):
        i = at[row]
        if surface[i] != INTERNAL and surface[i] != VICINITY:
            continue
        seen = surface[i] == VICINITY
        if beside(i, lists, place, body, seen, recovery) != seen:
            continue
        if seen:
            packed = recovery.own + packing(i, lists, place, scale, weight, recovery.cut)
            n[i] += recovery.thin * (n0 * packed / whole - n[i])
        else:
            n[i] += pull * (n0 * c[i] - n[i])
