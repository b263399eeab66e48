"""What the contact of a pair may give back: no more than was put into it.

Forces of contacts follow from the present geometry, and that jumps: elements come in at a rim, the normal changes to
another feature. Each pair therefore has a tank: the energy, J, that its forces have taken out of the motion and not
dissipated, at most the potential of its springs at the last two places. A kick of h changes the kinetic energy by
h F . v, v the mean of the velocities before and after it, exactly; where a pair's part of that would exceed its tank,
its forces become smaller. Kinetic energy and tanks together thus never grow, but by outside work, whatever the law,
the geometry and the sub-step. Such accounts are known from haptic interfaces (Hannaford & Ryu 2002,
doi 10.1109/70.988969).

A pair whose tank has run dry by such jumps still bears its load, without give: what comes closer stops, and what that
takes is lost. While it gave the speed back, kick by kick, stones of a heap rocked on such contacts for ever.

Columns of `tanks` (n, 26), a row per pair: STORED, J; LOST, dissipated of late, J, as friction springs and dashpots
only dissipate over several kicks; SHEAR, J, that of its friction springs, and LAPSE, s, by which their stretch is
behind the pose; BEFORE, NOW, potential at the last two places, J; SHEAR_BEFORE; WORK of the pair's forces in this kick,
J; LOADS and LOSSES (6 each), force and torque about the centre of body a, N and N m, and their dissipating part; SHARE
of its stiffness that a narrow contact has; BEND, RADIUS, m, and DEEP, m, of what touches: how it is curved
(`laws.law.FLAT` and so on), and how deep it is; SPENT, by crushing since the kick before, J; DRY, 1 where it stops what
comes closer in this kick.
"""

import math

import numpy as np

from parsim.geometry.rotation import scaled
from parsim.machine.jit import kernel
from parsim.solid.motion import answer, foresee
from parsim.solid.search import CRUSHED, FIRST, KEY, LAST, STRETCH, A, B
from parsim.solid.separation import between
from parsim.solid.table import (
    INVERSE,
    INVOLVED,
    LIGHT,
    LOAD,
    MEAN,
    ROLE,
    SPIN,
    STIRRED,
    VELOCITY,
    is_tied,
    three,
    turn_at,
)

STORED, LOST, SHEAR, LAPSE, BEFORE, NOW, SHEAR_BEFORE, WORK, LOADS, LOSSES = 0, 1, 2, 3, 4, 5, 6, 7, 8, 14
SHARE, BEND, RADIUS, DEEP, SPENT, DRY = 20, 21, 22, 23, 24, 25
KEPT = 4  # columns, the first, that last from step to step
ROUNDS, LAST_ROUND = 10, 100  # of making forces smaller that depend on each other: see `share_within`
_EMPTY = 1e-3  # of the energy that a pair's forces would give to bodies at rest, up to which its tank counts as dry
ROUNDING = 1e-12  # of the energy that a pair's forces would give to bodies at rest


def room_for_tanks(count):
    """Empty tanks of `count` pairs."""
    return np.zeros((count, 26))


@kernel
def recall_tanks(touch, number, key, stored):
    """Empty the first `number` tanks but for what is `stored` (n, KEPT) under their keys, in order."""
    pairs, tanks = touch.pairs, touch.tanks
    old = 0
    for c in range(number):
        tanks[c, :] = 0.0
        while old < key.size and key[old] < pairs[c, KEY]:
            old += 1
        if old < key.size and key[old] == pairs[c, KEY]:
            for k in range(KEPT):
                tanks[c, k] = stored[old, k]
            old += 1


@kernel
def load_pair(m, touch, c, potential, shear, loads, losses, spent):
    """Let pair `c`, whose springs hold `potential`, J, `shear` of it, act on its bodies; loads are six numbers each.

    spent: what it has crushed since it was last looked at, J.
    """
    tanks = touch.tanks
    tanks[c, SPENT], tanks[c, DRY] = tanks[c, SPENT] + spent, 0.0
    tanks[c, BEFORE], tanks[c, NOW] = tanks[c, NOW], potential
    tanks[c, SHEAR_BEFORE], tanks[c, SHEAR] = tanks[c, SHEAR], shear
    for k in range(6):
        tanks[c, LOADS + k], tanks[c, LOSSES + k] = loads[k], losses[k]
    _apply(m, touch, c, 1.0)


@kernel
def restrain(m, touch, which, rows, span):
    """Make loads smaller where in the coming kick of `span`, s, they would take more from a tank than it holds.

    Leaves the MEAN of all bodies; returns what the loads take out of the motion, J. `which`: pairs, of these rows.
    0.1 us a pair that touches, where nothing is too large.
    """
    pairs, shift, tanks = touch.pairs, touch.shift, touch.tanks
    for c in which:
        left, tanks[c, SPENT] = max(tanks[c, STORED] - tanks[c, SPENT], 0.0), 0.0
        tanks[c, STORED] = min(left, tanks[c, BEFORE] + tanks[c, NOW])
    for b in rows:
        m[b, STIRRED] = 0.0
    rounds, over = 0, True
    while over:
        over = False
        for b in rows:
            if m[b, STIRRED] == rounds:
                foresee(m, b, span)
        for c in which:
            if tanks[c, NOW] == 0.0 or not _stirred(m, pairs[c, A], pairs[c, B], rounds):
                continue
            tanks[c, WORK], own = _work(m, pairs, shift, tanks, c, LOADS, span)
            if tanks[c, WORK] > tanks[c, STORED] + ROUNDING * own:
                before = span * _power_before(m, touch, c)
                over, (share, dry) = True, share_within(tanks[c, WORK], own, tanks[c, STORED], before, rounds)
                tanks[c, DRY] = max(tanks[c, DRY], dry)
                _apply(m, touch, c, share - 1.0)
                _slacken(touch, c, share)
                for b in (pairs[c, A], pairs[c, B]):
                    if b >= 0 and m[b, ROLE] == INVOLVED:
                        m[b, STIRRED] = rounds + 1.0
        rounds += 1
    return _account(m, touch, which, span)


@kernel
def _stirred(m, a, b, rounds):
    """Whether the loads of a pair's bodies, or what they do, have changed since the round before."""
    return m[a, STIRRED] >= rounds or (b >= 0 and m[b, STIRRED] >= rounds)


@kernel
def _slacken(touch, c, share):
    """Leave pair `c` this share of its loads, and its friction springs the stretch that goes with theirs."""
    pairs, slots, tanks = touch.pairs, touch.slots, touch.tanks
    for k in range(LOADS, LOSSES + 6):
        tanks[c, k] *= share
    tanks[c, SHEAR] *= share * share
    for slot in range(pairs[c, FIRST], pairs[c, LAST] + 1):
        for k in range(STRETCH, CRUSHED):
            slots[slot, k] *= share


@kernel
def _account(m, touch, which, span):
    """Fill or drain the tanks by what the loads do in this kick; what they take out of the motion, J."""
    pairs, shift, tanks, taken = touch.pairs, touch.shift, touch.tanks, 0.0
    for c in which:
        if tanks[c, NOW] > 0.0:
            room = tanks[c, BEFORE] + tanks[c, NOW]
            lost = tanks[c, SHEAR_BEFORE] - tanks[c, SHEAR] - _work(m, pairs, shift, tanks, c, LOSSES, span)[0]
            there = tanks[c, STORED]
            if tanks[c, DRY] == 0.0 or tanks[c, WORK] > 0.0:
                there = max(there - tanks[c, WORK], 0.0)
            lost = min(max(lost, -tanks[c, LOST]), there)  # what was not there can't be lost, nor then be given back
            tanks[c, LOST] = min(tanks[c, LOST] + lost, room)
            tanks[c, STORED] = there - lost
            taken -= tanks[c, WORK]
    return taken


@kernel
def share_within(work, own, stored, before, rounds):
    """(largest share of loads whose work is `stored`, as share (work - own) + share^2 own, all in J; 1 if it is less).

    Where next to nothing is stored it is less: what comes closer, by what the loads would do at the motion `before` the
    kick, stops by its end.

    After ROUNDS a growing power of it, at least half: forces on both sides of a body, far too large, hold each other up
    and go down by little in each. Nothing after LAST_ROUND; when that was ROUNDS, three blocks deep in each other went
    on into each other.
    """
    if rounds >= LAST_ROUND:
        return 0.0, 0.0
    other = work - own
    root = math.sqrt(other * other + 4.0 * own * stored)
    share = 2.0 * stored / (root + other) if other > 0.0 else (root - other) / (2.0 * own)
    share *= max(share ** max(rounds - ROUNDS, 0), 0.5)
    stop = max(1.0 + (0.5 * before - work) / own, 0.0) if before < 0.0 and stored <= _EMPTY * own else math.inf
    return (stop, 1.0) if stop < share else (share, 0.0)


@kernel
def _power_before(m, touch, c):
    """Power of the loads of pair `c` at the motion before the kick, W."""
    pairs, f = touch.pairs, _six(touch.tanks, c, LOADS)
    a, b = pairs[c, A], pairs[c, B]
    power = _power_at(m, a, f, VELOCITY, SPIN)
    if b >= 0:
        power += _power_at(m, b, _reaction(m, a, b, three(touch.shift, c, 0), f), VELOCITY, SPIN)
    return power


@kernel
def _power_at(m, b, f, velocity, spin):
    """Power of the loads `f` on body `b` at the motion in these columns, W."""
    v, w = three(m, b, velocity), three(m, b, spin)
    return f[0] * v[0] + f[1] * v[1] + f[2] * v[2] + (f[3] * w[0] + f[4] * w[1] + f[5] * w[2])


@kernel
def _work(m, pairs, shift, tanks, c, at, span):
    """(work of the loads of pair `c` in a kick, what of it they would do on bodies at rest), J."""
    a, b, f = pairs[c, A], pairs[c, B], _six(tanks, c, at)
    power, answer = _power(m, a, f)
    if b >= 0:
        more, softer = _power(m, b, _reaction(m, a, b, three(shift, c, 0), f))
        power, answer = power + more, answer + softer
    return span * power, 0.5 * span * span * answer


@kernel
def _power(m, b, f):
    """(power of the loads `f` on body `b` at its MEAN, W; force times acceleration by them, W/s)."""
    power = _power_at(m, b, f, MEAN, MEAN + 3)
    if is_tied(m, b):
        (x, y, z), (p, q, r) = answer(m, b, f)
        return power, f[0] * x + f[1] * y + f[2] * z + (f[3] * p + f[4] * q + f[5] * r)
    x, y, z = scaled(turn_at(m, b), three(m, b, INVERSE), f[3], f[4], f[5])
    square = f[0] * f[0] + f[1] * f[1] + f[2] * f[2]
    return power, m[b, LIGHT] * square + (f[3] * x + f[4] * y + f[5] * z)


@kernel
def _six(tanks, c, at):
    return tanks[c, at], tanks[c, at + 1], tanks[c, at + 2], tanks[c, at + 3], tanks[c, at + 4], tanks[c, at + 5]


@kernel
def _reaction(m, a, b, by, f):
    """Load on body b, about its centre, that answers the load `f` on body a."""
    x, y, z = between(m, a, b, by)
    p, q, r = f[3] + (y * f[2] - z * f[1]), f[4] + (z * f[0] - x * f[2]), f[5] + (x * f[1] - y * f[0])
    return -f[0], -f[1], -f[2], -p, -q, -r


@kernel
def _apply(m, touch, c, share):
    """Add this share of the loads of pair `c` to those of its bodies."""
    pairs, f = touch.pairs, _six(touch.tanks, c, LOADS)
    a, b = pairs[c, A], pairs[c, B]
    for k in range(6):
        m[a, LOAD + k] += share * f[k]
    if b >= 0:
        g = _reaction(m, a, b, three(touch.shift, c, 0), f)
        for k in range(6):
            m[b, LOAD + k] += share * g[k]
