"""Forces of all pairs that may touch: the law for each element, summed per body."""

import math

from parsim.geometry.rotation import to_body
from parsim.machine.jit import kernel
from parsim.solid.balls import press_balls
from parsim.solid.element import friction_force, give_way, normal_force, of_spot, rolling_torque, twisting_torque
from parsim.solid.hollows import normal_by_elements
from parsim.solid.laws.kernels import coefficients, stiffness
from parsim.solid.laws.law import SPOT
from parsim.solid.motion import answer, clear_loads
from parsim.solid.search import (
    AREA,
    CRUSHED,
    DEPTH,
    FEATURE,
    FIRST,
    LAST,
    NORMAL,
    POINT,
    ROLL,
    STRETCH,
    TOUCHING,
    TWIST,
    A,
    B,
)
from parsim.solid.separation import BALLS, FIELD, between
from parsim.solid.speeds import speed_of
from parsim.solid.springs import pull_springs
from parsim.solid.table import INVERSE, LIGHT, POSITION, RUSH, SPIN, VELOCITY, is_tied, three, turn_at
from parsim.solid.tanks import BEND, DEEP, LAPSE, LOADS, RADIUS, SHARE, load_pair
from parsim.solid.touch import centre_of, measure, normal_of

_NO_LOAD = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def press(m, touch, island, lapse, span):
    """Loads of the pairs of an island and of its springs into the table and the tanks; how many elements touch.

    `pair_law` (6, n, n): see `laws.pairs.law_of_pairs`. `lapse`:
    time since the last call in this step, s, by which friction springs have stretched; `span`: of the kick that comes,
    s; 0 to look only. 50 ns an element that touches, 1 us a pair that overlaps.
    """
    rows, _, which = island
    clear_loads(m, rows)
    touching = press_balls(m, touch, which, lapse, span)
    for c in which:
        if touch.pairs[c, FEATURE] != BALLS:
            count, stored, sheared, force, loss, spent = load_of(m, touch, c, lapse, span)
            load_pair(m, touch, c, stored, sheared, force, loss, spent)
            touching += count
    pull_and_date(m, touch, island, span)
    return touching


@kernel
def load_of(m, touch, c, lapse, span):
    """Of pair `c`, no balls: (elements that touch, energy in its springs, in those of friction, J, its load on body a,
    what of it dissipates, see `_sum`; energy that it has crushed since the last look, J)."""
    apart, x, y, z = normal_of(m, touch, c)
    area = measure(m, touch, c, (x, y, z), apart) if apart < 0.0 else 0.0
    if area == 0.0:
        for slot in range(touch.pairs[c, FIRST], touch.pairs[c, LAST] + 1):
            touch.marks[slot, TOUCHING] = 0
        return 0, 0.0, 0.0, _NO_LOAD, _NO_LOAD, 0.0
    return _push(m, touch, c, (x, y, z), area, (lapse + touch.tanks[c, LAPSE] if span > 0.0 else 0.0, span))


@kernel
def pull_and_date(m, touch, island, span):
    """Add the loads of the springs of an island, and note that those of its friction are up to date for a kick."""
    rows, own, which = island
    pull_springs(m, touch, rows[:own])
    if span > 0.0:
        for c in which:
            touch.tanks[c, LAPSE] = 0.0


@kernel
def hardness(m, touch, c, area):
    """(force over touching area and depth, Pa/m; energy held over force times depth; tangential over normal stiffness)
    of pair `c`.

    `area`, m2: what touches, by `measure` or `show`; the stiffness is that of a contact that is not narrow.
    """
    tanks, (own, _, _, shear, _, _) = touch.tanks, coefficients(m, touch, touch.pairs[c, A], touch.pairs[c, B])
    area /= tanks[c, SHARE]
    rigid, held, more = stiffness(touch.law, own, area, tanks[c, BEND], tanks[c, RADIUS], tanks[c, DEEP])
    return rigid, held, more * shear


@kernel
def compliance(m, a, b, p, by, n):
    """1 / effective mass of a pair for an impulse along `n` at the point `p`, 1/kg."""
    one = _compliance(m, a, p, (0.0, 0.0, 0.0), n)
    return one + _compliance(m, b, p, by, n) if b >= 0 else one


@kernel
def _compliance(m, b, p, by, n):
    centre, own = three(m, b, POSITION), three(m, b, INVERSE)
    x, y, z = p[0] - centre[0] - by[0], p[1] - centre[1] - by[1], p[2] - centre[2] - by[2]
    x, y, z = y * n[2] - z * n[1], z * n[0] - x * n[2], x * n[1] - y * n[0]
    if is_tied(m, b):
        a, w = answer(m, b, (n[0], n[1], n[2], x, y, z))
        return a[0] * n[0] + a[1] * n[1] + a[2] * n[2] + (w[0] * x + w[1] * y + w[2] * z)
    x, y, z = to_body(turn_at(m, b), x, y, z)
    return m[b, LIGHT] + (own[0] * x * x + own[1] * y * y + own[2] * z * z)


@kernel
def _push(m, touch, c, n, total, times):
    """What `load_of` returns of a pair whose elements touch with the area `total`, m2.

    The dashpots share 2 b sqrt(m* k A) by area, m* taken at the centre of the touching area: restitution then depends
    neither on the number of elements nor on where the body is hit. A force that goes with the depth to the power p
    holds 1 / (p + 1) of force times depth and is damped like a linear one where m* counts (p + 1) / 2 times: with
    y = x^((p + 1) / 2) its equation of motion v(x) becomes that of a linear spring (for p = 3/2 that of Tsuji 1992).

    Dashpots feel the velocity of the middle of the kick, by what these springs do to the centres in it and what all
    else did in the one before: with that of its beginning, half a kick late, they take too much, 0.003 of a restitution
    of 0.8 at 20 steps a contact.
    """
    pairs, shift, slots = touch.pairs, touch.shift, touch.slots
    a, b, by, first, last = pairs[c, A], pairs[c, B], three(shift, c, 0), pairs[c, FIRST], pairs[c, LAST]
    _, damping, mu, _, rolling, strength = coefficients(m, touch, a, b)
    rigid, held, shear = hardness(m, touch, c, total)
    own = pairs[c, FEATURE] == FIELD
    if own:
        n = normal_by_elements(slots, first, last, n)
    effective = 1.0 / compliance(m, a, b, centre_of(slots, first, last), by, n)
    dashpot = 2.0 * damping * math.sqrt(effective * rigid / total * (0.5 / held))
    motion, light = relative_motion(m, a, b, by), m[a, LIGHT] + (m[b, LIGHT] if b >= 0 else 0.0)
    springs = rigid * _pressed_in(touch, first, last, strength / rigid) - _along(touch.tanks, c, n)
    dashpot /= 1.0 + 0.5 * times[1] * dashpot * total / effective
    ahead = times[0], 0.5 * times[1] * (_parting(m, a, b, n) + light * springs)
    radius, twists = touch.tanks[c, RADIUS], touch.tanks[c, BEND] == SPOT and not own
    inert, (spot, stiff) = 0.4 * effective / total * radius * radius if twists else 0.0, of_spot(total, mu)
    law = rigid, dashpot, mu, held, shear, (rolling, radius, own, strength), (inert, spot, stiff * shear * rigid)
    touching, (sheared, pressed, spent), force, loss = _sum(touch, first, last, n, motion, ahead, law)
    return touching, sheared + pressed, sheared, force, loss, spent


@kernel
def _pressed_in(touch, first, last, least):
    """Area times elastic depth of all elements that touch, m3; they give way at the depth `least`, m."""
    slots, total = touch.slots, 0.0
    for slot in range(first, last + 1):
        if slots[slot, DEPTH] > 0.0:
            total += slots[slot, AREA] * _elastic_depth(touch, slot, least)[0]
    return total


@kernel
def _elastic_depth(touch, slot, least):
    """See `element.give_way`; an element that comes anew is whole."""
    crushed = touch.slots[slot, CRUSHED] if touch.marks[slot, TOUCHING] else 0.0
    return give_way(touch.slots[slot, DEPTH], crushed, least)


@kernel
def _along(tanks, c, n):
    """Force of pair `c` along its normal at the kick before, N."""
    x, y, z = three(tanks, c, LOADS)
    return x * n[0] + y * n[1] + z * n[2]


@kernel
def _parting(m, a, b, n):
    """Acceleration of the centres of a pair along its normal at the kick before, m/s2."""
    x, y, z = three(m, a, RUSH)
    if b >= 0:
        u, v, w = three(m, b, RUSH)
        x, y, z = x - u, y - v, z - w
    return x * n[0] + y * n[1] + z * n[2]


@kernel
def _sum(touch, first, last, n, motion, ahead, law):
    """The law for each element of one pair: (touching, (energy in friction, in foundations, crushed, J), load on a, its
    lossy part).

    Both loads are six numbers: force and torque about the centre of body a. `ahead`: since the last call, s, and the
    speed that the pair will have gained by the middle of the kick, m/s.
    """
    marks, slots, (lapse, sooner) = touch.marks, touch.slots, ahead
    rigid, dashpot, mu, held, shear, (rolling, radius, own, strength), (inert, spot, about) = law
    count, stored, pressed, spent, tangential = 0, 0.0, 0.0, 0.0, math.sqrt(shear) * dashpot
    fx = fy = fz = tx = ty = tz = gx = gy = gz = ux = uy = uz = 0.0
    ox, oy, oz = motion[0]
    for slot in range(first, last + 1):
        area, depth = slots[slot, AREA], slots[slot, DEPTH]
        if depth <= 0.0:
            marks[slot, TOUCHING] = 0
            continue
        if own:
            n = three(slots, slot, NORMAL)
        x, y, z = slots[slot, POINT] - ox, slots[slot, POINT + 1] - oy, slots[slot, POINT + 2] - oz
        v = velocity_at(motion, x, y, z)
        before = slots[slot, CRUSHED] if marks[slot, TOUCHING] else 0.0
        depth, slots[slot, CRUSHED] = _elastic_depth(touch, slot, strength / rigid)
        if slots[slot, CRUSHED] > before:
            spent += strength * area * (slots[slot, CRUSHED] - before)
        speed = v[0] * n[0] + v[1] * n[1] + v[2] * n[2] + sooner
        normal, elastic = normal_force(rigid, dashpot, area, depth, speed, strength)
        s, roll, twist, age = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0
        if marks[slot, TOUCHING]:
            s, roll, twist, age = three(slots, slot, STRETCH), three(slots, slot, ROLL), slots[slot, TWIST], lapse
        slip, s, energy = friction_force(s, n, v, age, mu * normal, shear * rigid * area, tangential * area)
        slots[slot, STRETCH], slots[slot, STRETCH + 1], slots[slot, STRETCH + 2] = s
        marks[slot, TOUCHING] = 1
        if rolling > 0.0 and radius > 0.0:
            share = 2.25 * rolling * rolling
            stiff, drag = share * rigid * area, math.sqrt(share) * dashpot * area
            t, roll, more = rolling_torque(roll, n, motion[2], age, rolling * normal, radius, stiff, drag)
            slots[slot, ROLL], slots[slot, ROLL + 1], slots[slot, ROLL + 2] = roll
            energy += more
            tx, ty, tz = tx + t[0], ty + t[1], tz + t[2]
            ux, uy, uz = ux + t[0], uy + t[1], uz + t[2]
        if inert > 0.0:
            speed = motion[2][0] * n[0] + motion[2][1] * n[1] + motion[2][2] * n[2]
            t, slots[slot, TWIST], more = twisting_torque(twist, speed, age, spot * normal, about * area, inert * area)
            energy += more
            tx, ty, tz = tx + t * n[0], ty + t * n[1], tz + t * n[2]
            ux, uy, uz = ux + t * n[0], uy + t * n[1], uz + t * n[2]
        count, stored, pressed = count + 1, stored + energy, pressed + held * elastic * depth
        p, q, r = normal * n[0] + slip[0], normal * n[1] + slip[1], normal * n[2] + slip[2]
        fx, fy, fz = fx + p, fy + q, fz + r
        tx, ty, tz = tx + (y * r - z * q), ty + (z * p - x * r), tz + (x * q - y * p)
        p, q, r = p - elastic * n[0], q - elastic * n[1], r - elastic * n[2]
        gx, gy, gz = gx + p, gy + q, gz + r
        ux, uy, uz = ux + (y * r - z * q), uy + (z * p - x * r), uz + (x * q - y * p)
    return count, (stored, pressed, spent), (fx, fy, fz, tx, ty, tz), (gx, gy, gz, ux, uy, uz)


@kernel
def relative_motion(m, a, b, by):
    """Motion of body a against b (a body or a wall): (centre of a, velocity there, spin), each of three."""
    v, w = three(m, a, VELOCITY), three(m, a, SPIN)
    if b < 0:
        return three(m, a, POSITION), v, w
    (p, q, r), u, (x, y, z) = three(m, b, SPIN), three(m, b, VELOCITY), between(m, a, b, by)
    v = (v[0] - u[0] - (q * z - r * y), v[1] - u[1] - (r * x - p * z), v[2] - u[2] - (p * y - q * x))
    return three(m, a, POSITION), v, (w[0] - p, w[1] - q, w[2] - r)


@kernel
def velocity_at(motion, x, y, z):
    """Relative velocity at (x, y, z) from the centre of a `relative_motion`."""
    _, v, w = motion
    return v[0] + w[1] * z - w[2] * y, v[1] + w[2] * x - w[0] * z, v[2] + w[0] * y - w[1] * x


@kernel
def free_time(m, touch, which, dt):
    """A time, s, at most `dt`, in which no pair that is apart can touch; 0 if one overlaps."""
    pairs = touch.pairs
    least = dt
    for c in which:
        apart = normal_of(m, touch, c)[0]
        speed = speed_of(m, pairs[c, A], dt)
        if pairs[c, B] >= 0:
            speed += speed_of(m, pairs[c, B], dt)
        if apart <= 0.0:
            return 0.0
        if speed * least > apart:
            least = apart / speed
    return least
