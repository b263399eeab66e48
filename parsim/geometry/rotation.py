"""Orientation of rigid bodies: quaternions (w, x, y, z) that turn body axes into global axes, and free rotation."""

import math

import numpy as np

from parsim.machine.jit import kernel

_ROUNDS = 20  # of the midpoint iteration at most; three do for |spin| dt of 1e-3


@kernel
def turned(a, b):
    """Product of the quaternions `a` and `b` (tuples of 4): first turned by b, then by a."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


@kernel
def turn_of(x, y, z):
    """Quaternion of the turn by the rotation vector (x, y, z), rad: (cos a/2, sin a/2 axis)."""
    angle = math.sqrt(x * x + y * y + z * z)
    share = 0.5 if angle < 1e-9 else math.sin(0.5 * angle) / angle
    return math.cos(0.5 * angle), share * x, share * y, share * z


@kernel
def unit(q):
    """The quaternion `q` (tuple of 4) scaled to length one."""
    length = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return q[0] / length, q[1] / length, q[2] / length, q[3] / length


@kernel
def matrix(q):
    """Rotation matrix of the unit quaternion `q`, nine numbers by rows; its columns are the body axes."""
    w, x, y, z = q
    return (
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    )


@kernel
def to_global(m, x, y, z):
    """The body-frame vector (x, y, z) in global axes; `m` as from `matrix`."""
    return m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z, m[6] * x + m[7] * y + m[8] * z


@kernel
def to_body(m, x, y, z):
    """The global vector (x, y, z) in body axes; `m` as from `matrix`."""
    return m[0] * x + m[3] * y + m[6] * z, m[1] * x + m[4] * y + m[7] * z, m[2] * x + m[5] * y + m[8] * z


@kernel
def scaled(m, s, x, y, z):
    """R diag(s) R^T (x, y, z): momentum from spin with s the inertia, spin from momentum with s its inverse."""
    x, y, z = to_body(m, x, y, z)
    return to_global(m, s[0] * x, s[1] * y, s[2] * z)


@kernel
def free_turn(q, momentum, inverse, dt):
    """Quaternion of a free rotor after `dt`, s; `momentum` global angular momentum (3), `inverse` 1/inertia (3).

    The turn over dt is about the body spin of the middle of the step, w = I^-1 exp(-w dt/2) R^T L, found by
    iteration. L is kept exactly, the energy without drift (a symmetric scheme); of order two; exact for a turn about
    a principal axis and for equal inertias. Quaternion update: Mellado 2021, eq. 4.57, misprint corrected. 0.2 us.
    """
    m = matrix(q)
    lx, ly, lz = to_body(m, momentum[0], momentum[1], momentum[2])
    wx, wy, wz = inverse[0] * lx, inverse[1] * ly, inverse[2] * lz
    for _ in range(_ROUNDS):
        half = matrix(turn_of(0.5 * dt * wx, 0.5 * dt * wy, 0.5 * dt * wz))
        x, y, z = to_body(half, lx, ly, lz)
        x, y, z = inverse[0] * x, inverse[1] * y, inverse[2] * z
        change = abs(x - wx) + abs(y - wy) + abs(z - wz)
        wx, wy, wz = x, y, z
        if change <= 1e-14 * (abs(x) + abs(y) + abs(z)):
            break
    return unit(turned(q, turn_of(dt * wx, dt * wy, dt * wz)))


@kernel
def _matrices(quaternion, out):
    for b in range(len(quaternion)):
        q = quaternion[b]
        m = matrix((q[0], q[1], q[2], q[3]))
        for k in range(9):
            out[b, k // 3, k % 3] = m[k]


def matrices(quaternion):
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4): global vector = matrix times body vector."""
    out = np.empty((len(quaternion), 3, 3))
    _matrices(quaternion, out)
    return out


def from_angles(angles):
    """Quaternion (4,) of turns about the fixed x, then y, then z axis by `angles` (3,), degrees."""
    q = (1.0, 0.0, 0.0, 0.0)
    for axis in range(3):
        turn = [0.0, 0.0, 0.0]
        turn[axis] = math.radians(angles[axis])
        q = turned(turn_of(*turn), q)
    return np.array(unit(q))
