"""The elastic energy of the water; no step needs it."""

import math

from parsim.machine.jit import kernel


@kernel
def elastic(at, n, mass, n0, sound2, out):
    """Elastic energy, J, of each fluid particle `at`: what the pair forces put into n; out (n,).

    The integral of p / (rho0 s) over s = n / n0 of the state: c0^2 / 7 ((s^7 - 1) / 7 - ln s). `mass` of a particle,
    kg; sound2 = c0^2, m2/s2.
    """
    for row in range(at.size):
        s = n[at[row]] / n0
        s2 = s * s
        out[row] = mass * sound2 / 7.0 * ((s2 * s2 * s2 * s - 1.0) / 7.0 - math.log(s))
