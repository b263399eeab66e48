"""Tables of the pairs that may touch within one step, and of the contact elements with which they may.

Pairs, whole numbers by columns: A, B (rows of the table of bodies; -1 - w for wall w), FEATURE (the direction of the
normal), FIRST to MIDDLE (slots of the elements of a), MIDDLE to LAST (those of b), LAST itself (the crossing of two
edges, or where something round touches), KEY (a, then b; pairs are in its order). Beside them `shift` (n, 3), m, from b
to its periodic image next to a.

Slots, one per element that may touch: `marks`, whole numbers: SLOT_KEY of the pair, ELEMENT (its number in the pair),
INDEX (its row in the table of elements; -1: none, -2 - k: point k along the curved side), TOUCHING; `slots`: DEPTH, m,
AREA, m2, POINT, m, STRETCH and ROLL, m, TWIST, rad, of its springs of friction, of rolling and of twisting on the spot,
CRUSHED, m, how deep it has given way for good, NORMAL where one is a mesh.
Walls, rows of eleven: normal inwards, level (normal . x > level inside), the lowest and highest corner of where they
are, and WALL_MATERIAL.
"""

from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import inlined, kernel
from parsim.solid.separation import BALLS, ROUND_A, between, ramp_of, reach_along
from parsim.solid.shapes.forms import Forms
from parsim.solid.shapes.kernels import along_side
from parsim.solid.table import HALF, POSITION, pose_of, shape_of

A, B, FEATURE, FIRST, MIDDLE, LAST, KEY = range(7)
SLOT_KEY, ELEMENT, INDEX, TOUCHING = range(4)
DEPTH, AREA, POINT, STRETCH, ROLL, TWIST, CRUSHED, NORMAL = 0, 1, 2, 5, 8, 11, 12, 13
WIDTH = 16  # of slots; from STRETCH to NORMAL is what an element that touches keeps from step to step
WALL_MATERIAL = 10


class Touch(NamedTuple):
    """What may touch, and with what: the tables above; first, elements: see `shapes.elements_of`; law: its number;
    pair_law: see `forces.press`; tanks: see `tanks`; forms: see `shapes.forms`; springs: see
    `ties.Joints`; first_spring: of each row, and one more."""

    first: np.ndarray
    elements: np.ndarray
    walls: np.ndarray
    law: int
    pair_law: np.ndarray
    pairs: np.ndarray
    shift: np.ndarray
    marks: np.ndarray
    slots: np.ndarray
    tanks: np.ndarray
    forms: Forms
    springs: np.ndarray
    first_spring: np.ndarray


def room_for_pairs(count):
    """Empty tables of pairs and their shifts."""
    return np.zeros((count, 7), np.int64), np.zeros((count, 3))


def room_for_slots(count):
    """Empty tables of marks and slots."""
    return np.zeros((count, 4), np.int64), np.zeros((count, WIDTH))


@kernel
def above(m, touch, a, w):
    """Distance of body `a` from wall `w`."""
    walls = touch.walls
    x, y, z = walls[w, 0], walls[w, 1], walls[w, 2]
    centre = m[a, POSITION] * x + m[a, POSITION + 1] * y + m[a, POSITION + 2] * z
    return centre - reach_along(m, touch.forms, a, -x, -y, -z) - walls[w, 3]


def sort_pairs(pairs, shift, number):
    """Bring the first `number` pairs in the order of their keys, whatever order they were found in."""
    order = np.argsort(pairs[:number, KEY])
    pairs[:number] = pairs[:number][order]
    shift[:number] = shift[:number][order]


@kernel
def fill_slots(m, touch, number, reach):
    """List the elements of every pair that are within `reach`, m, of what they may touch; how many there are.

    Beyond the room in `slots` they are counted only. 10 ns an element of the bodies in a pair.
    """
    pairs, slot = touch.pairs, 0
    for c in range(number):
        a, b = pairs[c, A], pairs[c, B]
        own, spot = _watched(m, touch, a), ROUND_A <= pairs[c, FEATURE] <= BALLS
        pairs[c, FIRST] = slot
        if not spot:
            slot = _list(m, touch, c, (a, b, 0), reach, slot)
        pairs[c, MIDDLE] = slot
        if b >= 0:
            if not spot:
                slot = _list(m, touch, c, (b, a, own), reach, slot)
            own += _watched(m, touch, b)
        pairs[c, LAST] = slot
        slot = _mark(touch.marks, touch.slots, slot, pairs[c, KEY], own, -1)
    return slot


@inlined
def _watched(m, touch, b):
    """How many points of body `b` are watched: its elements, and those that move along its curved side."""
    return touch.first[b + 1] - touch.first[b] + along_side(shape_of(m, b))


@inlined
def _mark(marks, slots, slot, key, element, index):
    if slot < len(marks):
        marks[slot, SLOT_KEY], marks[slot, ELEMENT], marks[slot, INDEX], marks[slot, TOUCHING] = key, element, index, 0
        for k in range(WIDTH):
            slots[slot, k] = 0.0
    return slot + 1


@kernel
def _list(m, touch, c, which, reach, slot):
    """Note the elements of a body within reach of another (a body or a wall) from a number on: `which`."""
    first, elements, walls, marks, slots = touch.first, touch.elements, touch.walls, touch.marks, touch.slots
    body, other, offset = which
    key, sign = touch.pairs[c, KEY], 1.0 if body == touch.pairs[c, A] else -1.0
    (cx, cy, cz), t = pose_of(m, body, (0.0, 0.0, 0.0))
    if other < 0:
        w = walls[-1 - other]
        for index in range(first[body], first[body + 1]):
            x, y, z = to_global(t, elements[index, 0], elements[index, 1], elements[index, 2])
            x, y, z = x + cx, y + cy, z + cz
            near = w[0] * x + w[1] * y + w[2] * z - w[3] < reach and w[4] <= x <= w[7] and w[5] <= y <= w[8]
            if near and w[6] <= z <= w[9]:
                slot = _mark(marks, slots, slot, key, offset + index - first[body], index)
    else:
        by = (sign * touch.shift[c, 0], sign * touch.shift[c, 1], sign * touch.shift[c, 2])
        dx, dy, dz = between(m, body, other, by)
        s, far = pose_of(m, other, by)[1], reach + ramp_of(m, body, other)
        ox, oy, oz = to_body(s, dx, dy, dz)
        px, py, pz = to_body(s, t[0], t[3], t[6])  # from the frame of the one to that of the other, by columns
        qx, qy, qz = to_body(s, t[1], t[4], t[7])
        rx, ry, rz = to_body(s, t[2], t[5], t[8])
        wide, deep, high = m[other, HALF] + far, m[other, HALF + 1] + far, m[other, HALF + 2] + far
        for index in range(first[body], first[body + 1]):
            x, y, z = elements[index, 0], elements[index, 1], elements[index, 2]
            near = abs(ox + px * x + qx * y + rx * z) < wide and abs(oy + py * x + qy * y + ry * z) < deep
            if near and abs(oz + pz * x + qz * y + rz * z) < high:
                slot = _mark(marks, slots, slot, key, offset + index - first[body], index)
    for k in range(along_side(shape_of(m, body))):
        slot = _mark(marks, slots, slot, key, offset + first[body + 1] - first[body] + k, -2 - k)
    return slot


@kernel
def recall(marks, slots, count, key, element, memory):
    """Give the listed elements the `memory` they had when last they touched; both lists are in order of their keys."""
    old = 0
    for slot in range(count):
        pair, number = marks[slot, SLOT_KEY], marks[slot, ELEMENT]
        while old < key.size and (key[old] < pair or (key[old] == pair and element[old] < number)):
            old += 1
        if old < key.size and key[old] == pair and element[old] == number:
            marks[slot, TOUCHING] = 1
            slots[slot, STRETCH:NORMAL] = memory[old]
