"""Islands: bodies that may touch each other within a step, directly or through others. Each moves by its own sub-steps.

What is driven or held joins no islands; it is a guest of all whose bodies may touch it.
"""

from typing import NamedTuple

import numpy as np

from parsim.machine.jit import kernel
from parsim.solid.search import A, B
from parsim.solid.table import INVOLVED, ROLE


class Islands(NamedTuple):
    """Of island k: rows[first[k]:own[k]], its bodies, and rows[own[k]:last[k]], its guests, rows of the table;
    pairs[first_pair[k]:first_pair[k + 1]]. All in order."""

    rows: np.ndarray
    first: np.ndarray
    own: np.ndarray
    last: np.ndarray
    pairs: np.ndarray
    first_pair: np.ndarray


@kernel
def islands_of(m, touch, number):
    """`Islands` of the first `number` pairs and of what springs pull, in the order of their first bodies."""
    island, total = _numbered(m, touch, number)
    pairs, of_pair = touch.pairs, np.empty(number, np.int64)
    first_pair, first = np.zeros(total + 1, np.int64), np.zeros(total + 1, np.int64)
    for b in range(len(m)):
        if island[b] >= 0:
            first[island[b] + 1] += 1
    for c in range(number):
        a, b = pairs[c, A], pairs[c, B]
        k = of_pair[c] = island[a] if m[a, ROLE] == INVOLVED else island[b]
        first_pair[k + 1] += 1
        first[k + 1] += (m[a, ROLE] != INVOLVED) + (b >= 0 and m[b, ROLE] != INVOLVED)
    first, first_pair = np.cumsum(first), np.cumsum(first_pair)
    rows, order = np.empty(first[total], np.int64), np.empty(number, np.int64)
    own, following = first[:total].copy(), first_pair.copy()
    for b in range(len(m)):
        if island[b] >= 0:
            rows[own[island[b]]] = b
            own[island[b]] += 1
    last = own.copy()
    for c in range(number):
        k = of_pair[c]
        order[following[k]] = c
        following[k] += 1
        for b in (pairs[c, A], pairs[c, B]):
            if b >= 0 and m[b, ROLE] != INVOLVED and b not in rows[own[k] : last[k]]:
                rows[last[k]] = b
                last[k] += 1
    return Islands(rows, first[:total], own, last, order, first_pair)


@kernel
def _numbered(m, touch, number):
    """(number of the island of each row, -1 of none; how many there are)."""
    pairs, tied, count = touch.pairs, touch.first_spring, len(m)
    root, island, total = np.arange(count), np.full(count, -1), 0
    for c in range(number):
        a, b = pairs[c, A], pairs[c, B]
        if b >= 0 and m[a, ROLE] == INVOLVED and m[b, ROLE] == INVOLVED:
            a, b = _root(root, a), _root(root, b)
            root[max(a, b)] = min(a, b)
    for b in range(count):
        if m[b, ROLE] == INVOLVED or tied[b + 1] > tied[b]:
            top = _root(root, b)
            if island[top] < 0:
                island[top], total = total, total + 1
            island[b] = island[top]
    return island, total


@kernel
def _root(root, b):
    """The least row of what `b` is joined to; shortens the way there."""
    top = b
    while root[top] != top:
        top = root[top]
    while root[b] != top:
        root[b], b = top, root[b]
    return top
