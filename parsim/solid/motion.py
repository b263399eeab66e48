"""Motion of rigid bodies: position Verlet, of order two, exact for constant force and free rotation.

A step drifts by half of it, finds the forces there, kicks, drifts the other half. A body that touches nothing takes a
step of the water at once.
"""

import math

from parsim.geometry.rotation import free_turn, matrix, scaled
from parsim.machine.jit import kernel
from parsim.solid.table import (
    ALONE,
    DRIVEN,
    GIVEN,
    HELD,
    INERTIA,
    INVERSE,
    INVOLVED,
    LIGHT,
    LOAD,
    LOSS,
    MEAN,
    MOMENTUM,
    POSITION,
    QUATERNION,
    RADIUS,
    ROLE,
    SPIN,
    TOTAL,
    TURN,
    VELOCITY,
    quaternion_of,
    three,
    turn_at,
)


@kernel
def begin(m, pose, mass, held, water, gravity, planar, weight):
    """Take over pose, velocity and spin of the bodies and set all that follows from them in the table `m`.

    `water` (nb, 6): constant load; `held` (nb,): bodies that do not move; `weight` (nb, 6) receives gravity's load.
    In 2D only x, z and turns about y remain. `pose`: position, quaternion, velocity and spin of all bodies.
    """
    position, quaternion, velocity, spin = pose
    for b in range(mass.size):
        still = held[b]
        m[b, ROLE], m[b, LIGHT] = (HELD, 0.0) if still else (ALONE, 1.0 / mass[b])
        for a in range(4):
            m[b, QUATERNION + a] = quaternion[b, a]
        for a in range(3):
            off, no_turn = still or (planar and a == 1), still or (planar and a != 1)
            weight[b, a], weight[b, 3 + a] = mass[b] * gravity[a], 0.0
            m[b, POSITION + a] = position[b, a]
            m[b, VELOCITY + a] = 0.0 if off else velocity[b, a]
            m[b, SPIN + a] = 0.0 if no_turn else spin[b, a]
            m[b, GIVEN + a] = 0.0 if off else water[b, a] + weight[b, a]
            m[b, GIVEN + 3 + a] = 0.0 if no_turn else water[b, 3 + a]
            m[b, INVERSE + a] = 0.0 if still else 1.0 / m[b, INERTIA + a]
        t = matrix(quaternion_of(m, b))
        for k in range(9):
            m[b, TURN + k] = t[k]
        w = three(m, b, SPIN)
        h = scaled(t, three(m, b, INERTIA), w[0], w[1], w[2])
        m[b, MOMENTUM], m[b, MOMENTUM + 1], m[b, MOMENTUM + 2] = h
    for b in range(len(m)):
        for k in range(6):
            m[b, TOTAL + k] = m[b, MEAN + k] = 0.0


@kernel
def finish(m, dt, pose, acceleration, angular, contact):
    """Hand pose, velocity and spin back, with the accelerations and the mean contact load of the step `dt`, s."""
    position, quaternion, velocity, spin = pose
    for b in range(len(position)):
        for a in range(3):
            acceleration[b, a] = (m[b, VELOCITY + a] - velocity[b, a]) / dt
            angular[b, a] = (m[b, SPIN + a] - spin[b, a]) / dt
            position[b, a], velocity[b, a] = m[b, POSITION + a], m[b, VELOCITY + a]
            spin[b, a] = m[b, SPIN + a]
        for a in range(4):
            quaternion[b, a] = m[b, QUATERNION + a]
        for k in range(6):
            contact[b, k] = m[b, TOTAL + k] / dt


@kernel
def _update_spin(m, b):
    h = three(m, b, MOMENTUM)
    w = scaled(turn_at(m, b), three(m, b, INVERSE), h[0], h[1], h[2])
    m[b, SPIN], m[b, SPIN + 1], m[b, SPIN + 2] = w


@kernel
def drift(m, b, dt):
    """Move body `b` freely over `dt`, s."""
    for a in range(3):
        m[b, POSITION + a] += dt * m[b, VELOCITY + a]
    momentum = three(m, b, MOMENTUM)
    if momentum[0] == 0.0 and momentum[1] == 0.0 and momentum[2] == 0.0:
        return
    q = free_turn(quaternion_of(m, b), momentum, three(m, b, INVERSE), dt)
    t = matrix(q)
    for k in range(4):
        m[b, QUATERNION + k] = q[k]
    for k in range(9):
        m[b, TURN + k] = t[k]
    _update_spin(m, b)


@kernel
def kick(m, b, dt):
    """Change the momenta of body `b` by its loads over `dt`, s."""
    for a in range(3):
        m[b, VELOCITY + a] += dt * m[b, LIGHT] * (m[b, GIVEN + a] + m[b, LOAD + a])
        m[b, MOMENTUM + a] += dt * (m[b, GIVEN + 3 + a] + m[b, LOAD + 3 + a])
    for k in range(6):
        m[b, TOTAL + k] += dt * m[b, LOAD + k]
    _update_spin(m, b)


@kernel
def clear_loads(m):
    """Forget the contact loads of all rows."""
    for b in range(len(m)):
        for k in range(6):
            m[b, LOAD + k] = m[b, LOSS + k] = 0.0


@kernel
def alone(m, dt):
    """Take the bodies that touch nothing over the whole step `dt`, s, at once. 0.5 us each."""
    for b in range(len(m)):
        if m[b, ROLE] == ALONE:
            drift(m, b, 0.5 * dt)
            kick(m, b, dt)
            drift(m, b, 0.5 * dt)


@kernel
def drift_involved(m, dt):
    """Move what is driven and all bodies that may touch something over `dt`, s."""
    for b in range(len(m)):
        if m[b, ROLE] == INVOLVED or m[b, ROLE] == DRIVEN:
            drift(m, b, dt)


@kernel
def foresee(m, dt):
    """Set the MEAN of these bodies and of what is driven for a kick over `dt`, s, by the present loads."""
    for b in range(len(m)):
        if m[b, ROLE] == DRIVEN:
            for a in range(3):
                m[b, MEAN + a], m[b, MEAN + 3 + a] = m[b, VELOCITY + a], m[b, SPIN + a]
        elif m[b, ROLE] == INVOLVED:
            t, u = three(m, b, GIVEN + 3), three(m, b, LOAD + 3)
            turn = scaled(turn_at(m, b), three(m, b, INVERSE), t[0] + u[0], t[1] + u[1], t[2] + u[2])
            for a in range(3):
                push = m[b, LIGHT] * (m[b, GIVEN + a] + m[b, LOAD + a])
                m[b, MEAN + a] = m[b, VELOCITY + a] + 0.5 * dt * push
                m[b, MEAN + 3 + a] = m[b, SPIN + a] + 0.5 * dt * turn[a]


@kernel
def kick_involved(m, dt):
    """Kick these bodies, their MEAN known; returns (energy dissipated, work on them of what is driven), J."""
    lost, work = 0.0, 0.0
    for b in range(len(m)):
        for k in range(6):
            lost -= dt * m[b, LOSS + k] * m[b, MEAN + k]
        if m[b, ROLE] == INVOLVED:
            kick(m, b, dt)
        elif m[b, ROLE] == DRIVEN:
            for k in range(6):
                work -= dt * m[b, LOAD + k] * m[b, MEAN + k]
    return lost, work


@kernel
def length(v):
    """Length of a vector of three."""
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def speed_of(m, b, dt):
    """Bound of the speed of any point of body `b` within `dt`, s, without contacts, m/s."""
    inverse = three(m, b, INVERSE)
    faster = dt * length(three(m, b, GIVEN + 3)) * max(inverse[0], inverse[1], inverse[2])
    spin = length(three(m, b, SPIN)) + faster
    return length(three(m, b, VELOCITY)) + dt * length(three(m, b, GIVEN)) * m[b, LIGHT] + m[b, RADIUS] * spin


@kernel
def bound_of_speed(m, dt):
    """Largest speed, m/s, that a point of anything can have within `dt`, s, before anything is hit."""
    largest = 0.0
    for b in range(len(m)):
        if m[b, ROLE] != HELD:
            largest = max(largest, speed_of(m, b, dt))
    return largest
