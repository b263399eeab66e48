"""Tables of a heap, an island of nothing but balls and walls: taken over from those of all bodies, and handed back."""

import math
from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import unit
from parsim.machine.jit import inlined, kernel
from parsim.solid import blocks, search, table, tanks
from parsim.solid.balls import radius_of_both
from parsim.solid.blocks import (
    GIVEN,
    INERT,
    LANES,
    LOAD,
    MATERIAL,
    QUATERNION,
    RADIUS,
    ROWS,
    SCRATCH,
    SOFT,
    TOTAL,
    V,
    W,
    X,
    height,
)
from parsim.solid.laws.law import LINE, SPOT
from parsim.solid.motion import stand, update_momentum
from parsim.solid.search import A, B

_KEPT = (
    (blocks.LAPSE, tanks.LAPSE),
    (blocks.STORED, tanks.STORED),
    (blocks.LOST, tanks.LOST),
    (blocks.SHEARED, tanks.SHEAR),
    (blocks.NOW, tanks.NOW),
)


class Heap(NamedTuple):
    """Tables of n balls, and of one row more that walls stand for, which stays at rest.

    rows (n,): of the table of bodies; ends (pairs, 2): a and b of all pairs as rows of these tables; move, load, kept
    (n + 1, 16): see `blocks`. Of the pairs that are near, whole blocks, those with walls last: a, b, balls; wall, < 0:
    none; number, of the pair, -1: none; pair: their blocks. scratch: of one block; taken (64,), J; count (2,): blocks
    without walls, all. law: (its number, curvature, rolling or not)."""

    rows: np.ndarray
    ends: np.ndarray
    move: np.ndarray
    load: np.ndarray
    kept: np.ndarray
    a: np.ndarray
    b: np.ndarray
    wall: np.ndarray
    number: np.ndarray
    pair: np.ndarray
    scratch: np.ndarray
    taken: np.ndarray
    count: np.ndarray
    law: tuple


@kernel
def heap_of(m, touch, island):
    """The `Heap` of an island, nothing listed yet."""
    rows, _, which = island
    count, room = len(rows), (len(which) // LANES + 2) * LANES
    move, load, kept = np.zeros((count + 1, 16)), np.zeros((count + 1, 16)), np.zeros((count + 1, 16))
    for i, b in enumerate(rows):
        m[b, table.STIRRED] = i
        for k in range(3):
            move[i, X + k], move[i, V + k] = m[b, table.POSITION + k], m[b, table.VELOCITY + k]
            move[i, W + k] = m[b, table.SPIN + k]
        for k in range(6):
            kept[i, GIVEN + k], kept[i, TOTAL + k] = m[b, table.GIVEN + k], m[b, table.TOTAL + k]
            load[i, LOAD + k] = m[b, table.LOAD + k]
        for k in range(4):
            kept[i, QUATERNION + k] = m[b, table.QUATERNION + k]
        move[i, RADIUS], move[i, SOFT], move[i, INERT] = m[b, table.HALF], m[b, table.LIGHT], m[b, table.INVERSE + 1]
        move[i, MATERIAL] = m[b, table.MATERIAL]
    ends = np.empty((len(which), 2), np.int64)
    for k, c in enumerate(which):
        a, b = touch.pairs[c, A], touch.pairs[c, B]
        ends[k, 0], ends[k, 1] = int(m[a, table.STIRRED]), (int(m[b, table.STIRRED]) if b >= 0 else count)
    rolls = np.max(touch.pair_law[4]) > 0.0
    return Heap(
        rows,
        ends,
        move,
        load,
        kept,
        np.empty(room, np.uint32),
        np.empty(room, np.uint32),
        np.empty(room, np.int64),
        np.empty(room, np.int64),
        np.empty(room * ROWS),
        np.zeros(SCRATCH),
        np.zeros(LANES),
        np.zeros(2, np.int64),
        (touch.law, LINE if touch.forms.planar else SPOT, rolls),
    )


@kernel
def list_near(touch, heap, which, allowed):
    """List the pairs `which` that are nearer than `allowed`, m, balls before walls, with what is known of them."""
    pairs, last, count = touch.pairs, len(heap.rows), 0
    for walls in (False, True):
        for k, c in enumerate(which):
            a, b, w = heap.ends[k, 0], heap.ends[k, 1], -1 - pairs[c, B]
            if (b == last) == walls:
                high = height(heap.move, a, touch.walls, w) if walls else _gap(heap.move, touch.shift, c, a, b)
                if high < allowed:
                    heap.a[count], heap.b[count], heap.number[count], heap.wall[count] = a, b, c, w
                    count += 1
        while count % LANES:
            heap.a[count], heap.b[count], heap.number[count], heap.wall[count] = last, last, -1, -1
            count += 1
        heap.count[int(walls)] = count // LANES
    heap.pair[: count * ROWS] = 0.0
    _take_over(touch, heap, count)


@inlined
def _gap(move, shift, c, a, b):
    """Distance, m, of the balls a and b of pair `c`."""
    x = move[a, X] - move[b, X] - shift[c, 0]
    y = move[a, X + 1] - move[b, X + 1] - shift[c, 1]
    z = move[a, X + 2] - move[b, X + 2] - shift[c, 2]
    return math.sqrt(x * x + y * y + z * z) - move[a, RADIUS] - move[b, RADIUS]


@kernel
def _take_over(touch, heap, count):
    """Take over what is known of the first `count` pairs that are near; what only fills a block is harmless."""
    move, pair, tank, law, slots = heap.move, heap.pair, touch.tanks, touch.pair_law, touch.slots
    for j in range(count):
        a, b, c, at = heap.a[j], heap.b[j], heap.number[j], j // LANES * LANES * ROWS + j % LANES
        if c < 0:
            pair[at + blocks.ROUND] = pair[at + blocks.LIGHT] = pair[at + blocks.OWN] = 1.0
            continue
        one, two, w = move[a, RADIUS], move[b, RADIUS], heap.wall[j]
        pair[at + blocks.RA], pair[at + blocks.RB], pair[at + blocks.ROUND] = one, two, radius_of_both(one, two)
        pair[at + blocks.LIGHT] = move[a, SOFT] + move[b, SOFT]
        p, q = int(move[a, MATERIAL]), int(touch.walls[w, search.WALL_MATERIAL] if w >= 0 else move[b, MATERIAL])
        for k in range(5):
            pair[at + blocks.OWN + k * LANES] = law[k, p, q]
        slot = touch.pairs[c, search.LAST]
        pair[at + blocks.TOUCHING] = touch.marks[slot, search.TOUCHING]
        for k in range(len(_KEPT)):
            pair[at + _KEPT[k][0]] = tank[c, _KEPT[k][1]]
        pair[at + blocks.TWIST] = slots[slot, search.TWIST]
        for k in range(3):
            row = at + k * LANES
            pair[row + blocks.BY], pair[row + blocks.SLIP] = touch.shift[c, k], tank[c, tanks.LOADS + k]
            pair[row + blocks.STRETCH] = slots[slot, search.STRETCH + k]
            pair[row + blocks.ROLL] = slots[slot, search.ROLL + k]


@kernel
def store(touch, heap):
    """Hand back what is known of the pairs that are near."""
    pair, tank, slots = heap.pair, touch.tanks, touch.slots
    for j in range(heap.count[1] * LANES):
        c, at = heap.number[j], j // LANES * LANES * ROWS + j % LANES
        if c < 0:
            continue
        slot = touch.pairs[c, search.LAST]
        touch.marks[slot, search.TOUCHING] = int(pair[at + blocks.TOUCHING])
        slots[slot, search.DEPTH] = pair[at + blocks.DEEP]
        for k in range(len(_KEPT)):
            tank[c, _KEPT[k][1]] = pair[at + _KEPT[k][0]]
        slots[slot, search.TWIST] = pair[at + blocks.TWIST]
        for k in range(3):
            row = at + k * LANES
            tank[c, tanks.LOADS + k] = pair[at + blocks.NORMAL] * pair[row + blocks.N] + pair[row + blocks.SLIP]
            slots[slot, search.STRETCH + k] = pair[row + blocks.STRETCH]
            slots[slot, search.ROLL + k] = pair[row + blocks.ROLL]


@kernel
def hand_back(m, heap):
    """Hand pose, motion and impulses of all balls back to the table of bodies."""
    move, kept = heap.move, heap.kept
    for i, b in enumerate(heap.rows):
        for k in range(3):
            m[b, table.POSITION + k], m[b, table.VELOCITY + k] = move[i, X + k], move[i, V + k]
            m[b, table.SPIN + k] = move[i, W + k]
        for k in range(6):
            m[b, table.TOTAL + k] = kept[i, TOTAL + k]
        q = unit((kept[i, QUATERNION], kept[i, QUATERNION + 1], kept[i, QUATERNION + 2], kept[i, QUATERNION + 3]))
        stand(m, b, q)
        update_momentum(m, b)
