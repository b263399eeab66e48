"""Accelerations of bodies with the inertia that the water adds, solved at once: stable however light they are."""

import math
from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import matrix, scaled
from parsim.machine.jit import kernel


class Given(NamedTuple):
    """Mass (nb,), moments of inertia (nb, 3), quaternion (nb, 4), load of contacts and springs (nb, 6), spin (nb, 3);
    free (nb, 6), 0 where a component of the acceleration is given, and what it is there, given (nb, 6); of what hangs
    by a rod the unit vector along it (nb, 3), else 0, and its acceleration along that, inwards (nb,)."""

    mass: np.ndarray
    inertia: np.ndarray
    quaternion: np.ndarray
    contact: np.ndarray
    spin: np.ndarray
    free: np.ndarray
    given: np.ndarray
    rod: np.ndarray
    inwards: np.ndarray


@kernel
def accelerate_bodies(load, added, bodies, gravity, acceleration, angular, change):
    """Solve (m + added) a = load + added a0 + gravity + contacts - gyroscopic torque for every body.

    a0, then a: `acceleration`, `angular` (nb, 3); their difference: `change` (nb, 6), the `load` then less by added
    times that. By Cholesky, for its bits are the same everywhere.
    """
    mass, inertia, quaternion, contact, spin, free, given, rod, inwards = bodies
    m, water, rhs, along = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros(6), np.zeros(6)
    for b in range(mass.size):
        q = quaternion[b]
        turn, own = matrix((q[0], q[1], q[2], q[3])), (inertia[b, 0], inertia[b, 1], inertia[b, 2])
        unpack(added[b], water)
        wx, wy, wz = spin[b]
        hx, hy, hz = scaled(turn, own, wx, wy, wz)
        gyro = (wy * hz - wz * hy, wz * hx - wx * hz, wx * hy - wy * hx)
        for a in range(6):
            total = load[b, a] + contact[b, a] + (mass[b] * gravity[a] if a < 3 else -gyro[a - 3])
            for c in range(6):
                total += water[a, c] * (acceleration[b, c] if c < 3 else angular[b, c - 3])
            rhs[a] = total
        m[:] = water
        add_inertia(mass[b], turn, own, m)
        for a in range(6):
            if free[b, a] == 0.0 and given[b, a] != 0.0:
                for c in range(6):
                    rhs[c] -= m[c, a] * given[b, a]
        for a in range(6):
            if free[b, a] == 0.0:
                rhs[a] = given[b, a]
        factor_held(m, free[b])
        solve(m, rhs)
        soft = yielding(m, rod[b], free[b], along)
        if soft > 0.0:
            off = inwards[b]
            for a in range(3):
                off += rod[b, a] * rhs[a]
            for a in range(6):
                rhs[a] -= off / soft * along[a]
        for a in range(3):
            change[b, a], change[b, 3 + a] = rhs[a] - acceleration[b, a], rhs[3 + a] - angular[b, a]
            acceleration[b, a], angular[b, a] = rhs[a], rhs[3 + a]
        for a in range(6):
            for c in range(6):
                load[b, a] -= water[a, c] * change[b, c]


@kernel
def mobilities(added, bodies, out):
    """What a load of one, N or N m, changes of the accelerations of `accelerate_bodies`: out (nb, 6, 6), symmetric.

    Components that are given do not change, nor what is along a rod. `added` as there.
    """
    mass, inertia, quaternion, _, _, free, _, rod, _ = bodies
    m, rhs, along = np.zeros((6, 6)), np.zeros(6), np.zeros(6)
    for b in range(mass.size):
        q = quaternion[b]
        unpack(added[b], m)
        add_inertia(mass[b], matrix((q[0], q[1], q[2], q[3])), (inertia[b, 0], inertia[b, 1], inertia[b, 2]), m)
        factor_held(m, free[b])
        soft = yielding(m, rod[b], free[b], along)
        for c in range(6):
            rhs[:] = 0.0
            rhs[c] = free[b, c]
            solve(m, rhs)
            if soft > 0.0:
                off = rod[b, 0] * rhs[0] + rod[b, 1] * rhs[1] + rod[b, 2] * rhs[2]
                for a in range(6):
                    rhs[a] -= off / soft * along[a]
            out[b, :, c] = rhs


@kernel
def unpack(packed, m):
    """Fill m (6, 6), symmetric, with the rows (21,) of its upper half."""
    k = 0
    for a in range(6):
        for c in range(a, 6):
            m[a, c] = m[c, a] = packed[k]
            k += 1


@kernel
def add_inertia(mass, turn, own, m):
    """Add to m (6, 6) a body's mass, kg, and moments of inertia `own`, kg m2, that is turned by the matrix `turn`."""
    unit = np.eye(3)
    for a in range(3):
        m[a, a] += mass
        x, y, z = scaled(turn, own, unit[a, 0], unit[a, 1], unit[a, 2])
        m[3, 3 + a], m[4, 3 + a], m[5, 3 + a] = m[3, 3 + a] + x, m[4, 3 + a] + y, m[5, 3 + a] + z


@kernel
def factor_held(m, free):
    """`factor` of m (6, 6) in which components that are not `free` (6,) are uncoupled from the others."""
    for a in range(6):
        if free[a] == 0.0:
            m[a, :] = 0.0
            m[:, a] = 0.0
            m[a, a] = 1.0
    factor(m)


@kernel
def yielding(m, rod, free, along):
    """Acceleration along the `rod` (3,) that a force of one along it gives, 1/kg; zero without one.

    m: a factor; along (6,): all of the acceleration.
    """
    if rod[0] == 0.0 and rod[1] == 0.0 and rod[2] == 0.0:
        return 0.0
    soft = 0.0
    for a in range(6):
        along[a] = rod[a] * free[a] if a < 3 else 0.0
    solve(m, along)
    for a in range(3):
        soft += rod[a] * along[a]
    return soft


@kernel
def factor(m):
    """The Cholesky factor of m (n, n), symmetric and positive, in its place, below the diagonal."""
    n = len(m)
    for a in range(n):
        for c in range(a + 1):
            total = m[a, c]
            for e in range(c):
                total -= m[a, e] * m[c, e]
            m[a, c] = math.sqrt(total) if a == c else total / m[c, c]


@kernel
def solve(m, x):
    """Solve for x (n,), in its place, the equations whose matrix has the Cholesky factor m (n, n)."""
    n = x.size
    for a in range(n):
        for e in range(a):
            x[a] -= m[a, e] * x[e]
        x[a] /= m[a, a]
    for a in range(n - 1, -1, -1):
        for e in range(a + 1, n):
            x[a] -= m[e, a] * x[e]
        x[a] /= m[a, a]
