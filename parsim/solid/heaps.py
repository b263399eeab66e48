"""Heaps: islands of nothing but balls and walls, moved over a step in tables of their own, without what others need.

The same laws, the same order in time as in `substeps` and `tanks`. What is near enough to touch soon is listed anew
when something may have moved by half the way that was allowed for.
"""

import math

import numpy as np

from parsim.geometry.rotation import turn_of, turned
from parsim.machine.jit import kernel
from parsim.solid import blocks, table
from parsim.solid.blocks import (
    GIVEN,
    INERT,
    LANES,
    LOAD,
    MEAN,
    NOW,
    QUATERNION,
    RADIUS,
    ROWS,
    RUSH,
    SOFT,
    STORED,
    TOTAL,
    WORK,
    V,
    W,
    X,
)
from parsim.solid.forces import free_time
from parsim.solid.heap_tables import hand_back, heap_of, list_near, store
from parsim.solid.laws.law import SPOT
from parsim.solid.search import FEATURE
from parsim.solid.separation import BALLS
from parsim.solid.tanks import LAPSE, ROUNDING, share_within

_LIFE = 40  # sub-steps that a list of what is near is to last
_ROOM = 1e-3  # of the radius of the first ball, by which it reaches at least
_SMALL = 1e-3  # square of half an angle below which three terms give its sine and cosine to the last bit


@kernel
def is_heap(m, touch, island):
    """Whether an island is nothing but balls, free or held, and walls, and nothing of it is ever crushed."""
    rows, _, which = island
    alike = np.min(touch.pair_law[5]) == math.inf
    for b in rows:
        alike = alike and m[b, table.ROLE] != table.DRIVEN and touch.first_spring[b + 1] == touch.first_spring[b]
    for c in which:
        alike = alike and touch.pairs[c, FEATURE] == BALLS
    return alike


@kernel
def advance_heap(m, touch, island, dt, longest, touching):
    """Move a heap over `dt`, s, in sub-steps of `longest`, s, at most: (touching, sub-steps, energy it loses, J).

    `touching`: how many pairs do so at the start, where their forces are known; `island`: (rows, how many are its own,
    pairs).

    Measured for 10,000 balls at rest, 2.6 contacts each, vectors of 512 bits: 100 ns a ball and sub-step, of these 9 to
    move, 59 for forces (17 arithmetic, 22 to fetch balls and add loads), 28 for tanks, 4 of kicks; 4 ms for a list of
    what is near; 20 ms a step for pairs, first looks and what is remembered. By the tables of all bodies and pairs the
    same took 1200 ns, of these 710 for forces and 425 for tanks.
    """
    heap, which = heap_of(m, touch, island), island[2]
    rest, pending, steps, way, allowed = dt, 0.0, 0, 0.0, -1.0
    while rest > 0.0:
        count = max(math.ceil(rest / longest), 1)
        span = rest / count
        if touching == 0 and count > 1:
            hand_back(m, heap)
            span = min(max(span, free_time(m, touch, which, dt) - pending), rest)
        fastest = _drift(heap, pending + 0.5 * span)
        way += (pending + 0.5 * span) * fastest
        if not 2.0 * way <= allowed:
            allowed, way = max(2 * _LIFE * span * fastest, _ROOM * heap.move[0, RADIUS]), 0.0
            store(touch, heap)
            list_near(touch, heap, which, allowed)
        touching = _press(touch, heap, pending + 0.5 * span, span)
        _restrain(heap, span)
        _kick(heap, span)
        steps += 1
        rest, pending = (rest - span if span < rest else 0.0), 0.5 * span
    _drift(heap, pending)
    store(touch, heap)
    hand_back(m, heap)
    taken = 0.0
    for i in range(LANES):
        taken += heap.taken[i]
    for c in which:
        touch.tanks[c, LAPSE] = pending
    return touching, steps, taken


@kernel
def _drift(heap, dt):
    """Move and turn all balls over `dt`, s, and begin their loads anew; the largest speed of a centre, m/s."""
    move, load, kept, most = heap.move, heap.load, heap.kept, 0.0
    for i in range(len(heap.rows)):
        for k in range(3):
            move[i, X + k] += dt * move[i, V + k]
            move[i, RUSH + k] = move[i, SOFT] * (kept[i, GIVEN + k] + load[i, LOAD + k])
            load[i, LOAD + k] = load[i, LOAD + 3 + k] = 0.0
        most = max(most, move[i, V] * move[i, V] + move[i, V + 1] * move[i, V + 1] + move[i, V + 2] * move[i, V + 2])
        _turn(kept, i, dt * move[i, W], dt * move[i, W + 1], dt * move[i, W + 2])
    return math.sqrt(most)


@kernel
def _turn(kept, i, x, y, z):
    """Turn ball `i` by a rotation vector, rad; what is small by series, which cost a fifth."""
    s = 0.25 * (x * x + y * y + z * z)
    q = kept[i, QUATERNION], kept[i, QUATERNION + 1], kept[i, QUATERNION + 2], kept[i, QUATERNION + 3]
    if s < _SMALL:
        share = 0.5 - s * (1.0 / 12.0 - s * (1.0 / 240.0 - s / 10080.0))
        turn = 1.0 - s * (0.5 - s * (1.0 / 24.0 - s / 720.0)), share * x, share * y, share * z
    else:
        turn = turn_of(x, y, z)
    q = turned(turn, q)
    for k in range(4):
        kept[i, QUATERNION + k] = q[k]


@kernel
def _press(touch, heap, lapse, span):
    """Loads of all pairs on their balls; how many touch. See `forces.press`."""
    move, load, walls, s, touching = heap.move, heap.load, touch.walls, heap.scratch, 0
    for block in range(heap.count[1]):
        a, b, pair = _block(heap, block)
        if block < heap.count[0]:
            blocks.approach(move, a, b, pair, s)
        else:
            blocks.approach_walls(move, a, walls, heap.wall[block * LANES : (block + 1) * LANES], s)
        blocks.gather(move, a, b, s)
        blocks.respond(pair, s, heap.law[:2], lapse, span)
        if heap.law[2]:
            blocks.roll(pair, s, lapse, span)
        else:
            pair[blocks.TURN : blocks.TURN + 3 * LANES] = 0.0
        if heap.law[1] == SPOT:
            blocks.twist(pair, s, lapse, span)
        touching += blocks.load_balls(load, a, b, pair)
    return touching


@kernel
def _restrain(heap, span):
    """Let no pair take more from its tank in this kick than it holds: see `tanks.restrain`."""
    over = False
    for i in range(len(heap.rows)):
        _foresee(heap, i, span)
    for block in range(heap.count[1]):
        a, b, pair = _block(heap, block)
        blocks.work(heap.load, a, b, pair, heap.scratch, span)
        over = blocks.exceeds(pair) or over
    if over:
        _lessen(heap, span)
    for block in range(heap.count[1]):
        blocks.account(_block(heap, block)[2], heap.taken)


@kernel
def _block(heap, block):
    """Balls a and b and the rows of a block: views."""
    here = slice(block * LANES, (block + 1) * LANES)
    return heap.a[here], heap.b[here], heap.pair[block * LANES * ROWS : (block + 1) * LANES * ROWS]


@kernel
def _foresee(heap, i, span):
    """Set the MEAN of ball `i`: see `motion.foresee`."""
    move, load, kept, half = heap.move, heap.load, heap.kept, 0.5 * span
    for k in range(3):
        load[i, MEAN + k] = move[i, V + k] + half * move[i, SOFT] * (kept[i, GIVEN + k] + load[i, LOAD + k])
        turn = kept[i, GIVEN + 3 + k] + load[i, LOAD + 3 + k]
        load[i, MEAN + 3 + k] = move[i, W + k] + half * move[i, INERT] * turn


@kernel
def _lessen(heap, span):
    """Make loads smaller that would take more from their tanks than these hold."""
    load, last = heap.load, len(heap.rows)
    stirred, rounds, over = np.zeros(last + 1, np.int64), 0, True
    while over:
        over = False
        for block in range(heap.count[1]):
            a, b, pair = _block(heap, block)
            if rounds > 0:
                if not _any(stirred, a, b, rounds):
                    continue
                blocks.work(load, a, b, pair, heap.scratch, span)
            if not blocks.exceeds(pair):
                continue
            for i in range(LANES):
                p, q = a[i], b[i]
                if pair[i + NOW] == 0.0 or pair[i + WORK] <= pair[i + STORED]:
                    continue
                answer, power = blocks.answer_to(heap.move, p, q, pair, i)
                own = 0.5 * span * span * answer
                if pair[i + WORK] > pair[i + STORED] + ROUNDING * own:
                    share, dry = share_within(pair[i + WORK], own, pair[i + STORED], span * power, rounds)
                    pair[i + blocks.DRY] = max(pair[i + blocks.DRY], dry)
                    blocks.load_pair(load, p, q, pair, i, share - 1.0)
                    blocks.slacken(pair, i, share)
                    over, stirred[p], stirred[q] = True, rounds + 1, rounds + 1
        rounds += 1
        stirred[last] = 0  # walls
        for i in range(last):
            if stirred[i] == rounds:
                _foresee(heap, i, span)


@kernel
def _any(stirred, a, b, rounds):
    """Whether the loads of any ball of a block have changed in the round before."""
    found = False
    for i in range(LANES):
        found = found or stirred[a[i]] >= rounds or stirred[b[i]] >= rounds
    return found


@kernel
def _kick(heap, span):
    """Change the motion of all balls by their loads over `span`, s."""
    move, load, kept = heap.move, heap.load, heap.kept
    for i in range(len(heap.rows)):
        for k in range(3):
            move[i, V + k] += span * move[i, SOFT] * (kept[i, GIVEN + k] + load[i, LOAD + k])
            move[i, W + k] += span * move[i, INERT] * (kept[i, GIVEN + 3 + k] + load[i, LOAD + 3 + k])
            kept[i, TOTAL + k] += span * load[i, LOAD + k]
            kept[i, TOTAL + 3 + k] += span * load[i, LOAD + 3 + k]
