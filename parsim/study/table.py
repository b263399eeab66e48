"""The table `study` of a case file: what is varied, what is asked of each run, when it is enough."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from parsim.case import file, runs_table
from parsim.case.messages import validated
from parsim.case.types import Count, Positive, Real, Share, Table, Whole
from parsim.errors import InputError
from parsim.study.outcomes import Outcome, Text

MOST = 10**5  # runs of a study
_FINEST = 1e-6  # width of an edge over the bracket it is looked for in
Value = Whole | Real
Votes = Annotated[Whole, Field(ge=1, le=99)]


class Seeds(Table):
    """A key that differs from run to run, and how many runs there are."""

    key: Text = Field(description="key of the case that differs from run to run, such as water.disorder")
    first: Value = Field(1, description="its value in the first run")
    step: Value = Field(1, description="what each further run adds to it")
    most: Count = Field(20, description="runs, at most")
    least: Count = Field(10, description="runs before `within` may end the study")
    within: Positive | None = Field(
        None, description="half width of the 95 % interval of the probability, or of the mean, that is enough"
    )

    def value(self, number: int) -> int | float:
        """The value in run `number`, from 1."""
        if isinstance(self.first, int) and isinstance(self.step, int):
            return self.first + (number - 1) * self.step
        return float(Decimal(repr(self.first)) + (number - 1) * Decimal(repr(self.step)))


class Bisection(Table):
    """The search for the value of a key at which the outcome turns from no to yes."""

    key: Text = Field(description="key of the case whose edge is looked for")
    no: Real = Field(description="value with the outcome no")
    yes: Real = Field(description="value with the outcome yes")
    width: Positive = Field(description="distance between no and yes that is enough")
    votes: Votes = Field(1, description="runs at each value, whose majority decides; an odd number")
    near_votes: Votes | None = Field(
        None, description="the same near the edge; left out: 3, or votes if that is more, or 1 where there are no seeds"
    )
    near: Positive = Field(4.0, description="how many widths between no and yes are near the edge")
    outside: bool = Field(True, strict=True, description="whether one value beside the edge is looked at in the end")


class Study(Table):
    """What is varied, and what is asked of each run."""

    outcome: Outcome = Field(description="what is asked of each finished run")
    seeds: Seeds | None = Field(None, description="a key that differs from run to run; left out: one run of each")
    table: Text | None = Field(None, description="CSV: the first line names keys, each further line is a row of runs")
    grid: dict[Text, tuple[Any, ...]] = Field({}, description="lists of values by key; all combinations are rows")
    bisection: Bisection | None = Field(None, description="a key whose edge is looked for, in each row")
    quantiles: tuple[Share, ...] = Field((0.1, 0.5, 0.9), description="quantiles of an outcome that is a number")
    fit: Literal["logistic"] | None = Field(
        None, description="curve of the probability over the one key that varies; left out: none"
    )

    def rows(self) -> list[list[str]]:
        """The changes "key=value" of each row, one without changes where nothing but seeds is given."""
        if self.table is not None:
            return runs_table.rows(self.table)
        keys = list(self.grid)
        return [
            [f"{key}={file.inline(value)}" for key, value in zip(keys, values, strict=True)]
            for values in itertools.product(*self.grid.values())
        ]

    @property
    def repeats(self) -> int:
        """Runs of one row, or at most at one value of a bisection."""
        return self.seeds.most if self.seeds else 1

    @property
    def near_votes(self) -> int:
        """Runs at each value of a bisection near its edge."""
        given, votes = (self.bisection.near_votes, self.bisection.votes) if self.bisection else (None, 1)
        return given or (max(votes, min(3, self.repeats - (self.repeats + 1) % 2)) if self.seeds else 1)


class _Root(Table):
    study: Study


def read(path: Path) -> Study:
    """The study in a case file, checked by itself. Raises InputError with every fault found."""
    data = file.read(path)
    if "study" not in data:
        raise InputError(
            f"{path}: holds no [study]; write one into the case, or into a file of its own with "
            'extends = "CASE.toml", as `parsim schema` describes'
        )
    root, messages = validated(_Root, {"study": data["study"]})
    messages += _faults(root.study)
    if messages:
        raise InputError(messages)
    return root.study


def _faults(study):
    """What is wrong with keys that belong together."""
    told = []
    if study.table is not None and study.grid:
        told.append("study.table and study.grid: give one of them")
    told += [f"study.grid.{key}: must have at least one value" for key, values in study.grid.items() if not values]
    told += [f"study.grid: {key!r} is no key of a case" for key in study.grid if not all(key.split("."))]
    if not (study.seeds or study.table or study.grid or study.bisection):
        told.append("study: varies nothing; give seeds, table, grid or bisection")
    if study.seeds:
        told += _of_seeds(study.seeds)
    if study.bisection:
        told += _of_bisection(study, study.bisection)
    combinations = math.prod(map(len, study.grid.values()))
    if combinations > MOST:
        told.append(f"study.grid: makes {combinations} rows; at most {MOST}")
    if told:
        return told
    rows = study.rows()
    first: dict[tuple[str, ...], int] = {}
    for number, row in enumerate(rows, 1):
        if (same := first.setdefault(tuple(sorted(row)), number)) < number:
            told.append(f"study: rows {same} and {number} are the same, {', '.join(row)}; each must be there once")
    keys = [change.partition("=")[0] for change in rows[0]] if study.table is None else cells(rows)[0]
    keys += [part.key for part in (study.seeds, study.bisection) if part]
    told += [f"study: {key} is varied twice" for key in dict.fromkeys(keys) if keys.count(key) > 1]
    if study.fit and not (study.bisection or varied(rows)):
        told.append(f"study.fit = {study.fit!r}: needs one key that varies: a bisection, or one column of numbers")
    if study.fit and not study.outcome.decides:
        told.append(f"study.fit = {study.fit!r}: needs an outcome that is yes or no; give above or below")
    if len(rows) * study.repeats > MOST:
        told.append(f"study: {len(rows)} rows with {study.repeats} runs each; at most {MOST} runs")
    return told


def cells(rows: Iterable[Sequence[str]]) -> tuple[list[str], list[list[str]]]:
    """The keys that any of the changes "key=value" name, once, and their values in each row, "" where it has none."""
    tables = [dict(change.split("=", 1) for change in row) for row in rows]
    keys = list(dict.fromkeys(key for table in tables for key in table))
    return keys, [[table.get(key, "") for key in keys] for table in tables]


def varied(rows: list[list[str]]) -> str | None:
    """The key that differs between rows, if it is the only one and a number in each of them."""
    keys, values = cells(rows)
    differ = [key for key, column in zip(keys, zip(*values, strict=True), strict=True) if len(set(column)) > 1]
    return differ[0] if len(differ) == 1 and differ[0] in numbers(rows) else None


def numbers(rows: list[list[str]]) -> dict[str, list[float]]:
    """{key: its value in each row} of the keys that are a number in every row."""
    keys, values = cells(rows)
    found = {}
    for key, column in zip(keys, zip(*values, strict=True), strict=True):
        try:
            found[key] = list(map(float, column))
        except ValueError:
            continue
    return found


def _of_seeds(seeds):
    told = []
    if seeds.step == 0 and seeds.most > 1:
        told.append("study.seeds.step = 0: all runs would be the same; must not be zero")
    if seeds.within is not None and seeds.least > seeds.most:
        told.append(
            f"study.seeds.least = {seeds.least}: must be at most study.seeds.most, {seeds.most}, or within ends nothing"
        )
    if not all(seeds.key.split(".")):
        told.append(f"study.seeds.key = {seeds.key!r}: must be a key of the case, such as water.disorder")
    return told


def _of_bisection(study, search):
    told = []
    if search.no == search.yes:
        told.append(f"study.bisection.yes = {search.yes!r}: must not be the value of no")
    elif not _FINEST <= search.width / abs(search.yes - search.no) < 1.0:
        told.append(
            f"study.bisection.width = {search.width!r}: must be less than the distance between no and yes, "
            f"{abs(search.yes - search.no):g}, and at least {_FINEST:g} of it"
        )
    for name, votes in (("votes", search.votes), ("near_votes", search.near_votes)):
        if votes is not None and votes % 2 == 0:
            told.append(f"study.bisection.{name} = {votes}: must be odd, so that there is a majority")
        if votes is not None and votes > study.repeats:
            few = f"at most study.seeds.most, {study.repeats}" if study.seeds else "1, for there are no study.seeds"
            told.append(f"study.bisection.{name} = {votes}: must be {few}")
    if search.near_votes is not None and search.near_votes < search.votes:
        told.append(
            f"study.bisection.near_votes = {search.near_votes}: must be at least study.bisection.votes, {search.votes}"
        )
    if not study.outcome.decides:
        told.append("study.bisection: needs an outcome that is yes or no; give study.outcome.above or below")
    if study.seeds and study.seeds.within is not None:
        told.append("study.seeds.within: does not go with a bisection, whose width is study.bisection.width")
    if not all(search.key.split(".")):
        told.append(f"study.bisection.key = {search.key!r}: must be a key of the case, such as water.disorder")
    return told


def schema(case: dict[str, Any]) -> dict[str, Any]:
    """The JSON schema `case` of case files, with that of the table `study` in it."""
    described = _Root.model_json_schema()
    return case | {
        "properties": case["properties"] | {"study": {"$ref": "#/$defs/Study", "description": "what many runs vary"}},
        "$defs": case["$defs"] | described["$defs"],
    }
