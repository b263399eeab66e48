"""States at the interface of two particles, and of water and what is solid: approximate solutions of Riemann problems.

Both take the equation of state of Tait (Mellado 2021, eq. 5.17) to the second order in p over rho0 c0^2, which is at
most some hundredths in the model's water. Of the jump of pressure that comes of the speed of approach they take the
share 3 v / c0 (Zhang, Hu & Adams 2017) or a least one: all of it brakes what strains, and bodies that turn.
"""

import math

from parsim.machine.jit import kernel

_OF_WALLS = 0.3  # of the least share of the jump between particles of water: more brakes bodies that turn


@kernel
def minmod(a, b):
    """The smaller of two numbers of one sign, zero of two of opposite signs."""
    return 0.5 * (math.copysign(1.0, a) + math.copysign(1.0, b)) * min(abs(a), abs(b))


@kernel
def interface(left, right, water):
    """Pressure, Pa, velocity along the pair, m/s, and density, kg/m3, between `left` and `right`, (p, velocity) each.

    The solver in primitive variables (Toro 2009, section 9.3), with the impedance of the mean pressure. `water`:
    density, kg/m3, modulus rho0 c0^2, Pa, and impedance rho0 c0, kg/(m2 s), at no pressure; of the jump of pressure the
    least share, and by how much that grows with the speed of approach, s/m.
    """
    (pl, nl), (pr, nr), (density, modulus, impedance, least, ease) = left, right, water
    mean = 0.5 * (pl + pr)
    z = impedance * (1.0 + 4.0 * mean / modulus)
    p = mean + 0.5 * z * (nl - nr) * min(max(ease * (nl - nr), least), 1.0)
    x = p / modulus
    return p, 0.5 * (nl + nr) + 0.5 * (pl - pr) / z, density * (1.0 + x - 3.0 * x * x)


@kernel
def wall_pressure(p, way, toward, normal, meeting, slope, water):
    """Pressure, Pa, between water at p and a sample that is `way` from it, m: a partial Riemann problem.

    `toward`: what the sample's acceleration takes off gravity, as (g - a) . way, m2/s2; `normal` of the sample into the
    water; `meeting`: velocity of the sample less that of the water, m/s; `slope`: that of the velocity of the water,
    times `way`, m/s. The velocity of the water is reconstructed at the wall, as if the wall mirrored it. A sample whose
    face looks another way only bears the pressure that is there.
    """
    density, modulus, impedance, least, ease = water
    away = -(way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2])
    away /= math.sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2])
    across = meeting[0] * normal[0] + meeting[1] * normal[1] + meeting[2] * normal[2]
    along = slope[0] * normal[0] + slope[1] * normal[1] + slope[2] * normal[2]
    z = impedance * (1.0 + 4.0 * p / modulus)
    jump = across - minmod(across, along - across)
    z *= min(2.0 * max(away, 0.0), 1.0) * min(max(ease * jump, _OF_WALLS * least), 1.0)
    return p + 0.5 * density * toward + z * jump
