"""Tables of a heap, an island of nothing but balls and walls: taken over from those of all bodies, and handed back."""

import math
from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import unit
from parsim.machine.jit import kernel
from parsim.solid import blocks, search, table, tanks
from parsim.solid.balls import lightness, radius_of_both
from parsim.solid.blocks import (
    GIVEN,
    LANES,
    LOAD,
    QUATERNION,
    RADIUS,
    ROWS,
    SCRATCH,
    SOFT,
    TOTAL,
    INERT,
    V,
    W,
    X,
    height,
)
from parsim.solid.forces import coefficients
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

    rows (n,): of the table of bodies; row (bodies,): the other way; move, load (n + 1, 16): see `blocks`; kept (n + 1, 16):
    constant load, impulse of contacts, quaternion. Of the pairs that are near, whole blocks, those with walls last: a, b,
    balls; wall, -1: none; number, of the pair, -1: none; pair: see `blocks`. scratch; heat (64,), J; count (2,): blocks, of
    them without walls. law: (its number, curvature, rolling or not)."""

    rows: np.ndarray
    row: np.ndarray
    move: np.ndarray
    load: np.ndarray
    kept: np.ndarray
    a: np.ndarray
    b: np.ndarray
    wall: np.ndarray
    number: np.ndarray
    pair: np.ndarray
    scratch: np.ndarray
    heat: np.ndarray
    count: np.ndarray
    law: tuple


@kernel
def heap_of(m, touch, island):
    """The `Heap` of an island, nothing listed yet."""
    rows, _, which = island
    count, room = len(rows), (len(which) // LANES + 2) * LANES
    row, move, load = np.zeros(len(m), np.int64), np.zeros((count + 1, 16)), np.zeros((count + 1, 16))
    kept = np.zeros((count + 1, 16))
    for i, b in enumerate(rows):
        row[b] = i
        for k in range(3):
            move[i, X + k], move[i, V + k], move[i, W + k] = (
                m[b, table.POSITION + k],
                m[b, table.VELOCITY + k],
                m[b, table.SPIN + k],
            )
        for k in range(6):
            kept[i, GIVEN + k], kept[i, TOTAL + k] = m[b, table.GIVEN + k], m[b, table.TOTAL + k]
            load[i, LOAD + k] = m[b, table.LOAD + k]
        for k in range(4):
            kept[i, QUATERNION + k] = m[b, table.QUATERNION + k]
        move[i, RADIUS], move[i, SOFT], move[i, INERT] = m[b, table.HALF], m[b, table.LIGHT], m[b, table.INVERSE + 1]
    rolls = False
    for c in which:
        rolls = rolls or coefficients(m, touch, touch.pairs[c, A], touch.pairs[c, B])[4] > 0.0
    return Heap(
        rows,
        row,
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
def list_near(m, touch, heap, which, allowed):
    """List the pairs `which` that are nearer than `allowed`, m, balls before walls, with what is known of them."""
    count = 0
    for walls in (False, True):
        for c in which:
            a, b = heap.row[touch.pairs[c, A]], touch.pairs[c, B]
            if (b < 0) != walls:
                continue
            high = height(heap.move, a, touch.walls, -1 - b) if walls else _gap(heap, touch.shift, c, a, heap.row[b])
            if high < allowed:
                if count % LANES == 0:
                    heap.pair[count * ROWS : (count + LANES) * ROWS] = 0.0
                _note(m, touch, heap, c, count)
                count += 1
        while count % LANES:
            at = count // LANES * LANES * ROWS + count % LANES
            heap.a[count] = heap.b[count] = len(heap.rows)
            heap.wall[count] = heap.number[count] = -1
            heap.pair[at + blocks.ROUND] = heap.pair[at + blocks.LIGHT] = heap.pair[at + blocks.OWN] = 1.0
            count += 1
        heap.count[int(walls)] = count // LANES


@kernel
def _gap(heap, shift, c, a, b):
    """Distance, m, of the balls a and b of pair `c`."""
    x = heap.move[a, X] - heap.move[b, X] - shift[c, 0]
    y = heap.move[a, X + 1] - heap.move[b, X + 1] - shift[c, 1]
    z = heap.move[a, X + 2] - heap.move[b, X + 2] - shift[c, 2]
    return math.sqrt(x * x + y * y + z * z) - heap.move[a, RADIUS] - heap.move[b, RADIUS]


@kernel
def _note(m, touch, heap, c, j):
    """Take pair `c` over as the pair `j` of what is near."""
    (a, b), pair, at = (touch.pairs[c, A], touch.pairs[c, B]), heap.pair, j // LANES * LANES * ROWS + j % LANES
    slot, tank = touch.pairs[c, search.LAST], touch.tanks
    heap.number[j], heap.wall[j] = c, -1 - b
    heap.a[j], heap.b[j] = heap.row[a], (heap.row[b] if b >= 0 else len(heap.rows))
    pair[at + blocks.RA], pair[at + blocks.RB] = m[a, table.HALF], (m[b, table.HALF] if b >= 0 else 0.0)
    pair[at + blocks.ROUND], pair[at + blocks.LIGHT] = radius_of_both(m, a, b), lightness(m, a, b)
    own = coefficients(m, touch, a, b)
    (
        pair[at + blocks.OWN],
        pair[at + blocks.DAMPING],
        pair[at + blocks.MU],
        pair[at + blocks.SHEAR],
        pair[at + blocks.ROLLING],
    ) = own
    pair[at + blocks.TOUCHING] = float(touch.marks[slot, search.TOUCHING])
    for one, two in _KEPT:
        pair[at + one] = tank[c, two]
    for k in range(3):
        pair[at + blocks.BY + k * LANES], pair[at + blocks.SLIP + k * LANES] = (
            touch.shift[c, k],
            tank[c, tanks.LOADS + k],
        )
        pair[at + blocks.STRETCH + k * LANES] = touch.slots[slot, search.STRETCH + k]
        pair[at + blocks.ROLL + k * LANES] = touch.slots[slot, search.ROLL + k]


@kernel
def store(m, touch, heap):
    """Hand back what is known of the pairs that are near."""
    pair, tank = heap.pair, touch.tanks
    for j in range(heap.count[1] * LANES):
        c, at = heap.number[j], j // LANES * LANES * ROWS + j % LANES
        if c < 0:
            continue
        slot = touch.pairs[c, search.LAST]
        touch.marks[slot, search.TOUCHING], touch.slots[slot, search.DEPTH] = (
            int(pair[at + blocks.TOUCHING]),
            pair[at + blocks.DEEP],
        )
        for one, two in _KEPT:
            tank[c, two] = pair[at + one]
        for k in range(3):
            row = k * LANES
            tank[c, tanks.LOADS + k] = (
                pair[at + blocks.NORMAL] * pair[at + blocks.N + row] + pair[at + blocks.SLIP + row]
            )
            touch.slots[slot, search.STRETCH + k] = pair[at + blocks.STRETCH + row]
            touch.slots[slot, search.ROLL + k] = pair[at + blocks.ROLL + row]


@kernel
def hand_back(m, heap):
    """Hand pose, motion and impulses of all balls back to the table of bodies."""
    move, kept = heap.move, heap.kept
    for i, b in enumerate(heap.rows):
        for k in range(3):
            m[b, table.POSITION + k], m[b, table.VELOCITY + k], m[b, table.SPIN + k] = (
                move[i, X + k],
                move[i, V + k],
                move[i, W + k],
            )
        for k in range(6):
            m[b, table.TOTAL + k] = kept[i, TOTAL + k]
        q = unit((kept[i, QUATERNION], kept[i, QUATERNION + 1], kept[i, QUATERNION + 2], kept[i, QUATERNION + 3]))
        stand(m, b, q)
        update_momentum(m, b)
