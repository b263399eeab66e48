"""Quantities of a case that are constant or change with time: a number, rows of times and values, or a CSV file."""

import bisect
import csv
import itertools
import operator
from typing import Annotated

import numpy as np
from pydantic import Field

from parsim.case.types import Number
from parsim.errors import InputError

Rows = Annotated[tuple[tuple[Number, Number], ...], Field(min_length=2)]
Course = Number | Rows  # rows of time, s, and value: straight in between, constant before and after


def at_time(course, time):
    """The value of a `Course` at a time, s; of other `Rows` at what they begin with."""
    if isinstance(course, float):
        return course
    after = bisect.bisect_right(course, time, key=operator.itemgetter(0))  # asked for in every step, of many rows
    times, values = np.array(course[max(after - 1, 0) : after + 1]).T
    return float(np.interp(time, times, values))


def largest(course):
    """The largest value of a `Course`, without its sign."""
    return abs(course) if isinstance(course, float) else max(abs(value) for _, value in course)


def highest(course):
    """The largest value of a `Course`, with its sign."""
    return course if isinstance(course, float) else max(value for _, value in course)


def least(course):
    """The least value of a `Course`."""
    return course if isinstance(course, float) else min(value for _, value in course)


def times_of(*courses):
    """The times, s, between which each `Course`, if it is given, is straight."""
    return sorted({time for course in courses if not isinstance(course, float | None) for time, _ in course})


def wrong_course(key, course):
    """What is wrong with a quantity that changes with time: messages."""
    if isinstance(course, float):
        return []
    return [
        f"{key}: time {later:g} after {earlier:g} s: times must grow from row to row"
        for (earlier, _), (later, _) in itertools.pairwise(course)
        if later <= earlier
    ][:1]


def read_courses(table, folder, key):
    """Put in place of every {file = "x.csv"} in a table of a case file the rows of that file, found from `folder`."""
    for name, value in table.items():
        if isinstance(value, dict) and set(value) == {"file"} and isinstance(value["file"], str):
            table[name] = _rows(folder / value["file"], f"{key}.{name}")


def _rows(path, key):
    """Rows [time, value] of a CSV file; lines that begin with # and a first line of names are passed over."""
    if path.suffix.lower() != ".csv":
        raise InputError(f'{key}.file = "{path}": must be a CSV file of two columns, time, s, and value')
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = list(csv.reader(line for line in file if line.strip() and not line.startswith("#")))
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f'{key}.file = "{path}": cannot be read: {reason}') from None
    rows = []
    for number, row in enumerate(lines):
        try:
            time, value = map(float, row)
        except ValueError:
            if number == 0 and not any(map(_is_number, row)):
                continue  # names of the columns
            raise InputError(f'{key}.file = "{path}": row {number + 1}, {",".join(row)}: must be two numbers') from None
        rows.append([time, value])
    if len(rows) < 2:
        raise InputError(f'{key}.file = "{path}": has {len(rows)} rows of numbers; must be two or more')
    return rows


def _is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True
