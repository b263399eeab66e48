"""Where all bodies drift to, how far they reach, how fast they are, and their kinetic energy."""

import math

import numpy as np

from parsim.geometry.rotation import free_turn, matrix, scaled
from parsim.machine.jit import kernel
from parsim.solid.shapes.kernels import reach


@kernel
def reaches(forms, turn):
    """How far bodies turned by `turn` (b, 3, 3) reach along the axes of space, to the farther side, m, (b, 3)."""
    out = np.empty((len(turn), 3))
    for b in range(len(turn)):
        for a in range(3):
            x, y, z = turn[b, a, 0], turn[b, a, 1], turn[b, a, 2]
            out[b, a] = max(reach(forms, b, (x, y, z)), reach(forms, b, (-x, -y, -z)))
    return out


@kernel
def drift(mass, inertia, velocity, spin, dt, position, quaternion):
    """Free motion of all bodies over `dt`: position and quaternion are changed in place."""
    for b in range(mass.size):
        q = (quaternion[b, 0], quaternion[b, 1], quaternion[b, 2], quaternion[b, 3])
        own = (inertia[b, 0], inertia[b, 1], inertia[b, 2])
        momentum = scaled(matrix(q), own, spin[b, 0], spin[b, 1], spin[b, 2])
        q = free_turn(q, momentum, (1.0 / own[0], 1.0 / own[1], 1.0 / own[2]), dt)
        quaternion[b, 0], quaternion[b, 1], quaternion[b, 2], quaternion[b, 3] = q
        for a in range(3):
            position[b, a] += dt * velocity[b, a]


@kernel
def largest_speed(radius, velocity, spin):
    """Largest |v| + |w| R over all bodies, m/s, infinite where one is not a number."""
    largest = 0.0
    for b in range(len(radius)):
        v, w = velocity[b], spin[b]
        speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        speed += radius[b] * math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
        if not speed < np.inf:
            return np.inf
        largest = max(largest, speed)
    return largest


@kernel
def kinetic(mass, inertia, quaternion, velocity, spin):
    """Kinetic energy of all bodies, in the order of the bodies."""
    energy = 0.0
    for b in range(mass.size):
        m = matrix((quaternion[b, 0], quaternion[b, 1], quaternion[b, 2], quaternion[b, 3]))
        w, v = spin[b], velocity[b]
        x, y, z = scaled(m, (inertia[b, 0], inertia[b, 1], inertia[b, 2]), w[0], w[1], w[2])
        energy += 0.5 * mass[b] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        energy += 0.5 * (x * w[0] + y * w[1] + z * w[2])
    return energy
