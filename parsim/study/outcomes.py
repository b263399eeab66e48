"""What a study asks each finished run: functions of the run, with what `study.outcome` gives them.

A function that returns a bool says yes or no by itself; a number does so by the keys above or below.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_type_hints

import numpy as np
from pydantic import Field, Strict, create_model

from parsim.case.types import CHOICE, Number, Real, Table, Whole, choice
from parsim.errors import InputError, nearest, suggestion
from parsim.observe.observers import TABLES
from parsim.river import verdicts
from parsim.validate.measures import MEASURES
from parsim.validate.river_measures import measured
from parsim.validate.series_measures import track

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.output.reader import Run

Text = Annotated[str, Strict()]
_STRICT: dict[Any, Any] = {float: Real, int: Whole, str: Text}


def crossed(
    run: Run, series: str, column: str, level: float, rows: dict[str, str] | None = None, after: float = 0.0
) -> bool:
    """Whether a column of a series gets past a level, or to it, from where it is at the time `after`, s."""
    return not math.isnan(crossing_time(run, series, column, level, rows, after))


def crossing_time(
    run: Run, series: str, column: str, level: float, rows: dict[str, str] | None = None, after: float = 0.0
) -> float:
    """Time, s, at which a column of a series first gets to a level, between its rows by a straight line; else none."""
    times, values = track(run, series, column, rows, after)
    known = ~np.isnan(values)
    if not known.any():
        return math.nan
    times, values = times[known], values[known]
    ahead = (values - level) * (1.0 if values[0] < level else -1.0)  # negative until the level is reached
    reached = np.flatnonzero(ahead >= 0.0)
    if not reached.size:
        return math.nan
    at = reached[0]
    if at == 0:
        return float(times[0])
    share = ahead[at - 1] / (ahead[at - 1] - ahead[at])
    return float(times[at - 1] + share * (times[at] - times[at - 1]))


def jam_forms(run: Run) -> bool:
    """Whether ice has jammed, as the table `measure.jam` of the case says."""
    return _verdict(run).jam is not None


def jam_holds(run: Run) -> bool:
    """Whether ice has jammed and stays so for three times the time that makes a jam."""
    found = _verdict(run).jam
    return found is not None and found.lasts == "held"


def block_goes_under(run: Run, body: str) -> bool:
    """Whether a block has not stayed at the edge of the cover, `measure.cover`: it turned under, sank or passed."""
    known = verdicts.blocks(measured(run))
    if body not in known:
        raise InputError(f"body = {body!r}: no block that drifts to a cover, measure.cover")
    return known[body].critical


def _verdict(run):
    found = verdicts.verdict(measured(run))
    if found is None:
        raise InputError("the case looks for no jam; it needs measure.jam, and ice that is free")
    if not math.isfinite(found.window):
        raise InputError(
            "no water flows down the reach before ice changes its level, to tell a jam by; see measure.before"
        )
    if found.jam is None and found.kind == "unknown":
        raise InputError(f"the run is shorter than the {found.window:.4g} s that make a jam; give a later run.until")
    return found


class Asked(Table):
    """What all outcomes have in common."""

    above: Number | None = Field(None, description="the outcome is yes where the number is larger; left out: a number")
    below: Number | None = Field(None, description="the outcome is yes where the number is smaller")

    @property
    def decides(self) -> bool:
        """Whether the outcome is yes or no."""
        return _is_bool(self.function) or self.above is not None or self.below is not None

    @property
    def function(self) -> Callable[..., float | bool]:
        """The function that is asked."""
        return OUTCOMES[getattr(self, CHOICE)]

    def of(self, run: Run) -> float | bool | None:
        """The outcome of a finished run, None where it has none. Raises InputError where it cannot be asked."""
        arguments = {name: value for name, value in self if name not in {CHOICE, "above", "below"}}
        try:
            value = self.function(run, **arguments)
        except InputError as error:
            raise InputError([f"{run.folder}: study.outcome: {message}" for message in error.messages]) from None
        except (ArithmeticError, LookupError, ValueError, StopIteration) as error:
            raise InputError(f"{run.folder}: study.outcome: {type(error).__name__}: {error}") from None
        if isinstance(value, bool | np.bool_):
            return bool(value)
        if not math.isfinite(value):
            return None
        if not self.decides:
            return value
        return (self.above is None or value > self.above) and (self.below is None or value < self.below)

    def faults(self, case: Case | None) -> list[str]:
        """What of series, columns, bodies and measures a run of the case, None: any, would not know: messages."""
        told = []
        if _is_bool(self.function) and not (self.above is None and self.below is None):
            told.append(f"study.outcome: {getattr(self, CHOICE)} says yes or no by itself; leave above and below out")
        elif self.above is not None and self.below is not None and self.above >= self.below:
            told.append(
                f"study.outcome.above = {self.above!r}: no number is above it and below {self.below!r}; must be less "
                "than study.outcome.below"
            )
        series, rows = getattr(self, "series", None), getattr(self, "rows", None) or {}
        if series is not None and series not in TABLES:
            told.append(_unknown("series", series, TABLES))
        elif series is not None:
            columns = TABLES[series]
            named = [("column", self.column), *((f"rows.{name}", name) for name in rows)]  # type: ignore[attr-defined]
            told += [_unknown(key, name, columns) for key, name in named if name not in columns]
        if case is None:
            return told
        kind, needed = getattr(self, CHOICE), _NEEDED.get(getattr(self, CHOICE))
        if needed and getattr(case.measure, needed, None) is None:
            told.append(f'study.outcome.kind = "{kind}": needs measure.{needed} in the case')
        body, bodies = getattr(self, "body", rows.get("body")), [body.name for body in case.bodies]
        if body is not None and body not in bodies:
            told.append(_unknown("body" if hasattr(self, "body") else "rows.body", body, bodies))
        return told


_NEEDED = {"jam_forms": "jam", "jam_holds": "jam", "block_goes_under": "cover"}  # of the table measure


def _is_bool(function):
    return _hints(function)["return"] is bool


def _unknown(key, name, known):
    return (
        f"study.outcome.{key} = {name!r}: there is no such one{suggestion(nearest(name, known))}; "
        f"allowed: {', '.join(known) or 'none'}"
    )


def _hints(function):
    return get_type_hints(function, localns={"Run": object})


def _table(function):
    """The table of `study.outcome` that asks for a function: its arguments are the keys."""
    hints, told = _hints(function), (inspect.getdoc(function) or "").split("\n")[0]
    fields: dict[str, Any] = {CHOICE: (Literal[function.__name__], Field(description=told))}
    for name, parameter in list(inspect.signature(function).parameters.items())[1:]:
        left_out = ... if parameter.default is parameter.empty else parameter.default
        hint = hints[name]
        fields[name] = (_STRICT.get(hint, hint), Field(left_out, description=f"of {function.__name__}: {told}"))
    return create_model(f"Outcome_{function.__name__}", __base__=Asked, __doc__=told, **fields)


OUTCOMES: dict[str, Callable[..., float | bool]] = {
    function.__name__: function
    for function in (crossed, crossing_time, jam_forms, jam_holds, block_goes_under, *MEASURES.values())
}
Outcome = choice(*map(_table, OUTCOMES.values()))
