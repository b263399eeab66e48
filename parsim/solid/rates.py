"""How short the sub-steps of an island must be: bounds of the frequencies of what may touch in it."""

import math

from parsim.machine.jit import kernel
from parsim.solid.balls import CALM, rate_balls
from parsim.solid.forces import compliance, hardness, relative_motion, velocity_at
from parsim.solid.hollows import normal_by_elements
from parsim.solid.laws.foundation import FOUNDATION
from parsim.solid.motion import answer, loads_on
from parsim.solid.search import AREA, DEPTH, FEATURE, FIRST, LAST, POINT, A, B
from parsim.solid.separation import BALLS, FIELD, ROUND_A, overlap_share, ramp_of
from parsim.solid.speeds import add_rate
from parsim.solid.springs import STEPS
from parsim.solid.table import POSITION, RATE, SWING, three
from parsim.solid.tanks import SHARE
from parsim.solid.touch import centre_of, measure, normal_of, show

_AT_REST = 5  # steps in half a period of what lies or is pressed together


@kernel
def longest_step(m, touch, island, steps_per_contact, reach):
    """(longest sub-step, s: the half period pi / sqrt(k A / m*) of a body on what it may touch, over the steps for it;
    whether springs pull any).

    All elements listed count as if they touched; a body's pairs are summed by rows of the matrix of k/m* n n, whose
    largest sum bounds its eigenvalues (Gershgorin) and with whole pairs those of chains. Pairs at rest on each other
    need only be stable: they take _AT_REST steps.
    """
    rate_some(m, touch, island, steps_per_contact)
    for c in island[2]:
        if touch.pairs[c, FEATURE] != BALLS:
            n, square = rate_of(m, touch, c, steps_per_contact, reach)
            add_rate(m, touch.pairs[c, A], touch.pairs[c, B], n, square)
    return longest_of(m, island, steps_per_contact)


@kernel
def rate_some(m, touch, island, steps_per_contact):
    """Begin the RATE of the bodies of an island with what its balls need."""
    rows, _, which = island
    for b in rows:
        m[b, RATE] = m[b, RATE + 1] = m[b, RATE + 2] = 0.0
    rate_balls(m, touch, which, (steps_per_contact, min(steps_per_contact, _AT_REST)))


@kernel
def longest_of(m, island, steps_per_contact):
    """What `longest_step` returns, of bodies whose RATE is known."""
    rows, own, _ = island
    largest, swing = 0.0, 0.0
    for b in rows[:own]:
        largest = max(largest, m[b, RATE], m[b, RATE + 1], m[b, RATE + 2])
        swing = max(swing, m[b, SWING])
    largest += swing * (STEPS * steps_per_contact) ** 2
    return (math.pi / math.sqrt(largest) if largest > 0.0 else math.inf), swing > 0.0


@kernel
def rate_of(m, touch, c, steps_per_contact, reach):
    """(normal (3,), square of a frequency along it, 1/s2, times that of the sub-steps for it) of pair `c`, no balls."""
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
    many = min(steps_per_contact, _AT_REST) if calm else steps_per_contact
    return (x, y, z), rigid * (many * many)


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
