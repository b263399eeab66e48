"""Motion of hard bodies, whose contacts take no time, as in nonsmooth dynamics (Moreau 1988).

A step of the water is cut where bodies meet. There each point that comes closer leaves with its restitution times its
speed (Newton); what is slower than the speed that its weight gives it in the step lies, and has none. After each cut
the bodies fly, or their contacts keep points from coming closer than they are. A point of a pair is one of the elements
of the other laws where it is in the other body; bodies lie _SINK of their width deep in each other, so contacts last.
"""

import math

import numpy as np

from parsim.machine.jit import kernel
from parsim.solid.impulses import solve, velocity_of
from parsim.solid.islands import islands_of
from parsim.solid.laws.kernels import coefficients
from parsim.solid.motion import (
    alone,
    clear_loads,
    drift_driven,
    drift_involved,
    driven_now,
    foresee,
    kick_involved,
    set_back,
)
from parsim.solid.points import points_of
from parsim.solid.search import FEATURE, FIRST, LAST, ROLL, STRETCH, TOUCHING, A, B
from parsim.solid.separation import FIELD
from parsim.solid.shapes.kernels import touches_at_one_point
from parsim.solid.springs import STEPS, pull_springs, rate_springs
from parsim.solid.table import GIVEN, INVERSE, INVOLVED, LIGHT, RADIUS, ROLE, SPIN, SWING, VELOCITY, shape_of, three
from parsim.solid.touch import normal_of

_SINK = 1e-6  # of the least half width of a pair's bodies, that they sink into each other
_MEETINGS, _FEW = 50, 4  # in one step of the water, of a body and of an island at most, at which it is cut; what meets
# after them does so at its end
_LEAST = 1e-6  # of a step of the water that lies between two cuts
_LIES = 4.0  # times the speed that loads give a body in a step, below which what comes closer lies


@kernel
def advance_hard(m, touch, number, dt, law, steps_per_swing):
    """Move all bodies over `dt`, s; (points that touch, most cuts of any, energy dissipated, J, work of what is driven,
    residual).

    law: sweeps and residual of `laws.impulse`. The residual is the largest that was left, over the largest speed of its
    island. Springs to the world cut the step too: steps in half a period of a body on them. Each island on its own.
    """
    alone(m, dt)
    rate_springs(m, touch, dt)
    islands = islands_of(m, touch, number)
    touching, most, lost, work, left, driven = 0, 1, 0.0, 0.0, 0.0, driven_now(m)
    for k in range(len(islands.first)):
        rows = islands.rows[islands.first[k] : islands.last[k]]
        which = islands.pairs[islands.first_pair[k] : islands.first_pair[k + 1]]
        set_back(m, driven)
        count, cuts, heat, by_driven, off = _advance(m, touch, (rows, which), dt, law, steps_per_swing)
        touching, most, left = touching + count, max(most, cuts), max(left, off)
        lost, work = lost + heat, work + by_driven
    set_back(m, driven)
    drift_driven(m, dt)
    return touching, most, lost, work, left


@kernel
def _advance(m, touch, island, dt, law, steps_per_swing):
    """Move one island over `dt`, s; what `advance_hard` returns of it."""
    rows, which = island
    lost, work, cuts, rest, left, touching, meetings = 0.0, 0.0, 0, dt, 0.0, 0, 0
    lies, rate = _LIES * _gains(m, rows, dt), np.max(m[rows, SWING])
    longest = math.pi / (STEPS * steps_per_swing * math.sqrt(rate)) if rate > 0.0 else dt
    while rest > 0.0:
        span = rest / math.ceil(rest / longest)
        if meetings < max(_MEETINGS // len(rows), _FEW):
            meeting = max(_time_to_meet(m, touch, which, rest, lies), _LEAST * dt)
            if meeting < span:
                span, meetings = meeting, meetings + 1
        drift_involved(m, rows, 0.5 * span)
        clear_loads(m, rows)
        pull_springs(m, touch, rows)
        for b in rows:
            foresee(m, b, span)
        heat, by_driven = kick_involved(m, rows, span)
        lost, work = lost + heat, work + by_driven
        points = points_of(m, touch, which)
        touching = len(points.slot)
        if touching > 0:
            _aim(m, touch, points, lies, span)
            gone, done, off = solve(m, touch, points, rows, law)
            lost, work, left = lost + gone, work + done, max(left, off)
        _note_forces(touch, which, points, span)
        drift_involved(m, rows, 0.5 * span)
        rest, cuts = (rest - span if span < rest else 0.0), cuts + 1
    return touching, cuts, lost, work, left


@kernel
def _gains(m, rows, dt):
    """Largest speed, m/s, that the given loads give any of these bodies in the step."""
    most = 0.0
    for b in rows:
        if m[b, ROLE] == INVOLVED:
            x, y, z = three(m, b, GIVEN)
            most = max(most, dt * m[b, LIGHT] * math.sqrt(x * x + y * y + z * z))
    return most


@kernel
def _sink(touch, a, b):
    """How deep bodies a and b, or body a and a wall, lie in each other, m."""
    margin = touch.forms.margin
    return _SINK * (min(margin[a], margin[b]) if b >= 0 else margin[a])


@kernel
def _aim(m, touch, points, lies, span):
    """Set the speeds that points are to have along their normals.

    What comes closer faster than `lies`, m/s, leaves. The others may sink as deep as they lie in the coming `span`, s,
    and begin with the forces of before.
    """
    for k in range(len(points.slot)):
        c, slot, n = points.pair[k], points.slot[k], three(points.normal, k, 0)
        a, b = touch.pairs[c, A], touch.pairs[c, B]
        v = velocity_of(m, touch, points, k)
        closer = -(v[0] * n[0] + v[1] * n[1] + v[2] * n[2])
        if closer > lies:
            points.wanted[k] = coefficients(m, touch, a, b)[1] * closer
            continue
        points.wanted[k] = min(points.depth[k] - _sink(touch, a, b), 0.0) / span
        if touch.marks[slot, TOUCHING]:
            for axis in range(3):
                points.impulse[k, axis] = span * touch.slots[slot, STRETCH + axis]
                points.spun[k, axis] = span * touch.slots[slot, ROLL + axis]


@kernel
def _note_forces(touch, which, points, span):
    """Note the forces of all points, N, and torques, N m, in place of the stretch that springs would have."""
    marks, slots = touch.marks, touch.slots
    for c in which:
        for slot in range(touch.pairs[c, FIRST], touch.pairs[c, LAST] + 1):
            marks[slot, TOUCHING] = 0
    for k in range(len(points.slot)):
        marks[points.slot[k], TOUCHING] = 1
        for a in range(3):
            slots[points.slot[k], STRETCH + a] = points.impulse[k, a] / span
            slots[points.slot[k], ROLL + a] = points.spun[k, a] / span


@kernel
def _time_to_meet(m, touch, which, rest, lies):
    """A time, s, at most `rest`, in which no pair that is apart can touch, 0 where one hits, faster than `lies`, m/s.

    Along its normal a pair closes no faster than its centres and its spins do.
    """
    pairs, hit = touch.pairs, False
    for c in which:
        apart, x, y, z = normal_of(m, touch, c)
        a, b = pairs[c, A], pairs[c, B]
        speed, gain = _closing(m, a, (-x, -y, -z))
        if b >= 0:
            other, more = _closing(m, b, (x, y, z))
            speed, gain = speed + other, gain + more
        if pairs[c, FEATURE] == FIELD:
            continue  # how far a mesh is from what lies in its hollows is not known: it meets at the ends of steps
        if apart <= 0.0:
            hit = hit or speed > lies
            continue
        # the gap closes by speed t + gain t^2 / 2
        root = speed * speed + 2.0 * gain * apart
        if root > 0.0 and speed + math.sqrt(root) > 0.0:
            rest = min(rest, 2.0 * apart / (speed + math.sqrt(root)))
    if hit and _fastest(m, touch, points_of(m, touch, which)) > lies:
        return 0.0
    return rest


@kernel
def _fastest(m, touch, points):
    """Largest speed, m/s, at which any point comes closer; endless where they only just touch."""
    most = 0.0 if len(points.slot) > 0 else math.inf
    for k in range(len(points.slot)):
        v, n = velocity_of(m, touch, points, k), three(points.normal, k, 0)
        most = max(most, -(v[0] * n[0] + v[1] * n[1] + v[2] * n[2]))
    return most


@kernel
def _closing(m, b, n):
    """(speed, acceleration) along `n` of the point of body `b` that is fastest along it, at most."""
    v, w, f = three(m, b, VELOCITY), three(m, b, SPIN), three(m, b, GIVEN)
    speed = v[0] * n[0] + v[1] * n[1] + v[2] * n[2]
    spin = math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    if touches_at_one_point(shape_of(m, b)):
        spin = 0.0
    t, inverse = three(m, b, GIVEN + 3), three(m, b, INVERSE)
    turn = math.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]) * max(inverse[0], inverse[1], inverse[2])
    gain = m[b, LIGHT] * (f[0] * n[0] + f[1] * n[1] + f[2] * n[2])
    return speed + m[b, RADIUS] * spin, gain + m[b, RADIUS] * turn
