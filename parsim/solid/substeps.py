"""One step of the water for all bodies, cut into sub-steps where contacts need them."""

import math

from parsim.machine.jit import kernel
from parsim.solid.balls import CALM, rate_balls
from parsim.solid.forces import coefficients, compliance, free_time, hardness, press, relative_motion, velocity_at
from parsim.solid.heaps import advance_heap, is_heap
from parsim.solid.hollows import normal_by_elements
from parsim.solid.islands import islands_of
from parsim.solid.laws.foundation import FOUNDATION
from parsim.solid.motion import (
    alone,
    answer,
    drift_driven,
    drift_involved,
    driven_now,
    kick_involved,
    loads_on,
    set_back,
)
from parsim.solid.search import AREA, CRUSHED, DEPTH, FEATURE, FIRST, LAST, POINT, ROLL, STRETCH, A, B
from parsim.solid.separation import BALLS, FIELD, ROUND_A, overlap_share, ramp_of
from parsim.solid.speeds import add_rate
from parsim.solid.springs import STEPS, held_by_springs, rate_springs
from parsim.solid.table import POSITION, RATE, SWING, three
from parsim.solid.tanks import LAPSE, SHARE, SHEAR, STORED, restrain
from parsim.solid.touch import centre_of, measure, normal_of, show

_AT_REST = 5  # steps in half a period of what lies or is pressed together


@kernel
def advance(m, touch, number, dt, reach, steps_per_contact):
    """Move all bodies over `dt`, s; (touching elements, most sub-steps of any, energy dissipated, work of what is
    driven).

    Each island on its own, in sub-steps of equal length while something touches; until the first touch, as long as
    nothing can touch. What is driven moves with each island that it may touch, and then for itself.

    Measured for steps of 0.2 ms on a busy core: 9 blocks apart 25 us; jostling between walls and gate 0.9 ms; a stack
    of three at rest 1.3 ms (76 sub-steps); 9 blocks pressed together, 20 pairs, 2.7 ms (45 sub-steps).
    """
    alone(m, dt)
    rate_springs(m, touch, dt)
    islands = islands_of(m, touch, number)
    touching, most, lost, work, driven = 0, 1, 0.0, 0.0, driven_now(m)
    for k in range(len(islands.first)):
        rows, own = islands.rows[islands.first[k] : islands.last[k]], islands.own[k] - islands.first[k]
        which = islands.pairs[islands.first_pair[k] : islands.first_pair[k + 1]]
        set_back(m, driven)
        count, steps, heat, by_driven = _advance(m, touch, (rows, own, which), dt, reach, steps_per_contact)
        touching, most, lost, work = touching + count, max(most, steps), lost + heat, work + by_driven
    set_back(m, driven)
    drift_driven(m, dt)
    return touching, most, lost, work


@kernel
def _advance(m, touch, island, dt, reach, steps_per_contact):
    """Move one island over `dt`, s; what `advance` returns of it."""
    (rows, _, which), tanks = island, touch.tanks
    lost, steps, work = 0.0, 0, 0.0
    for c in which:
        lost += tanks[c, SHEAR]
    touching = press(m, touch, island, 0.0, 0.0)
    longest, on_springs = _longest(m, touch, island, steps_per_contact, reach)
    if is_heap(m, touch, island):
        touching, steps, heat = advance_heap(m, touch, island, dt, longest, touching)
        return touching, steps, lost + heat, 0.0
    rest, pending, shear = dt, 0.0, 0.0
    while rest > 0.0:
        count = max(math.ceil(rest / longest), 1)
        span = rest / count
        if touching == 0 and count > 1 and not on_springs:
            span = min(max(span, free_time(m, touch, which, dt) - pending), rest)
        drift_involved(m, rows, pending + 0.5 * span)
        touching = press(m, touch, island, pending + 0.5 * span, span)
        shear = restrain(m, touch, which, rows, span)
        heat, by_driven = kick_involved(m, rows, span)
        lost, work, steps = lost + heat, work + by_driven, steps + 1
        rest, pending = (rest - span if span < rest else 0.0), 0.5 * span
    drift_involved(m, rows, pending)
    for c in which:
        tanks[c, LAPSE] = pending
    return touching, steps, lost - shear, work


@kernel
def _longest(m, touch, island, steps_per_contact, reach):
    """(longest sub-step, s: the half period pi / sqrt(k A / m*) of a body on what it may touch, over the steps for it;
    whether springs pull any).

    All elements listed count as if they touched; a body's pairs are summed by rows of the matrix of k/m* n n, whose
    largest sum bounds its eigenvalues (Gershgorin) and with whole pairs those of chains. Pairs at rest on each other
    need only be stable: they take _AT_REST steps.
    """
    (rows, own, which), at_rest = island, min(steps_per_contact, _AT_REST)
    for b in rows:
        m[b, RATE] = m[b, RATE + 1] = m[b, RATE + 2] = 0.0
    rate_balls(m, touch, which, (steps_per_contact, at_rest))
    for c in which:
        if touch.pairs[c, FEATURE] != BALLS:
            _rate_pair(m, touch, c, (steps_per_contact, at_rest), reach)
    largest, swing = 0.0, 0.0
    for b in rows[:own]:
        largest = max(largest, m[b, RATE], m[b, RATE + 1], m[b, RATE + 2])
        swing = max(swing, m[b, SWING])
    largest += swing * (STEPS * steps_per_contact) ** 2
    return (math.pi / math.sqrt(largest) if largest > 0.0 else math.inf), swing > 0.0


@kernel
def _rate_pair(m, touch, c, steps, reach):
    """Add to the RATE of its bodies what pair `c` needs; `steps`: of what moves, and of what is at rest."""
    pairs, shift = touch.pairs, touch.shift
    a, b = pairs[c, A], pairs[c, B]
    apart, x, y, z = normal_of(m, touch, c)
    area = measure(m, touch, c, (x, y, z), apart) if apart < 0.0 else 0.0
    if area > 0.0 and pairs[c, FEATURE] == FIELD:
        x, y, z = normal_by_elements(touch.slots, pairs[c, FIRST], pairs[c, LAST], (x, y, z))
    calm = _calm(m, touch, c, (x, y, z), area) if area > 0.0 else False
    rigid = _rate(m, touch, c, (x, y, z), apart)
    if b >= 0 and apart < 0.0 and pairs[c, FEATURE] < ROUND_A:
        ramp = 4.0 * ramp_of(m, a, b)
        share = overlap_share(m, touch.forms, (a, b), three(shift, c, 0), (x, y, z), ramp)
        rigid *= min(share + reach / ramp, 1.0)
    many = steps[1] if calm else steps[0]
    add_rate(m, a, b, (x, y, z), rigid * (many * many))


@kernel
def _rate(m, touch, c, n, apart):
    """Square of the largest angular frequency, 1/s2, of pair `c` if all its elements touch."""
    pairs, shift, slots = touch.pairs, touch.shift, touch.slots
    a, b, by, first, last = pairs[c, A], pairs[c, B], three(shift, c, 0), pairs[c, FIRST], pairs[c, LAST]
    total, trace, largest = show(m, touch, c, n, apart), 0.0, 0.0
    touch.tanks[c, SHARE] = 1.0
    if total == 0.0:
        return 0.0
    for slot in range(first, last + 1):
        if slots[slot, AREA] > 0.0:
            each = compliance(m, a, b, three(slots, slot, POINT), by, n)
            trace, largest = trace + slots[slot, AREA] * each, max(largest, each)
    bounce = total * compliance(m, a, b, centre_of(slots, first, last), by, n)
    rigid, held, _ = hardness(m, touch, c, total)
    # three ways to move on a face that is as hard everywhere; else all of it may bear on one corner
    rocking = trace / 3.0 if touch.law == FOUNDATION else total * largest
    return rigid * (1.0 / held - 1.0) * max(bounce, rocking)


@kernel
def _calm(m, touch, c, n, area):
    """Whether a touching pair lies at rest: what speed and unbalanced force can move it is small against its depth."""
    pairs, shift, slots = touch.pairs, touch.shift, touch.slots
    a, b, by, first, last = pairs[c, A], pairs[c, B], three(shift, c, 0), pairs[c, FIRST], pairs[c, LAST]
    motion, volume, fastest = relative_motion(m, a, b, by), 0.0, 0.0
    x, y, z = motion[0]
    for slot in range(first, last + 1):
        if slots[slot, DEPTH] > 0.0:
            p = three(slots, slot, POINT)
            v = velocity_at(motion, p[0] - x, p[1] - y, p[2] - z)
            fastest = max(fastest, abs(v[0] * n[0] + v[1] * n[1] + v[2] * n[2]))
            volume += slots[slot, AREA] * slots[slot, DEPTH]
    centre = centre_of(slots, first, last)
    rigid, held, _ = hardness(m, touch, c, area)
    square = rigid * (1.0 / held - 1.0) * area * compliance(m, a, b, centre, by, n)
    unbalanced = _acceleration(m, a, centre, (0.0, 0.0, 0.0), n)
    if b >= 0:
        unbalanced -= _acceleration(m, b, centre, by, n)
    return fastest / math.sqrt(square) + abs(unbalanced) / square < CALM * volume / area


@kernel
def _acceleration(m, b, p, by, n):
    """Acceleration along `n` of the point `p` of body `b` under its present loads, m/s2."""
    centre = three(m, b, POSITION)
    x, y, z = p[0] - centre[0] - by[0], p[1] - centre[1] - by[1], p[2] - centre[2] - by[2]
    (ax, ay, az), (p, q, r) = answer(m, b, loads_on(m, b))
    return n[0] * (ax + q * z - r * y) + n[1] * (ay + r * x - p * z) + n[2] * (az + p * y - q * x)


@kernel
def elastic(m, touch, number):
    """Energy, J, that pairs can give back at the present pose, what their springs hold, at most their tanks; and what
    springs to the world hold."""
    pairs, slots, tanks = touch.pairs, touch.slots, touch.tanks
    energy = held_by_springs(m, touch.springs)
    for c in range(number):
        apart, x, y, z = normal_of(m, touch, c)
        area = measure(m, touch, c, (x, y, z), apart) if apart < 0.0 else 0.0
        if area == 0.0:
            continue
        (rigid, held, shear), potential = hardness(m, touch, c, area), 0.0
        for slot in range(pairs[c, FIRST], pairs[c, LAST] + 1):
            if slots[slot, DEPTH] > 0.0:
                depth, s = slots[slot, DEPTH], three(slots, slot, STRETCH)
                pressed = held * max(depth - slots[slot, CRUSHED], 0.0) ** 2
                r, rolling = three(slots, slot, ROLL), coefficients(m, touch, pairs[c, A], pairs[c, B])[4]
                rolled = 1.125 * rolling * rolling * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2])
                sheared = 0.5 * shear * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2])
                potential += rigid * slots[slot, AREA] * (pressed + sheared + rolled)
        energy += min(potential, tanks[c, STORED])
    return energy
