"""Whether ice has jammed: when, where, of what kind, and whether it holds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SHARE = 0.05  # of the supply through the control plane, and of the water's speed, below which ice has jammed
SHORTEST, FLOES = 5.0, 10.0  # s, and floes that the water passes: the longer of the two is the time that it takes
HOLDS = 3.0  # times that time, after which a jam holds
LAYERS = 1.5  # below which a jam is one of the surface


class Jam(NamedTuple):
    """begin, s, of the first window of its time in which ice stood; end, s, of the last; lasts: "held", "transient", or
    "open" where the run ends before that is known."""

    begin: float
    end: float
    lasts: str


def window(floe: float, speed: float) -> float:
    """Time, s, over which ice must stand to have jammed, by the median size of floes, m, and the water's speed, m/s."""
    return max(SHORTEST, FLOES * floe / speed) if speed > 0.0 else np.inf


def jam(
    times: np.ndarray, passed: np.ndarray, speed: np.ndarray, supply: float, water: float, length: float
) -> Jam | None:
    """The first jam that holds, else the first; None if there is none, as where ice rests at the start and drifts off.

    times (T,), s; passed (T,), m3, through the control plane so far; speed (T,), m/s, mean of the ice over the reach
    upstream of it, NaN where there is next to none; supply, m3/s, of ice; water, m/s, its speed; length, s: see
    `window`.
    """
    if not (len(times) and np.isfinite(length)):
        return None
    stands = _stands(times, passed, speed, supply, water, length)
    edges = np.flatnonzero(np.diff(stands, prepend=False, append=False)).reshape(-1, 2)
    every = [_lasting(times[first], times[stop - 1] + length, length, stop < len(stands)) for first, stop in edges]
    if every and edges[0, 0] == 0 and every[0].lasts == "transient":
        every = every[1:]
    return next((each for each in every if each.lasts == "held"), every[0] if every else None)


def _lasting(begin, end, length, ended):
    holds = end - begin >= HOLDS * length * (1.0 - 1e-9)
    return Jam(float(begin), float(end), "held" if holds else "transient" if ended else "open")


def _stands(times, passed, speed, supply, water, length):
    """Whether ice stands in the window that begins at each of the times that leave room for one: bool."""
    room = times + length <= times[-1] + 1e-9 * length
    begin = times[room]
    flow = (np.interp(begin + length, times, passed) - passed[room]) / length
    known = np.nan_to_num(speed)
    way = np.concatenate([[0.0], np.cumsum(0.5 * (known[1:] + known[:-1]) * np.diff(times))])
    mean = (np.interp(begin + length, times, way) - way[room]) / length
    missing = np.concatenate([[0], np.cumsum(~np.isfinite(speed))])
    after = np.searchsorted(times, begin + length * (1.0 + 1e-9), side="right")
    there = missing[after] == missing[:-1][room]
    return there & (flow <= SHARE * supply) & (np.abs(mean) <= SHARE * water)


def extent(x: np.ndarray, speed: np.ndarray, water: float, plane: float, floe: float = 0.0) -> tuple[float, float]:
    """Where the ice stands upstream of a plane, m: (head, toe), of the columns without a gap of moving ice or none.

    Gaps up to a `floe`, m, long are none. x (nx,), m; speed (nx,), m/s, of the ice there, NaN without. NaN where none
    stands.
    """
    stands = (np.abs(speed) <= SHARE * water) & (x <= plane)
    if not stands.any():
        return np.nan, np.nan
    at, step = x[stands], float(x[1] - x[0]) if len(x) > 1 else 0.0
    gaps = np.flatnonzero(np.diff(at) > 1.001 * step + floe)
    return float(at[gaps[-1] + 1 if len(gaps) else 0] - 0.5 * step), float(at[-1] + 0.5 * step)


def kind(layers: float, grounded: bool) -> str:
    """What a jam is, by the layers of floes in it, NaN if it is not known, and whether it touches the bed."""
    if grounded:
        return "grounded"
    if np.isnan(layers):
        return "unknown"
    return "surface" if layers < LAYERS else "thickened"
