"""What those that share the work of contacts tell each other: loads of pairs, islands that have moved, memory."""

import numpy as np

from parsim.machine.jit import inlined, kernel
from parsim.solid.balls import press_balls
from parsim.solid.forces import load_of, pull_and_date
from parsim.solid.motion import clear_loads, drift_involved, kick_involved
from parsim.solid.rates import longest_of, rate_of, rate_some
from parsim.solid.search import DEPTH, FEATURE, FIRST, LAST, NORMAL, STRETCH, TOUCHING, A, B
from parsim.solid.separation import BALLS
from parsim.solid.speeds import add_rate
from parsim.solid.substeps import span_of
from parsim.solid.table import POSITION, QUATERNION, TIED, TOTAL
from parsim.solid.tanks import KEPT, load_pair, restrain

LOADS = 16  # numbers of the load of a pair: elements that touch, two energies, load and lossy load on body a, crushed
RATES = 4  # of its rate: normal, square of a frequency
_BODY, _ISLAND, _GUEST = 25, 4, 6  # of a body that has moved, of its island, of a guest of that
_MEMORY = NORMAL - STRETCH
_SLOT = _MEMORY + 2


@kernel
def press_share(m, touch, rows, share, times, out):
    """Find the loads of the pairs `share` of an island of these rows, rows of `out` (n, LOADS); balls have none.

    times: see `forces.press`. What those loads lead to is for `take_loads`.
    """
    clear_loads(m, rows)
    for i, c in enumerate(share):
        out[i] = 0.0
        if touch.pairs[c, FEATURE] != BALLS:
            out[i, 0], out[i, 1], out[i, 2], force, loss, out[i, 15] = load_of(m, touch, c, times[0], times[1])
            for k in range(6):
                out[i, 3 + k], out[i, 9 + k] = force[k], loss[k]


@kernel
def take_loads(m, touch, island, found, times):
    """What is left of `forces.press` where the loads of the pairs of the island are `found` (pairs, LOADS)."""
    which = island[2]
    touching = press_balls(m, touch, which, times[0], times[1])
    for i, c in enumerate(which):
        if touch.pairs[c, FEATURE] != BALLS:
            load_pair(m, touch, c, found[i, 1], found[i, 2], _six(found, i, 3), _six(found, i, 9), found[i, 15])
            touching += int(found[i, 0])
    pull_and_date(m, touch, island, times[1])
    return touching


@kernel
def _six(table, i, at):
    return table[i, at], table[i, at + 1], table[i, at + 2], table[i, at + 3], table[i, at + 4], table[i, at + 5]


@kernel
def rate_share(m, touch, share, of, out):
    """Find the rates of the pairs `share`: rows of `out` (n, RATES); of: see `substeps.advance_islands`."""
    for i, c in enumerate(share):
        out[i] = 0.0
        if touch.pairs[c, FEATURE] != BALLS:
            (out[i, 0], out[i, 1], out[i, 2]), out[i, 3] = rate_of(m, touch, c, of[2], of[1])


@kernel
def take_rates(m, touch, island, found, steps_per_contact):
    """What is left of `rates.longest_step` where the rates of the pairs of the island are `found` (pairs, RATES)."""
    rate_some(m, touch, island, steps_per_contact)
    for i, c in enumerate(island[2]):
        if touch.pairs[c, FEATURE] != BALLS:
            n = found[i, 0], found[i, 1], found[i, 2]
            add_rate(m, touch.pairs[c, A], touch.pairs[c, B], n, found[i, 3])
    return longest_of(m, island, steps_per_contact)


@kernel
def begin_substep(m, touch, island, share, when, pressed, out):
    """Drift to the next kick, and find the loads of the pairs `share` there; its span, s. See `substeps.span_of`."""
    span = span_of(m, touch, island[2], when, pressed)
    ahead = when[2] + 0.5 * span
    drift_involved(m, island[0], ahead)
    press_share(m, touch, island[0], share, (ahead, span), out)
    return span


@kernel
def end_substep(m, touch, island, found, times):
    """Kick by the loads found: (elements that touch, energy taken out of the motion, work of what is driven, J)."""
    touching = take_loads(m, touch, island, found, times)
    taken = restrain(m, touch, island[2], island[0], times[1])
    dragged, work = kick_involved(m, island[0], times[1])
    return touching, taken + dragged, work


def sizes_of(islands):
    """How many numbers `carry` writes of each island, (islands,)."""
    own, guests = islands.own - islands.first, islands.last - islands.own
    return _ISLAND + _BODY * own + _GUEST * guests + KEPT * np.diff(islands.first_pair)


@kernel
def carry(m, touch, islands, some, notes, line, inward):
    """Write what has become of the islands `some` to the numbers `line`, or, `inward`, take it over from there."""
    at = 0
    for k in some:
        at = _copy(notes[1], k, 0, _ISLAND, (line, at, inward))
        for j in range(islands.first[k], islands.own[k]):
            b = islands.rows[j]
            at = _copy(m, b, POSITION, 9, (line, at, inward))
            at = _copy(m, b, QUATERNION, 4, (line, at, inward))
            at = _copy(m, b, TOTAL, 6, (line, at, inward))
            at = _copy(m, b, TIED, 6, (line, at, inward))
        for j in range(islands.own[k], islands.last[k]):
            at = _copy(notes[2], j, 0, _GUEST, (line, at, inward))
        for c in islands.pairs[islands.first_pair[k] : islands.first_pair[k + 1]]:
            at = _copy(touch.tanks, c, 0, KEPT, (line, at, inward))


@inlined
def _copy(table, row, first, count, to):
    """Copy columns of a row to or from a place in a line; the place behind it."""
    line, at, inward = to
    for k in range(count):
        if inward:
            table[row, first + k] = line[at + k]
        else:
            line[at + k] = table[row, first + k]
    return at + count


@kernel
def memory_of(touch, which):
    """What the elements of the pairs `which` that touch remember: slot, depth, m, and memory, (n, 9)."""
    count = 0
    for c in which:
        for slot in range(touch.pairs[c, FIRST], touch.pairs[c, LAST] + 1):
            count += touch.marks[slot, TOUCHING]
    out, i = np.empty((count, _SLOT)), 0
    for c in which:
        for slot in range(touch.pairs[c, FIRST], touch.pairs[c, LAST] + 1):
            if touch.marks[slot, TOUCHING]:
                out[i, 0], out[i, 1] = slot, touch.slots[slot, DEPTH]
                for k in range(_MEMORY):
                    out[i, 2 + k] = touch.slots[slot, STRETCH + k]
                i += 1
    return out


@kernel
def take_memory(touch, which, line):
    """Let the elements of the pairs `which` remember what a row of `memory_of`s says, and no other."""
    for c in which:
        for slot in range(touch.pairs[c, FIRST], touch.pairs[c, LAST] + 1):
            touch.marks[slot, TOUCHING] = 0
    for i in range(len(line) // _SLOT):
        slot, at = int(line[i * _SLOT]), i * _SLOT + 1
        touch.marks[slot, TOUCHING], touch.slots[slot, DEPTH] = 1, line[at]
        for k in range(_MEMORY):
            touch.slots[slot, STRETCH + k] = line[at + 1 + k]
