"""How the work of contacts is shared out: whole islands, and the pairs of those that are too large for one."""

import heapq

import numpy as np

from parsim.machine.jit import kernel
from parsim.solid.search import FEATURE, FIRST, LAST, TOUCHING, B
from parsim.solid.separation import BALLS, CORES

TOGETHER = -1  # number of the part that moves an island whose pairs are shared out
_BALLS, _WALL, _PAIR = 3e-7, 7e-7, 4e-6  # s that a pair takes in a sub-step, about, and each of its elements more:
_ON_WALL, _ON_BODY = 5e-8, 1e-7  # once if it is listed, twice if it touches


@kernel
def costs_of(touch, islands, pace):
    """What all takes, about, s: (a sub-step of each pair, in the order of the islands; of each island; whether its
    pairs can be shared out, as it has others than balls; a step of each island).

    pace (rows,): how many sub-steps each body has taken last.
    """
    pairs, total = touch.pairs, len(islands.first)
    each, whole = np.empty(len(islands.pairs)), np.zeros(total)
    mixed, step = np.zeros(total, np.bool_), np.zeros(total)
    for k in range(total):
        for i in range(islands.first_pair[k], islands.first_pair[k + 1]):
            c = islands.pairs[i]
            each[i] = _BALLS
            if pairs[c, FEATURE] != BALLS:
                mixed[k], each[i] = True, _cost(touch, c)
            whole[k] += each[i]
        most = 1.0
        for b in islands.rows[islands.first[k] : islands.own[k]]:
            most = max(most, pace[b])
        step[k] = most * whole[k]
    return each, whole, mixed, step


@kernel
def _cost(touch, c):
    """The same of pair `c`, no balls: the farther it was from touching last, the less."""
    pairs, count = touch.pairs, 0
    for slot in range(pairs[c, FIRST], pairs[c, LAST] + 1):
        count += touch.marks[slot, TOUCHING]
    wall, listed = pairs[c, B] < 0, pairs[c, LAST] - pairs[c, FIRST]
    if count == 0:
        return _PAIR if pairs[c, FEATURE] == CORES and not wall else _WALL
    return _WALL + _ON_WALL * (listed + count) if wall else _PAIR + _ON_BODY * (listed + count)


@kernel
def note_pace(islands, told, pace):
    """Note how many sub-steps each body has taken; told: see `substeps.isolate`."""
    for k in range(len(islands.first)):
        for b in islands.rows[islands.first[k] : islands.own[k]]:
            pace[b] = told[k, 1]


def deal(costs, splits, count, uneven):
    """Which of `count` parts moves each island, or TOGETHER: (islands,).

    costs (islands,), s, of a step; splits (islands,) bool: which may be moved together. As few are as make the busiest
    take at most `uneven` times the mean.
    """
    order = np.argsort(-costs, kind="stable")
    owner, rest = np.full(len(costs), TOGETHER), order.tolist()
    bearable, each = (uneven - 1.0) * float(costs.sum()) / count, costs.tolist()
    while True:
        loads = [(0.0, part) for part in range(count)]
        for k in rest:
            load, part = loads[0]
            owner[k] = part
            heapq.heapreplace(loads, (load + each[k], part))
        most, mean = max(loads)[0], sum(load for load, _ in loads) / count
        largest = next((k for k in rest if splits[k]), None)
        if largest is None or most - mean <= bearable:
            return owner
        owner[largest] = TOGETHER
        rest.remove(largest)


def cuts(costs, count):
    """Ends of `count` runs of pairs that take about as long each, in their order: (count + 1,)."""
    sums = np.cumsum(costs)
    total = sums[-1] if len(sums) else 0.0
    inner = np.searchsorted(sums - 0.5 * costs, total * np.arange(1, count) / count)
    return np.concatenate([[0], inner, [len(costs)]]).astype(np.int64)
