"""Forces on piers: means over short times and what is seldom exceeded, from impulses that are kept exactly."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

WINDOWS = 0.0, 0.010, 0.100  # s, over which forces are averaged
PERCENTS = 100.0, 99.9, 99.0, 95.0  # of the time, that a force is at most so large


class Peaks(NamedTuple):
    """A force or moment as `peaks.csv` has it, rows (T,): end of each row, s, its length, s, impulse in it, N s or
    N m s, and the least and largest value of any step in it, N or N m."""

    time: np.ndarray
    span: np.ndarray
    impulse: np.ndarray
    least: np.ndarray
    largest: np.ndarray


def running_mean(peaks: Peaks, length: float) -> np.ndarray:
    """Means (n,), N or N m, over the `length`, s, that ends with each row, of those that leave room for one.

    At rows exact; in a row the force is taken for even.
    """
    ends = np.concatenate([[peaks.time[0] - peaks.span[0]], peaks.time])
    total = np.concatenate([[0.0], np.cumsum(peaks.impulse)])
    at = peaks.time[peaks.time - length >= ends[0] - 1e-9 * length]
    return (np.interp(at, ends, total) - np.interp(at - length, ends, total)) / length


def extremes(peaks: Peaks) -> np.ndarray:
    """Largest value (T,) by amount, with its sign, of any step in each row."""
    return np.where(-peaks.least > peaks.largest, peaks.least, peaks.largest)


def percentiles(
    peaks: Peaks, windows: tuple[float, ...] = WINDOWS, percents: tuple[float, ...] = PERCENTS
) -> np.ndarray:
    """Amounts (windows, percents), N or N m, that the means over each window, s, stay below so much of the time.

    Of the window 0 the rows' largest amounts stand for themselves: its maximum is that of all steps, the others are
    no less than those of all steps. NaN where the run is shorter than a window, or its rows are longer: these do not
    tell what acted in a part of them.
    """
    found = np.full((len(windows), len(percents)), np.nan)
    for k, length in enumerate(windows):
        values = running_mean(peaks, length) if length > 0.0 else extremes(peaks)
        told = length == 0.0 or peaks.span.mean() <= 1.01 * length
        if told and len(values):
            found[k] = np.percentile(np.abs(values), percents)
    return found
