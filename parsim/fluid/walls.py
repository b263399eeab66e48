"""The pressure that walls and bodies take from the water beside them, for every scheme."""

import math

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import prange, rows
from parsim.particles.state import SHUT_IN


@rows
def boundary_pressure(at, lists, which, place, acceleration, weight, fall, p):
    """Pressure of boundary samples from the fluid they see (Adami, Hu & Adams 2012, eq. 27), by weights W / r2.

    With the weights of the pressure force, what water adds to the inertia of a body is symmetric and never negative.
    Walls do not pull, or water gets in; bodies do, or noise lifts them. Water that is shut in has no part in it.
    `which`: body and class of each particle; `fall`: gravity, m/s2, by component, density.
    """
    start, middle, index = lists.start, lists.middle, lists.index
    body, surface = which
    x, y, z = place
    ax, ay, az = acceleration
    gx, gy, gz, density = fall
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi = x[i], y[i], z[i]
        every = 0.0
        total = 0.0
        hx, hy, hz = density * (gx - ax[i]), density * (gy - ay[i]), density * (gz - az[i])
        for t in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[t]
            dx, dy, dz = xi - x[j], yi - y[j], zi - z[j]
            r2 = dx * dx + dy * dy + dz * dz
            _, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            g = 0.0 if surface[j] == SHUT_IN else g
            every += g
            total += g * (p[j] + hx * dx + hy * dy + hz * dz)
        mean = total / every if every > 0.0 else 0.0
        p[i] = mean if body[i] >= 0 else max(mean, 0.0)
