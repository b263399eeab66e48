"""Which runs a study wants next, from the outcomes that are there: functions of these alone, whoever runs them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from decimal import Decimal
from typing import NamedTuple

from parsim.study.statistics import estimate
from parsim.study.table import Study


class Wanted(NamedTuple):
    """One run of a study: how it changes the case, the row it belongs to, and what the bisection puts in."""

    changes: tuple[str, ...]
    row: int
    value: float | None = None


class Ended(NamedTuple):
    """A run that has come to an end; the outcome is None where it failed or has none."""

    outcome: float | bool | None


Known = Callable[[Wanted], Ended | None]  # how a run has ended; None: it has not


@dataclass
class Edge:
    """How far a bisection has come: where the outcome is no and yes, and what it needs next.

    `monotone`: whether a value beside the edge is as it should be, None where none was looked at. `note`: why it has
    ended without an edge.
    """

    no: float
    yes: float
    wanted: list[Wanted] = field(default_factory=list)
    monotone: bool | None = None
    note: str = ""


class Sample:
    """A row of runs that differ in their seed alone."""

    def __init__(self, study: Study, row: int, changes: list[str]) -> None:
        self._study, self.row, self.changes = study, row, changes

    def runs(self) -> Iterator[Wanted]:
        """All its runs, in their order."""
        return _repeats(self._study, self.row, self.changes)

    def first(self) -> list[Wanted]:
        """A run that shows whether those of the row are valid cases."""
        return [next(self.runs())]

    def enough(self, known: Known) -> bool:
        """Whether the first runs that have ended without a gap are, or were, enough by `seeds.within`."""
        seeds, outcomes = self._study.seeds, []
        if seeds is None or seeds.within is None:
            return False
        for run in self.runs():
            ended = known(run)
            if ended is None:
                break
            if ended.outcome is None:
                continue
            outcomes.append(ended.outcome)
            if len(outcomes) >= seeds.least and estimate(outcomes).half_width <= seeds.within:
                return True
        return False

    def wanted(self, known: Known) -> list[Wanted]:
        """The runs that are still to be made, the next one first."""
        return [] if self.enough(known) else [run for run in self.runs() if known(run) is None]


class Search:
    """A row whose key of the bisection is brought to its edge."""

    def __init__(self, study: Study, row: int, changes: list[str]) -> None:
        assert study.bisection is not None
        self._study, self._search, self.row, self.changes = study, study.bisection, row, changes

    @property
    def key(self) -> str:
        """The key whose edge is looked for."""
        return self._search.key

    def runs_at(self, value: float) -> Iterator[Wanted]:
        """The runs that may be made at a value of the key."""
        return _repeats(self._study, self.row, [*self.changes, f"{self._search.key}={value!r}"], value)

    def wanted(self, known: Known) -> list[Wanted]:
        """The runs that are to be made next; others follow from their outcomes."""
        return self.edge(known).wanted

    def first(self) -> list[Wanted]:
        """A run at each end and one amid, which show whether those of the row are valid cases."""
        ends = self._search.no, self._search.yes
        return [next(self.runs_at(value)) for value in (*ends, _between(*ends))]

    def asked(self, known: Known) -> list[Wanted]:
        """All runs that the search has looked at or wants next, by their values."""
        asked: dict[Wanted, None] = {}

        def noted(run: Wanted) -> Ended | None:
            asked[run] = None
            return known(run)

        self.edge(noted)
        return sorted(asked, key=lambda run: run.value or 0.0)

    def edge(self, known: Known) -> Edge:
        """How far the search has come.

        An end that comes near the edge is put to the vote again, with more runs; one that turns over goes to the
        other side, and the search is between it and the value before.
        """
        search, vote = self._search, _Votes(self, known)
        no, yes = [search.no], [search.yes]
        while True:
            gap = abs(yes[-1] - no[-1])
            votes = self._study.near_votes if gap <= search.near * search.width else search.votes
            edge = Edge(no[-1], yes[-1])
            ends = vote(edge, votes, no[-1], yes[-1])
            if ends is None:
                return edge
            turned = [
                value for value, end, was in zip((no[-1], yes[-1]), ends, (False, True), strict=True) if end != was
            ]
            sides = [side for side, end, was in zip((no, yes), ends, (False, True), strict=True) if end != was]
            if len(turned) == 2 or any(len(side) == 1 for side in sides):
                told = (f"{search.key} = {value!r} has the outcome {_word(value == no[-1])}" for value in turned)
                edge.note = f"no edge: {' and '.join(told)}"
                return edge
            if turned:
                (yes if sides[0] is no else no).append(sides[0].pop())
            elif gap <= search.width:
                return self._looked_beside(edge, no, yes, vote) if search.outside else edge
            else:
                middle = _between(no[-1], yes[-1])
                decided = vote(edge, votes, middle)
                if decided is None:
                    return edge
                (yes if decided[0] else no).append(middle)

    def _looked_beside(self, edge, no, yes, vote):
        """With one value outside of the edge looked at: amid the wider of the stretches beside it."""
        sides = [(abs(side[-1] - side[-2]), side is yes, side) for side in (no, yes) if len(side) > 1]
        _, expected, side = max(sides, key=lambda each: each[0])
        decided = vote(edge, self._search.votes, _between(side[-1], side[-2]))
        if decided:
            edge.monotone = decided[0] == expected
        edge.note = ""  # where that cannot be decided, the edge is there all the same
        return edge


class _Votes:
    """What majorities say of values; a value that was once put to more votes stays with them."""

    def __init__(self, plan: Search, known: Known) -> None:
        self._plan, self._known = plan, known
        self._most: dict[float, int] = {}

    def __call__(self, edge: Edge, votes: int, *values: float) -> list[bool] | None:
        """Whether each value has the outcome yes; None where that is open, for `edge.wanted` or `edge.note`."""
        found = []
        for value in values:
            self._most[value] = max(votes, self._most.get(value, 0))
            decided, pending = self._of(value, self._most[value])
            edge.wanted += pending
            if decided is None and not pending:
                key = self._plan.key
                edge.note = edge.note or f"{key} = {value!r}: too many runs have failed, or have no outcome, to decide"
            found.append(decided)
        return None if edge.wanted or edge.note else [decided is True for decided in found]

    def _of(self, value, votes):
        """(majority of `votes` runs at a value, or None; runs it needs); others take the place of runs that failed."""
        need, yes, no = votes // 2 + 1, 0, 0
        pending: list[Wanted] = []
        for number, run in enumerate(self._plan.runs_at(value)):
            if number >= 2 * votes or len(pending) >= need - max(yes, no):
                break
            ended = self._known(run)
            if ended is None:
                pending.append(run)
            elif ended.outcome is not None:
                yes, no = yes + bool(ended.outcome), no + (not ended.outcome)
        return (yes > no, []) if max(yes, no) >= need else (None, pending)


def _repeats(study, row, changes, value=None):
    seeds = study.seeds
    for number in range(1, study.repeats + 1):
        seed = [f"{seeds.key}={seeds.value(number)!r}"] if seeds else []
        yield Wanted((*changes, *seed), row, value)


def _between(a, b):
    return float((Decimal(repr(a)) + Decimal(repr(b))) / 2)


def _word(yes):
    return "yes" if yes else "no"


def plans(study: Study) -> list[Sample | Search]:
    """The plan of each row of a study."""
    kind = Search if study.bisection else Sample
    return [kind(study, number, changes) for number, changes in enumerate(study.rows(), 1)]
