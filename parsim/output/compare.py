"""Compare two output folders bit by bit: which field, id and step differ first, and how much in all.

Compared are every frame (particles by id), every series but the timings, and what run.json says that does not depend on
the machine. Differences of floats are counted in units of the last place (ulps): how many floats lie between the two.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from parsim.errors import InputError
from parsim.output.reader import Run
from parsim.output.reader import open as open_run

INFO = ("steps", "time", "particles", "lost", "leaks")
NOT_COMPARED = {"timings"}
EQUAL, DIFFERENT = 0, 3


@dataclass
class Difference:
    """The first place where a field differs, and over how many values it does."""

    where: str
    field: str
    step: float
    item: str
    first: str
    ulps: int | None
    count: int = 1
    most: int = 0

    def __str__(self) -> str:
        ulps = f" ({self.ulps} ulp)" if self.ulps is not None else ""
        step = f" at step {self.step}" if math.isfinite(self.step) else ""
        return f"{self.where}: {self.field}{step}, {self.item}: {self.first}{ulps}"


class Ledger:
    """All differences, one entry for each field of a place."""

    def __init__(self) -> None:
        self.entries: dict[tuple[str, str], Difference] = {}

    def add(
        self,
        where: str,
        field: str,
        step: float,
        item: str,
        first: str,
        ulps: int | None = None,
        count: int = 1,
        most: int = 0,
    ) -> None:
        """Note ``count`` differing values; the first one told of a field stays its first."""
        known = self.entries.get((where, field))
        if known is None:
            self.entries[where, field] = Difference(where, field, step, item, first, ulps, count, most)
        else:
            known.count += count
            known.most = max(known.most, most)

    def arrays(
        self,
        where: str,
        field: str,
        a: np.ndarray,
        b: np.ndarray,
        step: Callable[[int], float],
        item: Callable[[int], str],
    ) -> None:
        """Compare two arrays; ``step(row)`` and ``item(row)`` tell of a row what its step is and what it is about."""
        if a.shape != b.shape or a.dtype.kind != b.dtype.kind:
            self.add(where, field, step(0), "shape", f"{a.dtype}{a.shape} and {b.dtype}{b.shape}")
            return
        places = np.argwhere(different(a, b))
        if len(places):
            first = tuple(places[0])
            distances = ulps(a[tuple(places.T)], b[tuple(places.T)])
            told = int(distances[0]) if distances is not None else None
            most = int(distances.max()) if distances is not None else 0
            name = item(first[0]) + (f", component {first[1]}" if len(first) > 1 else "")
            values = f"{a[first].item()!r} and {b[first].item()!r}"
            self.add(where, field, step(first[0]), name, values, told, len(places), most)

    def first(self) -> Difference:
        """The difference at the earliest step."""
        return min(self.entries.values(), key=lambda entry: entry.step)


def different(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Where two arrays of one shape differ in their bits: a NaN equals the same NaN, 0.0 differs from -0.0."""
    if a.dtype == np.float64 == b.dtype:
        return _bits(a) != _bits(b)
    return a != b


def ulps(a: np.ndarray, b: np.ndarray) -> np.ndarray | None:
    """How many float64 values lie between each of ``a`` and ``b``, uint64; None for other types or where NaN meets."""
    if a.dtype != np.float64 or np.isnan(a).any() or np.isnan(b).any():
        return None
    # negative floats count down from the sign bit: mirror them, so that neighbours are one apart
    lowest = np.iinfo(np.int64).min
    a, b = (np.where(_bits(x) < 0, lowest - _bits(x), _bits(x)) for x in (a, b))
    # the distance may exceed int64, not uint64
    return np.maximum(a, b).view(np.uint64) - np.minimum(a, b).view(np.uint64)


def _bits(values):
    return np.ascontiguousarray(values).view(np.int64)


def differences(a: Run, b: Run) -> Ledger:
    """Everything in which the outputs ``a`` and ``b`` differ."""
    ledger = Ledger()
    _compare_info(ledger, a, b)
    for kind in ("water", "bodies"):
        _compare_frames(ledger, a, b, kind)
    _compare_series(ledger, a, b)
    return ledger


def _compare_info(ledger, a, b):
    for key in INFO:
        if a.info.get(key) != b.info.get(key):
            ledger.add("run.json", key, math.inf, "end of run", f"{a.info.get(key)!r} and {b.info.get(key)!r}")


def _compare_frames(ledger, a, b, kind):
    counts = len(a.times(kind)), len(b.times(kind))
    if counts[0] != counts[1]:
        ledger.add(f"frames of {kind}", "number of frames", math.inf, "all", f"{counts[0]} and {counts[1]}")
    for frame in range(min(counts)):
        one, other = getattr(a, kind)(frame), getattr(b, kind)(frame)
        if kind == "water":
            one, other = _matched(ledger, one, other)
        _compare_fields(ledger, f"frames of {kind}", one, other)


def _matched(ledger, a, b):
    """The two frames with their particles in the order of their ids; tells of ids that only one of them has."""
    only = np.setxor1d(a["id"], b["id"])
    if len(only):
        owner = "first" if only[0] in a["id"] else "second"
        ledger.add("frames of water", "id", a["step"], f"id {only[0]}", f"only in the {owner}", count=len(only))
    return _by_id(a, np.isin(a["id"], only, invert=True)), _by_id(b, np.isin(b["id"], only, invert=True))


def _by_id(frame, kept):
    order = np.flatnonzero(kept)[np.argsort(frame["id"][kept], kind="stable")]
    return {name: values[order] if isinstance(values, np.ndarray) else values for name, values in frame.items()}


def _compare_fields(ledger, where, a, b):
    def step(row):
        return a["step"]

    def item(row):
        return f"id {a['id'][row]}" if "id" in a else f"row {row}"

    for field in sorted(a.keys() | b.keys()):
        if field not in a or field not in b:
            ledger.add(where, field, a["step"], "all", "only in one of them")
        else:
            name = item if isinstance(a[field], np.ndarray) else lambda _: "the frame itself"
            ledger.arrays(where, field, *(np.atleast_1d(frame[field]) for frame in (a, b)), step, name)


def _compare_series(ledger, a, b):
    names = set(a.series_names) ^ set(b.series_names)
    for name in sorted(names - NOT_COMPARED):
        ledger.add(f"series {name}", "file", math.inf, "all", "only in one of them")
    for name in sorted(set(a.series_names) & set(b.series_names) - NOT_COMPARED):
        _compare_tables(ledger, name, a.series(name), b.series(name))


def _compare_tables(ledger, name, a, b):
    where = f"series {name}"
    if list(a) != list(b):
        ledger.add(where, "columns", math.inf, "all", f"{list(a)} and {list(b)}")
        return
    rows = len(a["step"]), len(b["step"])
    if rows[0] != rows[1]:
        ledger.add(where, "number of rows", math.inf, "all", f"{rows[0]} and {rows[1]}")

    def step(row):
        return int(a["step"][row])

    def item(row):
        keys = [str(values[row]) for values in a.values() if values.dtype.kind in "OUS"]  # what a row is about
        return " ".join([f"row {row}", *keys])

    for column in a if min(rows) else ():
        ledger.arrays(where, column, *(table[column][: min(rows)] for table in (a, b)), step, item)


def compare_outputs(first: Path | str, second: Path | str) -> int:
    """Print the first difference and a summary by field. Returns 0 when the bits are equal, 3 when they differ.

    Raises InputError when a folder is no output or there is nothing in it to compare.
    """
    a, b = open_run(first), open_run(second)
    frames, series = len(a.times("water")) + len(a.times("bodies")), set(a.series_names) - NOT_COMPARED
    if not frames and not series:
        raise InputError(f"{first}: holds neither frames nor series, there is nothing to compare")
    ledger = differences(a, b)
    if not ledger.entries:
        print(f"equal bits: {frames} frames, {len(series)} series, up to step {a.info.get('steps', '?')}")
        return EQUAL
    print(f"first difference: {ledger.first()}")
    for entry in sorted(ledger.entries.values(), key=lambda entry: entry.step):
        size = f", at most {entry.most} ulp" if entry.most else ""
        print(f"  {entry.where}: {entry.field}: {entry.count} differ{size}; first {entry.item}")
    return DIFFERENT
