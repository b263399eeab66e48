"""Bodies taken over into the table of the kernels at the start of a step, and handed back at its end."""

from parsim.geometry.rotation import matrix, scaled
from parsim.machine.jit import kernel
from parsim.solid.table import (
    ALONE,
    GIVEN,
    HELD,
    INERTIA,
    INVERSE,
    LIGHT,
    LOAD,
    MEAN,
    MOMENTUM,
    POSITION,
    PULL,
    QUATERNION,
    ROLE,
    SPIN,
    TIED,
    TOTAL,
    TURN,
    VELOCITY,
    quaternion_of,
    three,
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
            m[b, TOTAL + k] = m[b, MEAN + k] = m[b, TIED + k] = m[b, LOAD + k] = m[b, PULL + k] = 0.0


@kernel
def finish(m, dt, pose, acceleration, angular, contact, pull):
    """Hand pose, velocity and spin back, with the accelerations and the mean loads of the step `dt`, s, by contacts and
    by springs to the world."""
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
            contact[b, k], pull[b, k] = m[b, TOTAL + k] / dt, m[b, TIED + k] / dt
