"""Motion of rigid bodies: position Verlet, of order two, exact for constant force and free rotation.

A step drifts by half of it, finds the forces there, kicks, drifts the other half. A body that touches nothing takes a
step of the water at once. Joints take part exactly: what hangs by a rod drifts along the circle that it would follow
without forces, and kicks act across the rod; locked axes take no kick.
"""

import math

import numpy as np

from parsim.geometry.rotation import free_turn, matrix, scaled, turn_of, turned, unit
from parsim.machine.jit import kernel
from parsim.solid.table import (
    ALONE,
    DRIVEN,
    FREE,
    GIVEN,
    INERTIA,
    INVERSE,
    INVOLVED,
    LIGHT,
    LOAD,
    LOSS,
    MEAN,
    MOMENTUM,
    POSITION,
    PULL,
    QUATERNION,
    ROD,
    ROLE,
    RUSH,
    SPIN,
    TIED,
    TOTAL,
    TURN,
    VELOCITY,
    along_rod,
    hangs,
    is_tied,
    quaternion_of,
    three,
    turn_at,
    turns_freely,
)

_MIDPOINTS = 4  # rounds of the midpoint rule


@kernel
def _update_spin(m, b):
    h = three(m, b, MOMENTUM)
    w = scaled(turn_at(m, b), three(m, b, INVERSE), h[0], h[1], h[2])
    m[b, SPIN], m[b, SPIN + 1], m[b, SPIN + 2] = w


@kernel
def drift(m, b, dt):
    """Move body `b` freely over `dt`, s."""
    if hangs(m, b):
        _swing(m, b, dt)
    else:
        for a in range(3):
            m[b, POSITION + a] += dt * m[b, VELOCITY + a]
    if turns_freely(m, b):
        momentum = three(m, b, MOMENTUM)
        if momentum != (0.0, 0.0, 0.0):
            stand(m, b, free_turn(quaternion_of(m, b), momentum, three(m, b, INVERSE), dt))
            _update_spin(m, b)
    else:
        _turn_guided(m, b, dt)
        update_momentum(m, b)


@kernel
def stand(m, b, q):
    """Turn body `b` to the quaternion `q`."""
    t = matrix(q)
    for k in range(4):
        m[b, QUATERNION + k] = q[k]
    for k in range(9):
        m[b, TURN + k] = t[k]


@kernel
def _turn_guided(m, b, dt):
    """Turn a body that may turn about some axes of space only.

    About two of them its momentum stays, and its spin does not, as the moments about them change: midpoint rule.
    """
    start, h = quaternion_of(m, b), three(m, b, MOMENTUM)
    w = three(m, b, SPIN)
    two = m[b, LIGHT] > 0.0 and m[b, FREE + 3] + m[b, FREE + 4] + m[b, FREE + 5] == 2.0
    if two:
        for _ in range(_MIDPOINTS):
            stand(m, b, unit(turned(turn_of(0.5 * dt * w[0], 0.5 * dt * w[1], 0.5 * dt * w[2]), start)))
            w = _guided_turn(m, b, h[0], h[1], h[2])
    stand(m, b, unit(turned(turn_of(dt * w[0], dt * w[1], dt * w[2]), start)))
    if two:
        m[b, SPIN], m[b, SPIN + 1], m[b, SPIN + 2] = _guided_turn(m, b, h[0], h[1], h[2])


@kernel
def update_momentum(m, b):
    """Bring the angular momentum of body `b` in line with its spin."""
    w = three(m, b, SPIN)
    h = scaled(turn_at(m, b), three(m, b, INERTIA), w[0], w[1], w[2])
    m[b, MOMENTUM], m[b, MOMENTUM + 1], m[b, MOMENTUM + 2] = h


@kernel
def _swing(m, b, dt):
    """Move the centre of body `b` along the great circle around its pivot that it would follow without forces."""
    e, v, rod = along_rod(m, b), three(m, b, VELOCITY), m[b, ROD + 3]
    along = v[0] * e[0] + v[1] * e[1] + v[2] * e[2]
    x, y, z = v[0] - along * e[0], v[1] - along * e[1], v[2] - along * e[2]
    speed = math.sqrt(x * x + y * y + z * z)
    if speed == 0.0:
        return
    angle, x, y, z = speed * dt / rod, x / speed, y / speed, z / speed
    half = math.sin(0.5 * angle)
    c, s = 1.0 - 2.0 * half * half, math.sin(angle)
    for a, (out, across) in enumerate(((e[0], x), (e[1], y), (e[2], z))):
        m[b, POSITION + a] = m[b, ROD + a] + rod * (c * out + s * across)
        m[b, VELOCITY + a] = speed * (c * across - s * out)


@kernel
def answer(m, b, f):
    """(acceleration (3,), m/s2, angular acceleration (3,), rad/s2) of body `b` at rest by the load `f` (6,), N, N m.

    Joints take from the load what they do not let it do.
    """
    x, y, z = f[0], f[1], f[2]
    if hangs(m, b):
        e = along_rod(m, b)
        along = x * e[0] + y * e[1] + z * e[2]
        x, y, z = x - along * e[0], y - along * e[1], z - along * e[2]
    light = m[b, LIGHT]
    a = (light * m[b, FREE] * x, light * m[b, FREE + 1] * y, light * m[b, FREE + 2] * z)
    if turns_freely(m, b):
        return a, scaled(turn_at(m, b), three(m, b, INVERSE), f[3], f[4], f[5])
    return a, _guided_turn(m, b, f[3], f[4], f[5])


@kernel
def _guided_turn(m, b, x, y, z):
    """Angular acceleration of a body that may turn about some axes of space only, by the torque (x, y, z), N m."""
    if m[b, LIGHT] == 0.0:
        return 0.0, 0.0, 0.0
    t, own = turn_at(m, b), three(m, b, INERTIA)
    p, q, r = m[b, FREE + 3], m[b, FREE + 4], m[b, FREE + 5]
    (xx, xy, xz), (_, yy, yz) = scaled(t, own, 1.0, 0.0, 0.0), scaled(t, own, 0.0, 1.0, 0.0)
    zz = scaled(t, own, 0.0, 0.0, 1.0)[2]
    xx, yy, zz = (xx if p else 1.0), (yy if q else 1.0), (zz if r else 1.0)
    xy, xz, yz, x, y, z = xy * p * q, xz * p * r, yz * q * r, x * p, y * q, z * r
    a, b_, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - yy * xz  # cofactors
    scale = 1.0 / (xx * a + xy * b_ + xz * c)
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    return scale * (a * x + b_ * y + c * z), scale * (b_ * x + d * y + e * z), scale * (c * x + e * y + f * z)


@kernel
def kick(m, b, dt):
    """Change the momenta of body `b` by its loads over `dt`, s."""
    if is_tied(m, b):
        _kick_tied(m, b, dt)
    else:
        for a in range(3):
            m[b, VELOCITY + a] += dt * m[b, LIGHT] * (m[b, GIVEN + a] + m[b, LOAD + a])
            m[b, MOMENTUM + a] += dt * (m[b, GIVEN + 3 + a] + m[b, LOAD + 3 + a])
        _update_spin(m, b)


@kernel
def _kick_tied(m, b, dt):
    a, w = answer(m, b, loads_on(m, b))
    for k in range(3):
        m[b, VELOCITY + k] += dt * a[k]
    if turns_freely(m, b):
        for k in range(3):
            m[b, MOMENTUM + k] += dt * (m[b, GIVEN + 3 + k] + m[b, LOAD + 3 + k])
        _update_spin(m, b)
        return
    for k in range(3):
        m[b, SPIN + k] += dt * w[k]
    update_momentum(m, b)


@kernel
def loads_on(m, b):
    """Force and torque on body `b` now, six numbers."""
    f, g, t, u = three(m, b, GIVEN), three(m, b, LOAD), three(m, b, GIVEN + 3), three(m, b, LOAD + 3)
    return f[0] + g[0], f[1] + g[1], f[2] + g[2], t[0] + u[0], t[1] + u[1], t[2] + u[2]


@kernel
def clear_loads(m, rows):
    """Forget the contact loads of these rows, but for what they do to the centres."""
    for b in rows:
        for a in range(3):
            m[b, RUSH + a] = m[b, LIGHT] * (m[b, GIVEN + a] + m[b, LOAD + a])
        for k in range(6):
            m[b, LOAD + k] = m[b, LOSS + k] = m[b, PULL + k] = 0.0


@kernel
def alone(m, dt):
    """Take the bodies that touch nothing over the whole step `dt`, s, at once. 0.5 us each."""
    for b in range(len(m)):
        if m[b, ROLE] == ALONE:
            drift(m, b, 0.5 * dt)
            kick(m, b, dt)
            drift(m, b, 0.5 * dt)


@kernel
def drift_involved(m, rows, dt):
    """Move what is driven and the bodies that may touch something over `dt`, s; rows of the table."""
    for b in rows:
        if m[b, ROLE] == INVOLVED or m[b, ROLE] == DRIVEN:
            drift(m, b, dt)


@kernel
def driven_now(m):
    """Of what is driven its row, place, quaternion, rotation matrix, angular momentum and spin, by columns."""
    count = 0
    for b in range(len(m)):
        count += m[b, ROLE] == DRIVEN
    out, row = np.empty((count, 23)), 0
    for b in range(len(m)):
        if m[b, ROLE] == DRIVEN:
            out[row, 0], out[row, 1:4] = b, m[b, POSITION : POSITION + 3]
            out[row, 4:20] = m[b, QUATERNION : MOMENTUM + 3]
            out[row, 20:23] = m[b, SPIN : SPIN + 3]
            row += 1
    return out


@kernel
def set_back(m, driven):
    """Bring what is driven back to where it was."""
    for row in range(len(driven)):
        b = int(driven[row, 0])
        m[b, POSITION : POSITION + 3], m[b, SPIN : SPIN + 3] = driven[row, 1:4], driven[row, 20:23]
        m[b, QUATERNION : MOMENTUM + 3] = driven[row, 4:20]


@kernel
def drift_driven(m, dt):
    """Move what is driven over `dt`, s."""
    for b in range(len(m)):
        if m[b, ROLE] == DRIVEN:
            drift(m, b, dt)


@kernel
def foresee(m, b, dt):
    """Set the MEAN of body `b`, or of what is driven, for a kick over `dt`, s, by the present loads."""
    if m[b, ROLE] == DRIVEN:
        for a in range(3):
            m[b, MEAN + a], m[b, MEAN + 3 + a] = m[b, VELOCITY + a], m[b, SPIN + a]
    elif m[b, ROLE] == INVOLVED:
        push, turn = answer(m, b, loads_on(m, b))
        for a in range(3):
            m[b, MEAN + a] = m[b, VELOCITY + a] + 0.5 * dt * push[a]
            m[b, MEAN + 3 + a] = m[b, SPIN + a] + 0.5 * dt * turn[a]


@kernel
def kick_involved(m, rows, dt):
    """Kick these bodies, their MEAN known; returns (what drag of springs takes, work on them of what is driven), J."""
    lost, work = 0.0, 0.0
    for b in rows:
        for k in range(6):
            lost -= dt * m[b, LOSS + k] * m[b, MEAN + k]
            m[b, TOTAL + k] += dt * (m[b, LOAD + k] - m[b, PULL + k])
            m[b, TIED + k] += dt * m[b, PULL + k]
        if m[b, ROLE] == INVOLVED:
            kick(m, b, dt)
        elif m[b, ROLE] == DRIVEN:
            for k in range(6):
                work -= dt * m[b, LOAD + k] * m[b, MEAN + k]
    return lost, work
