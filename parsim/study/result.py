"""What follows of the runs of a study that are there, by rows; as OUT/study.csv and OUT/study.json."""

from __future__ import annotations

import csv
import io
import json
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from parsim.output.frames import write_text
from parsim.study.plan import Edge, Sample, Search, Wanted
from parsim.study.runs import DONE, FAILED, NO_OUTCOME, RUNNING, STOPPED, WAITING, Runs, Seen
from parsim.study.statistics import Curve, Estimate, bootstrap, estimate, logistic
from parsim.study.table import Study, cells, numbers, varied

TABLE, SUMMARY = "study.csv", "study.json"


@dataclass(frozen=True)
class Row:
    """What the runs of one row say.

    estimate: probability of yes or mean of the numbers, None without any; quantiles in the order of the study's;
    edge: of a bisection; curve: logistic, where one is asked for and there is one; complete: nothing more is wanted.
    """

    number: int
    changes: tuple[str, ...]
    runs: list[tuple[Wanted, Seen]]
    complete: bool
    estimate: Estimate | None
    quantiles: tuple[Estimate, ...]
    edge: Edge | None = None
    curve: Curve | None = None

    @property
    def outcomes(self) -> list[float | bool]:
        """The outcomes there are, in the order of the runs."""
        return [seen.outcome for _, seen in self.runs if seen.outcome is not None]

    @property
    def label(self) -> str:
        """The row in words."""
        return ", ".join(self.changes) or "all runs"


@dataclass(frozen=True)
class Result:
    """All rows of a study, and the logistic curve over the one key that differs between them, where asked for."""

    study: Study
    rows: list[Row]
    key: str | None  # the number that differs between rows, or is searched
    curve: Curve | None

    @property
    def runs(self) -> list[tuple[Wanted, Seen]]:
        """All runs that have a number, or are wanted next, each once and by their numbers."""
        every = {seen.number or run.changes: (run, seen) for row in self.rows for run, seen in row.runs}
        return sorted(every.values(), key=lambda each: each[1].number or math.inf)

    @property
    def counts(self) -> Counter[str]:
        """How many runs there are of each state, those that are done without an outcome by themselves."""
        return Counter(
            NO_OUTCOME if seen.state == DONE and seen.outcome is None else seen.state for _, seen in self.runs
        )

    @property
    def complete(self) -> bool:
        """Whether no row wants more runs."""
        return all(row.complete for row in self.rows)

    @property
    def cut_short(self) -> bool:
        """Whether a row lacks runs that were stopped."""
        return any(seen.state == STOPPED for row in self.rows if not row.complete for _, seen in row.runs)

    def places(self) -> list[float]:
        """The number that differs between rows, (rows,); else their numbers."""
        values = numbers([list(row.changes) for row in self.rows]).get(self.key or "")
        return values or [float(row.number) for row in self.rows]


def result(study: Study, plans: Sequence[Sample | Search], runs: Runs) -> Result:
    """What follows of what is there."""
    rows = [_row(study, plan, runs) for plan in plans]
    key = study.bisection.key if study.bisection else varied(study.rows())
    found = Result(study, rows, key, None)
    if not study.fit or study.bisection:
        return found
    points = [(x, outcome) for x, row in zip(found.places(), rows, strict=True) for outcome in row.outcomes]
    return Result(study, rows, key, logistic(*zip(*points, strict=True)) if points else None)


def _row(study, plan, runs):
    search, wanted = isinstance(plan, Search), plan.wanted(runs.known)
    edge = plan.edge(runs.known) if search else None
    every = plan.asked(runs.known) if search else list(plan.runs())
    seen = [(run, runs.seen(run)) for run in every]
    seen = [(run, look) for run, look in seen if look.number or run in wanted]
    told = [look.outcome for _, look in seen if look.outcome is not None]
    numeric = bool(told) and not study.outcome.decides
    curve = None
    if study.fit and search:
        points = [(run.value, look.outcome) for run, look in seen if look.outcome is not None]
        curve = logistic(*zip(*points, strict=True)) if points else None
    return Row(
        plan.row,
        tuple(plan.changes),
        seen,
        not plan.wanted(runs.ended),
        estimate(told) if told and not search else None,
        bootstrap(tuple(told), tuple(study.quantiles))[1:] if numeric and not search else (),
        edge,
        curve,
    )


def write(found: Result, runs: Runs) -> None:
    """Write the tables of all runs and of what follows of them."""
    write_text(runs.out / TABLE, _table(found))
    write_text(runs.out / SUMMARY, json.dumps(summary(found), indent=1, allow_nan=False) + "\n")


def _table(found):
    keys, values = cells(run.changes for run, _ in found.runs)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["run", "row", *keys, "state", "outcome", "note"])
    for (run, seen), changed in zip(found.runs, values, strict=True):
        table.writerow([seen.number or "", run.row, *changed, seen.state, shown(seen.outcome), seen.note])
    return text.getvalue()


def shown(outcome: float | bool | None) -> str:
    """An outcome as text, exact."""
    if outcome is None:
        return ""
    return ("no", "yes")[outcome] if isinstance(outcome, bool) else repr(outcome)


def summary(found: Result) -> dict[str, Any]:
    """What study.json holds."""
    return {
        "complete": found.complete,
        "runs": {state: found.counts[state] for state in (DONE, NO_OUTCOME, FAILED, STOPPED, RUNNING, WAITING)},
        "curve": _curve(found.curve),
        "rows": [_summary(found, row) for row in found.rows],
    }


def _summary(found, row):
    told = {"row": row.number, "changes": list(row.changes), "complete": row.complete, "outcomes": len(row.outcomes)}
    if row.edge:
        low, high = sorted((row.edge.no, row.edge.yes))
        edge = {"no": row.edge.no, "yes": row.edge.yes, "low": low, "high": high}
        edge |= {"monotone": row.edge.monotone, "note": row.edge.note}
        return told | {"edge": edge, "curve": _curve(row.curve)}
    if found.study.outcome.decides:
        yes = sum(map(bool, row.outcomes))
        return told | {"yes": yes, "probability": _numbers(row.estimate)}
    shares = zip(found.study.quantiles, row.quantiles, strict=False)
    return told | {"mean": _numbers(row.estimate), "quantiles": [{"share": q} | _numbers(e) for q, e in shares]}


def _numbers(estimate):
    values = estimate._asdict() if estimate else dict.fromkeys(Estimate._fields)
    return {name: None if value is None or math.isnan(value) else value for name, value in values.items()}


def _curve(curve):
    return curve._asdict() if curve else None
