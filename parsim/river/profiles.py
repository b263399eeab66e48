"""What columns tell along the reach: means over time and width, heads, and what of them is lost."""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np


class Profile(NamedTuple):
    """Along x, each (nx,): mean over the width and the values that 10, 50 and 90 % of the columns there are below."""

    mean: np.ndarray
    low: np.ndarray
    middle: np.ndarray
    high: np.ndarray


def across(values: np.ndarray) -> Profile:
    """`Profile` of values (nx, ny); columns with NaN do not count, and where all have it so does the profile."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of columns without a value
        return Profile(np.nanmean(values, axis=1), *np.nanpercentile(values, (10.0, 50.0, 90.0), axis=1))


def through(velocity: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Mean velocity (nx,), m/s, of sections by area: discharge over area, of columns (nx, ny) of these depths, m."""
    wet = np.isfinite(velocity) & np.isfinite(depth)
    flow, area = (np.where(wet, each, 0.0).sum(axis=1) for each in (velocity * depth, depth))
    return np.divide(flow, area, out=np.full(len(area), np.nan), where=area > 0.0)


def mean_of(values: np.ndarray) -> float:
    """Mean of the values (n,) that are there, NaN of none."""
    there = values[np.isfinite(values)]
    return float(there.mean()) if there.size else float("nan")


def mean_between(times: np.ndarray, values: np.ndarray, begin: float, end: float) -> np.ndarray:
    """Mean of the values (T, ...) of the times (T,) from begin to end, s, NaN left out; of the nearest if there are
    none."""
    here = (times >= begin) & (times <= end)
    if not here.any():
        here = np.arange(len(times)) == np.abs(times - 0.5 * (begin + end)).argmin()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.nanmean(values[here], axis=0)


def head(level: np.ndarray, velocity: np.ndarray, gravity: float) -> np.ndarray:
    """Energy head (nx,), m: piezometric level, m, and that of the velocity, m/s; gravity along z, m/s2."""
    return level + velocity**2 / (2.0 * gravity)


def head_loss(x: np.ndarray, heads: np.ndarray, between: tuple[float, float], tilt: float = 0.0) -> float:
    """Head lost, m, between two places, m, the first one upstream, of heads (nx,) at x (nx,), m.

    `tilt`: what drives the flow along x over gravity along z, the slope of a tilted channel.
    """
    there = np.isfinite(heads)
    if not there.any():
        return float("nan")
    first, last = np.interp(between, x[there], heads[there])
    return float(first - last + tilt * (between[1] - between[0]))


def energy_slope(x: np.ndarray, heads: np.ndarray, tilt: float = 0.0) -> float:
    """Slope of the energy line: that of the straight line nearest to heads (nx,), m, downward, and the `tilt`."""
    there = np.isfinite(heads)
    if there.sum() < 2:
        return float("nan")
    return float(tilt - np.polyfit(x[there], heads[there], 1)[0])
