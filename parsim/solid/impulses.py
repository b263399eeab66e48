"""Impulses of hard bodies: what all points that touch give each other at once.

Found by sweeps over all points in the order of the pairs, there and back, each point taking what the others leave (a
projected Gauss-Seidel scheme, Jean 1999, doi 10.1016/S0045-7825(98)00383-1): its normal impulse does not pull, its
friction is at most mu times that and else stops the slip. What is found takes energy or keeps it (Moreau 1988); where
restitution with friction would give some, all points leave slower, together.
"""

import math

import numpy as np

from parsim.geometry.rotation import scaled
from parsim.machine.jit import kernel
from parsim.solid.forces import coefficients
from parsim.solid.motion import answer, update_momentum
from parsim.solid.search import A, B
from parsim.solid.table import DRIVEN, INERTIA, INVOLVED, LIGHT, MEAN, ROLE, SPIN, TOTAL, VELOCITY, three, turn_at


@kernel
def velocity_of(m, touch, points, k):
    """Velocity of body a against b at point k."""
    c = points.pair[k]
    a, b = touch.pairs[c, A], touch.pairs[c, B]
    x, y, z = three(points.arms, k, 0)
    v, w = three(m, a, VELOCITY), three(m, a, SPIN)
    u = (v[0] + w[1] * z - w[2] * y, v[1] + w[2] * x - w[0] * z, v[2] + w[0] * y - w[1] * x)
    if b < 0:
        return u
    x, y, z = three(points.arms, k, 3)
    v, w = three(m, b, VELOCITY), three(m, b, SPIN)
    return (
        u[0] - (v[0] + w[1] * z - w[2] * y),
        u[1] - (v[1] + w[2] * x - w[0] * z),
        u[2] - (v[2] + w[0] * y - w[1] * x),
    )


@kernel
def _push(m, touch, points, k, f):
    """Give the bodies of point k the impulse `f` (3,), N s, on body a."""
    c = points.pair[k]
    a, b = touch.pairs[c, A], touch.pairs[c, B]
    _hit(m, a, three(points.arms, k, 0), f)
    if b >= 0:
        _hit(m, b, three(points.arms, k, 3), (-f[0], -f[1], -f[2]))


@kernel
def _hit(m, b, arm, f):
    x, y, z = arm
    load = (f[0], f[1], f[2], y * f[2] - z * f[1], z * f[0] - x * f[2], x * f[1] - y * f[0])
    v, w = answer(m, b, load)
    for k in range(3):
        m[b, VELOCITY + k] += v[k]
        m[b, SPIN + k] += w[k]
        m[b, TOTAL + k] += load[k]
        m[b, TOTAL + 3 + k] += load[3 + k]


@kernel
def _energy(m):
    """Kinetic energy of the bodies that may touch, J."""
    energy = 0.0
    for b in range(len(m)):
        if m[b, ROLE] == INVOLVED:
            v, w = three(m, b, VELOCITY), three(m, b, SPIN)
            h = scaled(turn_at(m, b), three(m, b, INERTIA), w[0], w[1], w[2])
            energy += 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / m[b, LIGHT]
            energy += 0.5 * (h[0] * w[0] + h[1] * w[1] + h[2] * w[2])
    return energy


@kernel
def solve(m, touch, points, law, meeting):
    """Find the impulses of all points: (energy dissipated, J, work of what is driven, J, residual)."""
    start, before = _state(m), _energy(m)
    off = _sweep(m, touch, points, law)
    if meeting and _energy(m) > before + _driven_work(m, start):
        end = _state(m)
        _blend(m, start, start, 0.0)
        points.impulse[:] = 0.0
        points.wanted[:] = 0.0
        off = max(off, _sweep(m, touch, points, law))
        _slow(m, start, end, before)
    for b in range(len(m)):
        if m[b, ROLE] == INVOLVED:
            update_momentum(m, b)
    return _lost(m, start), _driven_work(m, start), off


@kernel
def _lost(m, start):
    """Energy, J, that impulses since the state `start` have taken from the motion.

    By the mean of the velocities before and after the kick, which they are part of: with it bodies move.
    """
    lost = 0.0
    for b in range(len(m)):
        if m[b, ROLE] >= DRIVEN:
            for k in range(3):
                speed = m[b, MEAN + k] + 0.5 * (m[b, VELOCITY + k] - start[b, k])
                spin = m[b, MEAN + 3 + k] + 0.5 * (m[b, SPIN + k] - start[b, 3 + k])
                lost -= (m[b, TOTAL + k] - start[b, 6 + k]) * speed + (m[b, TOTAL + 3 + k] - start[b, 9 + k]) * spin
    return lost


@kernel
def _sweep(m, touch, points, law):
    """Sweep over all points until their impulses change no more; the residual."""
    most, enough = law
    count, scale, change = len(points.slot), 1e-300, 0.0
    for k in range(count):
        v = velocity_of(m, touch, points, k)
        scale = max(scale, abs(v[0]) + abs(v[1]) + abs(v[2]), abs(points.wanted[k]))
    for k in range(count):
        _push(m, touch, points, k, three(points.impulse, k, 0))
    for sweep in range(most):
        change = 0.0
        for step in range(count):
            change = max(change, _relax(m, touch, points, step if sweep % 2 == 0 else count - 1 - step))
        if change <= enough * scale:
            break
    return change / scale


@kernel
def _relax(m, touch, points, k):
    """Bring point k to what its contact allows; by how much its velocity has changed, m/s."""
    c = points.pair[k]
    _, _, mu, _, _ = coefficients(m, touch, touch.pairs[c, A], touch.pairs[c, B])
    n, f, soft = three(points.normal, k, 0), three(points.impulse, k, 0), points.soft[k]
    v = velocity_of(m, touch, points, k)
    normal = f[0] * n[0] + f[1] * n[1] + f[2] * n[2]
    fx, fy, fz = f[0] - normal * n[0], f[1] - normal * n[1], f[2] - normal * n[2]
    along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2]
    fresh = max(normal + (points.wanted[k] - along) / soft[0], 0.0)
    change = abs(fresh - normal) * soft[0]
    _push(m, touch, points, k, ((fresh - normal) * n[0], (fresh - normal) * n[1], (fresh - normal) * n[2]))
    v = velocity_of(m, touch, points, k)
    along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2]
    tx = fx - (v[0] - along * n[0]) / soft[1]
    ty = fy - (v[1] - along * n[1]) / soft[1]
    tz = fz - (v[2] - along * n[2]) / soft[1]
    size = math.sqrt(tx * tx + ty * ty + tz * tz)
    if size > mu * fresh:
        share = mu * fresh / size
        tx, ty, tz = share * tx, share * ty, share * tz
    _push(m, touch, points, k, (tx - fx, ty - fy, tz - fz))
    change = max(change, math.sqrt((tx - fx) * (tx - fx) + (ty - fy) * (ty - fy) + (tz - fz) * (tz - fz)) * soft[1])
    points.impulse[k, 0] = tx + fresh * n[0]
    points.impulse[k, 1] = ty + fresh * n[1]
    points.impulse[k, 2] = tz + fresh * n[2]
    return change


@kernel
def _state(m):
    """What impulses change: velocity, spin and impulse of contacts of all rows (n, 12)."""
    out = np.empty((len(m), 12))
    for b in range(len(m)):
        for k in range(3):
            out[b, k], out[b, 3 + k] = m[b, VELOCITY + k], m[b, SPIN + k]
        for k in range(6):
            out[b, 6 + k] = m[b, TOTAL + k]
    return out


@kernel
def _blend(m, one, two, share):
    """Set what impulses change to that between two states."""
    for b in range(len(m)):
        for k in range(3):
            m[b, VELOCITY + k] = one[b, k] + share * (two[b, k] - one[b, k])
            m[b, SPIN + k] = one[b, 3 + k] + share * (two[b, 3 + k] - one[b, 3 + k])
        for k in range(6):
            m[b, TOTAL + k] = one[b, 6 + k] + share * (two[b, 6 + k] - one[b, 6 + k])


@kernel
def _driven_work(m, start):
    """Work, J, of what is driven, by what has been given to it since the state `start`."""
    work = 0.0
    for b in range(len(m)):
        if m[b, ROLE] == DRIVEN:
            for k in range(3):
                work -= (m[b, TOTAL + k] - start[b, 6 + k]) * m[b, VELOCITY + k]
                work -= (m[b, TOTAL + 3 + k] - start[b, 9 + k]) * m[b, SPIN + k]
    return work


@kernel
def _slow(m, start, end, before):
    """From where points leave with no speed go towards the state `end` as far as energy, `before`, J, and work last."""
    still = _state(m)
    gain = np.empty(3)
    for k in range(3):
        _blend(m, still, end, 0.5 * k)
        gain[k] = _energy(m) - _driven_work(m, start) - before
    a = 2.0 * (gain[2] - 2.0 * gain[1] + gain[0])
    b = gain[2] - gain[0] - a
    root = math.sqrt(max(b * b - 4.0 * a * gain[0], 0.0))
    share = 2.0 * -gain[0] / (b + root) if b + root > 0.0 else 0.0
    _blend(m, still, end, min(max(share, 0.0), 1.0))
