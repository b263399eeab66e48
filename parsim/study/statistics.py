"""What follows of the outcomes of many runs: probability, mean and quantiles with intervals, the curve of an edge.

All intervals are of 95 %.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

Z = 1.96  # standard deviations to both sides that hold 95 % of a normal distribution
RESAMPLES = 4000
_SHARES = (0.025, 0.975)
_STEPS = 100  # of Newton's method, at most
_CLOSE = 1e-10  # change of the coefficients, over themselves, at which it ends


class Estimate(NamedTuple):
    """A value and the ends of its interval."""

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the length of the interval."""
        return 0.5 * (self.high - self.low)


def wilson(yes: int, runs: int) -> Estimate:
    """Probability of yes, from its number in a number of runs, with the score interval (Wilson 1927)."""
    if runs == 0:
        return Estimate(math.nan, 0.0, 1.0)
    p, z2 = yes / runs, Z * Z / runs
    middle, half = p + 0.5 * z2, Z * math.sqrt(p * (1.0 - p) / runs + 0.25 * z2 / runs)
    low, high = (middle - half) / (1.0 + z2), (middle + half) / (1.0 + z2)
    return Estimate(p, low if yes else 0.0, high if yes < runs else 1.0)


@functools.cache
def bootstrap(values: tuple[float, ...], quantiles: tuple[float, ...] = ()) -> tuple[Estimate, ...]:
    """Mean and quantiles of values, in any order, with percentile intervals (Efron 1979); the same every time.

    A single value has no interval: its ends are not a number.
    """
    sample = np.sort(values)
    shares = list(quantiles)
    found = [sample.mean(), *np.quantile(sample, shares)]
    if sample.size == 1:
        return tuple(Estimate(float(value), math.nan, math.nan) for value in found)
    drawn = np.random.Generator(np.random.Philox(key=0)).integers(0, sample.size, (RESAMPLES, sample.size))
    again = [sample[drawn].mean(axis=1)]
    if shares:
        again += list(np.quantile(sample[drawn], shares, axis=1))
    ends = np.quantile(again, _SHARES, axis=1)
    return tuple(Estimate(*map(float, row)) for row in zip(found, *ends, strict=True))


def estimate(outcomes: Sequence[float | bool]) -> Estimate:
    """Probability of yes, or mean of numbers, with its interval."""
    if isinstance(outcomes[0], bool):
        return wilson(sum(map(bool, outcomes)), len(outcomes))
    return bootstrap(tuple(outcomes))[0]


class Curve(NamedTuple):
    """The logistic curve 1 / (1 + exp(-slope (x - middle))), with the interval of its middle."""

    slope: float
    middle: float
    low: float
    high: float

    def at(self, x: np.ndarray) -> np.ndarray:
        """Probability (n,) at x (n,)."""
        return _share(self.slope * (x - self.middle))


def logistic(x: Sequence[float], yes: Sequence[bool]) -> Curve | None:
    """The most likely logistic curve through outcomes `yes` at `x`; None where there is none.

    There is none where all outcomes are the same or one x parts yes from no: then the steeper a curve the likelier.
    The interval of the middle is of the first order in its error.
    """
    at, outcome = np.array(x, float), np.array(yes, bool)
    if outcome.all() or not outcome.any() or _parted(at[outcome], at[~outcome]):
        return None
    shift, scale = at.mean(), at.std()
    design = np.stack([np.ones_like(at), (at - shift) / scale])

    def loss(b: np.ndarray) -> float:
        return float(np.logaddexp(0.0, np.where(outcome, -1.0, 1.0) * (b @ design)).sum())

    b = np.zeros(2)
    for _ in range(_STEPS):
        p = _share(b @ design)
        information = (design * (p * (1.0 - p))) @ design.T
        step = np.linalg.solve(information, design @ (outcome - p))
        while loss(b + step) > loss(b) and np.abs(step).max() > _CLOSE:
            step *= 0.5
        b = b + step
        if np.abs(step).max() <= _CLOSE * (1.0 + np.abs(b).max()):
            break
    if b[1] == 0.0:
        return None
    middle, spread = -b[0] / b[1], np.linalg.inv(information)
    variance = (spread[0, 0] + 2.0 * middle * spread[0, 1] + middle**2 * spread[1, 1]) / b[1] ** 2
    half = Z * math.sqrt(variance) * scale
    middle = shift + scale * middle
    return Curve(float(b[1] / scale), float(middle), float(middle - half), float(middle + half))


def _share(x):
    """1 / (1 + exp(-x)), without the overflow of exp."""
    return np.exp(-np.logaddexp(0.0, -x))


def _parted(yes, no):
    return yes.min() >= no.max() or no.min() >= yes.max()
