"""Bounds of the speeds of bodies within a step."""

import math

from parsim.machine.jit import kernel
from parsim.solid.table import GIVEN, HASTE, HELD, INVERSE, LIGHT, RADIUS, ROLE, SPIN, VELOCITY, three


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
