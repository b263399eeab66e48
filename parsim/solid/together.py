"""Moving bodies together with others who hold the same ones: each finds its part of the contacts and tells it.

Small islands are dealt out whole; a large one is moved by all, who share out its pairs in every sub-step. Whoever finds
something, it is added up in the order of `substeps`: the bits do not hang on who does what, or on how many there are.
"""

import numpy as np

from parsim.solid.deal import TOGETHER, costs_of, cuts, deal, note_pace
from parsim.solid.parcels import (
    LOADS,
    RATES,
    begin_substep,
    carry,
    end_substep,
    memory_of,
    press_share,
    rate_share,
    sizes_of,
    take_loads,
    take_memory,
    take_rates,
)
from parsim.solid.search import FEATURE
from parsim.solid.separation import BALLS
from parsim.solid.substeps import advance, advance_islands, come_to_end, conclude, enter, isolate, leave

_BY_ALL = -1  # of pairs that every part finds


class Together:
    """Advances all bodies over a step; `shares`: see `Contacts`."""

    def __init__(self, shares):
        self._shares, self._pace = shares, np.ones(0)

    def advance(self, m, touch, number, of):
        """What `substeps.advance` returns; of: step, s, reach, m, and steps_per_contact."""
        if self._shares is None:
            return advance(m, touch, number, *of)
        if len(self._pace) != len(m):
            self._pace = np.ones(len(m))
        islands, notes = isolate(m, touch, number, of[0])
        each, whole, mixed, step = costs_of(touch, islands, self._pace)
        if step.sum() < self._shares.least:
            advance_islands(m, touch, islands, np.arange(len(step)), of, notes)
        else:
            owner = deal(step, mixed & (whole >= self._shares.least), self._shares.count, self._shares.uneven)
            self._advance(m, touch, islands, (of, notes), (each, owner))
        note_pace(islands, notes[1], self._pace)
        return conclude(m, islands, of[0], notes)

    def _advance(self, m, touch, islands, given, dealt):
        """Move all islands; given: `of` and `notes` of a step; dealt: costs of pairs, who moves which island."""
        (of, notes), (each, owner), own = given, dealt, self._shares.own
        finder = np.repeat(owner, np.diff(islands.first_pair))
        for k in np.flatnonzero(owner == TOGETHER):
            here = slice(islands.first_pair[k], islands.first_pair[k + 1])
            ends = cuts(each[here], self._shares.count)
            finder[here] = np.repeat(np.arange(len(ends) - 1), np.diff(ends))
            finder[here][touch.pairs[islands.pairs[here], FEATURE] == BALLS] = _BY_ALL
            self._move(m, touch, islands, k, given, ends)
        advance_islands(m, touch, islands, np.flatnonzero(owner == own), of, notes)
        if (owner != TOGETHER).any():
            self._tell(m, touch, islands, notes, owner)
        rows = memory_of(touch, islands.pairs[finder == own])
        take_memory(touch, islands.pairs[finder != _BY_ALL], self._shares.gather_any(rows))

    def _move(self, m, touch, islands, k, given, ends):
        """Move island `k`, whose pairs are shared out at these `ends`, as `substeps._advance` does."""
        (of, notes), shares, numbers = given, self._shares, np.diff(ends)
        island, (dt, _, steps_per_contact) = enter(m, islands, k, notes), of
        share = island[2][ends[shares.own] : ends[shares.own + 1]]

        def all_of(found):
            return shares.gather(found, numbers * found.shape[1]).reshape(-1, found.shape[1])

        taken, steps, work, out = 0.0, 0, 0.0, np.empty((len(share), LOADS))
        press_share(m, touch, island[0], share, (0.0, 0.0), out)
        touching = take_loads(m, touch, island, all_of(out), (0.0, 0.0))
        rates = np.empty((len(share), RATES))
        rate_share(m, touch, share, of, rates)
        longest, on_springs = take_rates(m, touch, island, all_of(rates), steps_per_contact)
        rest, pending = dt, 0.0
        while rest > 0.0:
            pressed = touching > 0 or on_springs
            span = begin_substep(m, touch, island, share, (dt, rest, pending, longest), pressed, out)
            times = pending + 0.5 * span, span
            touching, more, by_driven = end_substep(m, touch, island, all_of(out), times)
            taken, work, steps = taken + more, work + by_driven, steps + 1
            rest, pending = (rest - span if span < rest else 0.0), 0.5 * span
        come_to_end(m, touch, island, pending)
        leave(m, islands, k, (touching, steps, taken, work), notes)

    def _tell(self, m, touch, islands, notes, owner):
        """Tell each other what has become of the islands that each has moved."""
        sizes, shares = sizes_of(islands), self._shares
        parts = [np.flatnonzero(owner == part) for part in range(shares.count)]
        counts = [int(sizes[some].sum()) for some in parts]
        line = np.empty(counts[shares.own])
        carry(m, touch, islands, parts[shares.own], notes, line, False)
        carry(m, touch, islands, np.concatenate(parts), notes, shares.gather(line, counts), True)
