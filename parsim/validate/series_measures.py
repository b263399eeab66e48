"""What is measured of the series of a finished run for its bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.errors import InputError
from parsim.report.measures import mean_profile

if TYPE_CHECKING:
    from parsim.output.reader import Run

Rows = dict[str, str]


def chosen(
    run: Run, series: str, column: str, rows: Rows | None = None, after: float = -math.inf
) -> tuple[np.ndarray, np.ndarray]:
    """Times, s, and values of a column of a series from a time on, of the rows where other columns are as told.

    Raises InputError where there are none.
    """
    read = run.series(series)
    here = read["time"] >= after
    for name, value in (rows or {}).items():
        meant = read[name].astype(str) == value
        if not meant.any():
            there = ", ".join(np.unique(read[name].astype(str))) or "none"
            raise InputError(f"rows.{name} = {value!r}: no such row in the series {series}; there are: {there}")
        here &= meant
    if not here.any():
        raise InputError(f"the series {series} has no row from t = {after:g} s on")
    return read["time"][here], read[column][here]


def track(
    run: Run, series: str, column: str, rows: Rows | None = None, after: float = -math.inf
) -> tuple[np.ndarray, np.ndarray]:
    """As `chosen`, of one row for each time. Raises InputError where there are more."""
    times, values = chosen(run, series, column, rows, after)
    if np.unique(times).size < times.size:
        raise InputError(f'the series {series} has several rows at a time; tell one, as by rows = {{body = "A1"}}')
    return times, values


def mean(
    run: Run, series: str, column: str, rows: Rows | None = None, after: float = 0.0, before: float | None = None
) -> float:
    """Mean of a column of a series between two times, s, of the rows where other columns are as told in `rows`."""
    times, values = chosen(run, series, column, rows, after)
    return float(values[times <= (math.inf if before is None else before)].mean())


def maximum(
    run: Run, series: str, column: str, rows: Rows | None = None, after: float = 0.0, over: float = 1.0
) -> float:
    """Largest value of a column of a series from a time, s, on, over `over`, of the rows as told in `rows`."""
    return float(chosen(run, series, column, rows, after)[1].max() / over)


def minimum(
    run: Run, series: str, column: str, rows: Rows | None = None, after: float = 0.0, over: float = 1.0
) -> float:
    """Smallest value of a column of a series from a time, s, on, over `over`, of the rows as told in `rows`."""
    return float(chosen(run, series, column, rows, after)[1].min() / over)


def last(run: Run, series: str, column: str, rows: Rows | None = None) -> float:
    """Last value of a column of a series, of the rows where other columns are as told in `rows`."""
    return float(track(run, series, column, rows)[1][-1])


def first_over(
    run: Run,
    series: str,
    column: str,
    value: float,
    from_value: float | None = None,
    rows: Rows | None = None,
    over: float = 1.0,
    dry: float = math.nan,
) -> float:
    """Time, over `over`, s, at which a column of a series first reaches a value, between rows; nan if never.

    Since it first reached `from_value`, if that is told; `dry`: what counts where there was nothing to read.
    """
    times, values = chosen(run, series, column, rows)
    values = np.nan_to_num(values, nan=dry)
    begin = 0.0 if from_value is None else _first(times, values, from_value)
    return (_first(times, values, value) - begin) / over


def _first(times: np.ndarray, values: np.ndarray, value: float) -> float:
    k = int(np.argmax(values >= value))
    if not values[k] >= value:
        return math.nan
    return float(np.interp(value, values[k - 1 : k + 1], times[k - 1 : k + 1]) if k else times[0])


def period_of(run: Run, series: str, column: str, zero: float, rows: Rows | None = None) -> float:
    """Period, s, of a swing about `zero`: twice the mean time between the times at which a column is there."""
    times, values = chosen(run, series, column, rows)
    crossed = np.flatnonzero(np.diff(values < zero))
    share = (zero - values[crossed]) / (values[crossed + 1] - values[crossed])
    at = times[crossed] + share * (times[crossed + 1] - times[crossed])
    return float(2.0 * np.diff(at).mean()) if at.size > 1 else math.nan


def damping_of(run: Run, series: str, column: str, zero: float, rows: Rows | None = None) -> float:
    """Damping over the critical one, by the logarithm of the first three half swings about `zero` in turn."""
    values = chosen(run, series, column, rows)[1] - zero
    crossed = np.flatnonzero(np.diff(values < 0.0))
    tops = [np.abs(half).max() for half in np.split(values, crossed + 1)[:4]]
    loss = math.log(tops[0] / tops[-1]) / (len(tops) - 1)  # of half a period
    return float(loss / math.hypot(loss, math.pi))


def noise_of(
    run: Run, series: str, column: str, after: float, before: float, width: float, over: float, rows: Rows | None = None
) -> float:
    """Root of the mean square of what a column is off its own running mean over a width, s, between two times, s."""
    times, values = chosen(run, series, column, rows)
    half = max(round(0.5 * width / np.median(np.diff(times))), 1)
    smooth = np.convolve(values, np.ones(2 * half + 1) / (2 * half + 1), "same")
    here = (times >= after) & (times <= before)
    return float(np.sqrt(np.mean((values - smooth)[here] ** 2)) / over)


def scaled(
    run: Run,
    series: str,
    column: str,
    rows: Rows | None = None,
    start: float = 0.0,
    zero: float = 0.0,
    time_unit: float = 1.0,
    unit: float = 1.0,
    dry: float = math.nan,
) -> tuple[np.ndarray, np.ndarray]:
    """Times from `start` over `time_unit`, s, and a column of a series from `zero` over `unit`, as curves have them.

    `dry`: what counts where there was nothing to read.
    """
    times, values = chosen(run, series, column, rows)
    return (times - start) / time_unit, (np.nan_to_num(values, nan=dry) - zero) / unit


def off_curve(
    run: Run,
    series: str,
    column: str,
    curve: list[list[float]],
    rows: Rows | None = None,
    start: float = 0.0,
    zero: float = 0.0,
    time_unit: float = 1.0,
    unit: float = 1.0,
    dry: float = math.nan,
    over: float | None = None,
) -> float:
    """Root of the mean square of what a column of a series, `scaled`, is off a curve [[time, value], ...].

    Over the root of the mean square of the curve itself (Robb et al. 2016, eq. 13), or over `over`.
    """
    times, values = scaled(run, series, column, rows, start, zero, time_unit, unit, dry)
    at, exact = np.array(curve, float).T
    off = np.interp(at, times, values) - exact
    return float(np.sqrt(np.mean(off * off)) / (np.sqrt(np.mean(exact * exact)) if over is None else over))


def balance(run: Run) -> float:
    """Most that particles in, out and inside were off balance, between any two rows."""
    read = run.series("openings")["balance"]
    return float(read.max() - read.min())


def growth_over(run: Run, series: str, column: str, other: str, after: float) -> float:
    """How much a column that counts grows from a time, s, on, over how much another does."""
    read = run.series(series)
    late = read["time"] >= after
    grown, of = (float(read[name][late][-1] - read[name][late][0]) for name in (column, other))
    return grown / of


def energy_made(run: Run) -> float:
    """Largest total energy over that at the start, less one; the potential energy is over the floor."""
    total = run.series("energy")["total"]
    return float(total.max() / total[0] - 1.0)


def off_log_law(run: Run, line: str, after: float, shear: float, roughness: float, depth: float) -> float:
    """Largest distance, over the mean, of the velocity on a line from u*/0.41 ln(30 z / ks) for 0.1 < z/H < 0.9."""
    z, u = mean_profile(run.series("velocities"), line, after)
    here = (z > 0.1 * depth) & (z < 0.9 * depth)
    exact = shear / 0.41 * np.log(30.0 * z[here] / roughness)
    mean = shear / 0.41 * (math.log(30.0 * depth / roughness) - 1.0)
    return float(np.abs(u[here] - exact).max() / mean)


def off_parabola(run: Run, line: str, after: float, mean: float, height: float) -> float:
    """Root of the mean squared distance, over the mean, of the velocity on a line from 6 U (z/H)(1 - z/H)."""
    z, u = mean_profile(run.series("velocities"), line, after)
    return float(np.sqrt(np.mean((u / mean - 6.0 * z / height * (1.0 - z / height)) ** 2)))
