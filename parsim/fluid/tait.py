"""The equation of state of water, p = stiffness (s^7 - 1), turned round."""

import numpy as np

from parsim.machine.jit import kernel


@kernel
def seventh_roots(y):
    """Seventh roots of 1 + y, y (n,) >= 0 and small, by Newton: no pow, whose last bit depends on the library."""
    out = np.empty(y.size)
    for i in range(y.size):
        s = 1.0 + y[i] / 7.0
        for _ in range(4):
            s2 = s * s
            s6 = s2 * s2 * s2
            s -= (s6 * s - 1.0 - y[i]) / (7.0 * s6)
        out[i] = s
    return out
