"""Impulses of hard bodies: what all points that touch give each other at once.

Found by sweeps over all points in the order of the pairs, there and back, each point taking what the others leave (a
projected Gauss-Seidel scheme, Jean 1999, doi 10.1016/S0045-7825(98)00383-1): its normal impulse does not pull, its
friction is at most mu times that and else stops the slip; rolling friction likewise, at most mu_r R times that, also
against turning on the spot, where what is hard touches at a point and friction has no arm. What is found takes energy
or keeps it (Moreau 1988); where restitution with friction would give some, all points leave slower, together.
"""

import math

import numpy as np

from parsim.geometry.rotation import scaled
from parsim.machine.jit import kernel
from parsim.solid.laws.kernels import coefficients
from parsim.solid.motion import answer, update_momentum
from parsim.solid.points import at_centre
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
    _hit(m, a, at_centre(three(points.arms, k, 0), f))
    if b >= 0:
        _hit(m, b, at_centre(three(points.arms, k, 3), (-f[0], -f[1], -f[2])))


@kernel
def _hit(m, b, load):
    """Give body `b` an impulse and an angular impulse about its centre, six numbers."""
    v, w = answer(m, b, load)
    for k in range(3):
        m[b, VELOCITY + k] += v[k]
        m[b, SPIN + k] += w[k]
        m[b, TOTAL + k] += load[k]
        m[b, TOTAL + 3 + k] += load[3 + k]


@kernel
def _twist(m, touch, points, k, t):
    """Give the bodies of point k the angular impulse `t` (3,), N m s, on body a."""
    c = points.pair[k]
    a, b = touch.pairs[c, A], touch.pairs[c, B]
    _hit(m, a, (0.0, 0.0, 0.0, t[0], t[1], t[2]))
    if b >= 0:
        _hit(m, b, (0.0, 0.0, 0.0, -t[0], -t[1], -t[2]))


@kernel
def _energy(m, rows):
    """Kinetic energy of these bodies, J."""
    energy = 0.0
    for b in rows:
        if m[b, ROLE] == INVOLVED:
            v, w = three(m, b, VELOCITY), three(m, b, SPIN)
            h = scaled(turn_at(m, b), three(m, b, INERTIA), w[0], w[1], w[2])
            energy += 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / m[b, LIGHT]
            energy += 0.5 * (h[0] * w[0] + h[1] * w[1] + h[2] * w[2])
    return energy


@kernel
def solve(m, touch, points, rows, law):
    """Find the impulses of all points: (energy dissipated, J, work of what is driven, J, residual)."""
    start, before = _state(m, rows), _energy(m, rows)
    off = _sweep(m, touch, points, law, True)
    if _energy(m, rows) > before + _driven_work(m, rows, start):
        end = _state(m, rows)
        _blend(m, rows, start, start, 0.0)
        points.impulse[:] = points.spun[:] = points.wanted[:] = 0.0
        off = _sweep(m, touch, points, law, False)
        _slow(m, rows, start, end, before)
    for b in rows:
        if m[b, ROLE] == INVOLVED:
            update_momentum(m, b)
    return _lost(m, rows, start), _driven_work(m, rows, start), off


@kernel
def _lost(m, rows, start):
    """Energy, J, that impulses since the state `start` have taken from the motion.

    By the mean of the velocities before and after the kick, which they are part of: with it bodies move.
    """
    lost = 0.0
    for i, b in enumerate(rows):
        if m[b, ROLE] >= DRIVEN:
            for k in range(3):
                speed = m[b, MEAN + k] + 0.5 * (m[b, VELOCITY + k] - start[i, k])
                spin = m[b, MEAN + 3 + k] + 0.5 * (m[b, SPIN + k] - start[i, 3 + k])
                lost -= (m[b, TOTAL + k] - start[i, 6 + k]) * speed + (m[b, TOTAL + 3 + k] - start[i, 9 + k]) * spin
    return lost


@kernel
def _sweep(m, touch, points, law, onward):
    """Sweep over all points until their impulses change no more; the residual.

    `onward`: after each sweep there and back all go on along a conjugate direction (Silcowitz-Hansen, Niebe & Erleben
    2010, doi 10.1007/s00371-010-0502-6), to fewer sweeps, but not down in energy where too few are allowed.
    """
    most, enough = law
    count, scale, change, size = len(points.slot), 1e-300, 0.0, 0.0
    for k in range(count):
        v = velocity_of(m, touch, points, k)
        scale = max(scale, abs(v[0]) + abs(v[1]) + abs(v[2]), abs(points.wanted[k]))
    for k in range(count):
        _push(m, touch, points, k, three(points.impulse, k, 0))
        if points.rolls[k, 0] > 0.0:
            _twist(m, touch, points, k, three(points.spun, k, 0))
    way, start = np.zeros((count, 3)), np.empty((count, 3))
    for sweep in range(most):
        if sweep % 2 == 0:
            start[:], change = points.impulse, 0.0
        for step in range(count):
            change = max(change, _relax(m, touch, points, step if sweep % 2 == 0 else count - 1 - step))
        if sweep % 2 == 0:
            continue
        if change <= enough * scale or sweep + 2 > most:
            break
        if onward:
            size = _go_on(m, touch, points, start, way, size)
    return change / scale


@kernel
def _go_on(m, touch, points, start, way, size):
    """Go beyond a sweep that began at the impulses `start` along the `way` of those before; the size of its change.

    The way begins anew where changes grow.
    """
    new = 0.0
    for k in range(len(start)):
        for a in range(3):
            new += points.soft[k, 0] * (points.impulse[k, a] - start[k, a]) ** 2
    share = new / size if 0.0 < new <= size else 0.0
    for k in range(len(start)):
        more = (share * way[k, 0], share * way[k, 1], share * way[k, 2])
        for a in range(3):
            way[k, a] = more[a] + points.impulse[k, a] - start[k, a]
            points.impulse[k, a] += more[a]
        if share > 0.0:
            _push(m, touch, points, k, more)
    return new


@kernel
def _relax(m, touch, points, k):
    """Bring point k to what its contact allows; by how much its velocity has changed, m/s."""
    c = points.pair[k]
    mu = coefficients(m, touch, touch.pairs[c, A], touch.pairs[c, B])[2]
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
    return max(change, _roll(m, touch, points, k, fresh)) if points.rolls[k, 0] > 0.0 else change


@kernel
def _roll(m, touch, points, k, normal):
    """Stop what rolls, or turns on its spot, at point k as far as its `normal` impulse, N s, can; by how much, m/s."""
    c = points.pair[k]
    (p, q, r), t = three(m, touch.pairs[c, A], SPIN), three(points.spun, k, 0)
    if touch.pairs[c, B] >= 0:
        u, v, w = three(m, touch.pairs[c, B], SPIN)
        p, q, r = p - u, q - v, r - w
    arm, soft, radius = three(points.rolls, k, 0)
    x, y, z = t[0] - p / soft, t[1] - q / soft, t[2] - r / soft
    size = math.sqrt(x * x + y * y + z * z)
    if size > arm * normal:
        share = arm * normal / size
        x, y, z = share * x, share * y, share * z
    points.spun[k, 0], points.spun[k, 1], points.spun[k, 2] = x, y, z
    x, y, z = x - t[0], y - t[1], z - t[2]
    _twist(m, touch, points, k, (x, y, z))
    return math.sqrt(x * x + y * y + z * z) * soft * radius


@kernel
def _state(m, rows):
    """What impulses change: velocity, spin and impulse of contacts of these rows (n, 12)."""
    out = np.empty((len(rows), 12))
    for i, b in enumerate(rows):
        for k in range(3):
            out[i, k], out[i, 3 + k] = m[b, VELOCITY + k], m[b, SPIN + k]
        for k in range(6):
            out[i, 6 + k] = m[b, TOTAL + k]
    return out


@kernel
def _blend(m, rows, one, two, share):
    """Set what impulses change to that between two states."""
    for i, b in enumerate(rows):
        for k in range(3):
            m[b, VELOCITY + k] = one[i, k] + share * (two[i, k] - one[i, k])
            m[b, SPIN + k] = one[i, 3 + k] + share * (two[i, 3 + k] - one[i, 3 + k])
        for k in range(6):
            m[b, TOTAL + k] = one[i, 6 + k] + share * (two[i, 6 + k] - one[i, 6 + k])


@kernel
def _driven_work(m, rows, start):
    """Work, J, of what is driven, by what has been given to it since the state `start`."""
    work = 0.0
    for i, b in enumerate(rows):
        if m[b, ROLE] == DRIVEN:
            for k in range(3):
                work -= (m[b, TOTAL + k] - start[i, 6 + k]) * m[b, VELOCITY + k]
                work -= (m[b, TOTAL + 3 + k] - start[i, 9 + k]) * m[b, SPIN + k]
    return work


@kernel
def _slow(m, rows, start, end, before):
    """From where points leave with no speed go towards the state `end` as far as energy, `before`, J, and work last."""
    still = _state(m, rows)
    gain = np.empty(3)
    for k in range(3):
        _blend(m, rows, still, end, 0.5 * k)
        gain[k] = _energy(m, rows) - _driven_work(m, rows, start) - before
    a = 2.0 * (gain[2] - 2.0 * gain[1] + gain[0])
    b = gain[2] - gain[0] - a
    root = math.sqrt(max(b * b - 4.0 * a * gain[0], 0.0))
    share = 2.0 * -gain[0] / (b + root) if b + root > 0.0 else 0.0
    _blend(m, rows, still, end, min(max(share, 0.0), 1.0))
