"""Ice through planes x = constant, from the tracks of the floes' centres."""

from __future__ import annotations

import numpy as np


def carried_on(x: np.ndarray) -> np.ndarray:
    """Tracks (T, nb), m, in which a body that has left, NaN, stays where it was last; NaN before it is there."""
    row = np.where(np.isfinite(x), np.arange(len(x))[:, None], -1)
    last = np.maximum.accumulate(row, axis=0)
    return np.where(last >= 0, np.take_along_axis(x, np.maximum(last, 0), axis=0), np.nan)


def passed(x: np.ndarray, volume: np.ndarray, plane: float, period: float = np.inf) -> np.ndarray:
    """Volume (T,), m3, whose centre has passed a plane, m, since the first row, net of what has come back.

    x (T, nb), m: tracks, without jumps at sides that repeat after a `period`, m; NaN where a body is not there.
    """
    track = carried_on(x)
    with np.errstate(invalid="ignore"):
        beyond = np.floor((track - plane) / period) if np.isfinite(period) else (track >= plane) - 1.0
    beyond = np.where(np.isfinite(track), beyond, np.nan)
    steps = np.nan_to_num(np.diff(beyond, axis=0, prepend=beyond[:1]))
    return np.cumsum(steps @ volume)


def discharge(times: np.ndarray, passed: np.ndarray, length: float) -> np.ndarray:
    """Mean discharge (T,), m3/s, over the `length`, s, before each time (T,); since the first where that is less."""
    begin = np.maximum(times - length, times[0])
    span = times - begin
    moved = passed - np.interp(begin, times, passed)
    return np.divide(moved, span, out=np.zeros(len(times)), where=span > 0.0)


def mean_speed(x: np.ndarray, u: np.ndarray, volume: np.ndarray, reach: tuple[float, float]) -> np.ndarray:
    """Mean velocity (T,) by volume, m/s, of the floes whose centre is in a reach, m; NaN where there are none.

    x, u (T, nb): places in the box, m, and velocities, m/s.
    """
    weight = np.where((x >= reach[0]) & (x <= reach[1]) & np.isfinite(u), volume, 0.0)
    total = weight.sum(axis=1)
    moved = (weight * np.nan_to_num(u)).sum(axis=1)
    return np.divide(moved, total, out=np.full(len(x), np.nan), where=total > 0.0)


def stored(x: np.ndarray, volume: np.ndarray, reach: tuple[float, float] = (-np.inf, np.inf)) -> np.ndarray:
    """Volume (T,), m3, of the floes whose centre (T, nb), m, is in a reach, m."""
    return np.where((x >= reach[0]) & (x <= reach[1]), volume, 0.0).sum(axis=1)
