"""Bounds of the speeds and of the frequencies of bodies within a step."""

import math

from parsim.machine.jit import inlined, kernel
from parsim.solid.table import GIVEN, HASTE, HELD, INVERSE, LIGHT, RADIUS, RATE, ROLE, SPIN, VELOCITY, three

MARGIN = 1.5  # a body that is hit may become faster than any was before


@kernel
def length(v):
    """Length of a vector of three."""
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def speed_of(m, b, dt):
    """Bound of the speed of any point of body `b` within `dt`, s, without contacts, m/s, its HASTE known."""
    inverse = three(m, b, INVERSE)
    faster = dt * length(three(m, b, GIVEN + 3)) * max(inverse[0], inverse[1], inverse[2])
    spin = length(three(m, b, SPIN)) + faster
    return (
        m[b, HASTE]
        + length(three(m, b, VELOCITY))
        + dt * length(three(m, b, GIVEN)) * m[b, LIGHT]
        + m[b, RADIUS] * spin
    )


@kernel
def bound_of_speed(m, dt):
    """Largest speed, m/s, that a point of anything can have within `dt`, s, before anything is hit."""
    largest = 0.0
    for b in range(len(m)):
        if m[b, ROLE] != HELD:
            largest = max(largest, speed_of(m, b, dt))
    return largest


@inlined
def add_rate(m, a, b, n, square):
    """Add to the RATE of the bodies of a pair, b < 0: a wall, what moves at the square of a frequency, 1/s2, along `n`.

    Row sums of the matrix of k/m* n n: see `rates.longest_step`.
    """
    u, v, w = abs(n[0]), abs(n[1]), abs(n[2])
    for body in (a, b):
        if body >= 0:
            m[body, RATE] += square * u * (u + v + w)
            m[body, RATE + 1] += square * v * (u + v + w)
            m[body, RATE + 2] += square * w * (u + v + w)
