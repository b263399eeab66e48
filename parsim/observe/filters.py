"""Filters of what a sensor reads: over all steps, not only those that have a row."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Any, Literal, Protocol

import numpy as np
from pydantic import Field

from parsim.case.types import Positive, Table, choice


class Mean(Table):
    """The mean over the time before."""

    kind: Literal["mean"] = Field(description="the mean over a time before")
    over: Positive = Field(description="how long, s")

    def __str__(self) -> str:
        return f"mean {self.over:g} s"

    def memory(self) -> Memory:
        """Its state, before any step."""
        return _Window(self.over)


class LowPass(Table):
    """The low pass of first order, as of a resistance and a capacity."""

    kind: Literal["low_pass"] = Field(description="a low pass of first order")
    cutoff: Positive = Field(description="frequency of which it lets 0.71 of the amplitude through, Hz")

    def __str__(self) -> str:
        return f"low_pass {self.cutoff:g} Hz"

    def memory(self) -> Memory:
        """Its state, before any step."""
        return _Lag(2.0 * math.pi * self.cutoff)


Filter = choice(Mean, LowPass)
_BITS = 96


class Memory(Protocol):
    """State of the filter of one sensor."""

    def see(self, dt: float, values: np.ndarray) -> None:
        """Take in what is read (c,) after a step of dt, s."""

    def value(self) -> np.ndarray | None:
        """What the filter gives now, (c,); None before it has seen anything."""

    def kept(self) -> list[Any]:
        """What a restart needs, as JSON has it."""

    def restore(self, kept: list[Any]) -> None:
        """Go on from what `kept` returned."""


class _Window:
    def __init__(self, over):
        self._over, self._most = over, max(_exact(over), 1)
        self._seen: deque[tuple[float, ...]] = deque()
        self._span = 0  # time of what is held, exact: whatever has come and gone, and on from a checkpoint

    def see(self, dt, values):
        self._seen.append((dt, *values.tolist()))
        self._span += _exact(dt)
        while self._span - _exact(self._seen[0][0]) >= self._most:
            self._span -= _exact(self._seen.popleft()[0])

    def value(self):
        if not self._seen:
            return None
        rows = np.array(self._seen)[::-1]
        before = np.cumsum(rows[:, 0]) - rows[:, 0]
        share = np.minimum(rows[:, 0], self._over - before)
        return (share[:, None] * rows[:, 1:]).sum(axis=0) / share.sum()

    def kept(self):
        return [list(row) for row in self._seen]

    def restore(self, kept):
        self._seen = deque(tuple(row) for row in kept)
        self._span = sum(_exact(row[0]) for row in self._seen)


def _exact(time):
    """A time, s, as a whole number of what every double above 1e-13 is a multiple of: sums have no rounding."""
    return int(math.ldexp(time, _BITS))


class _Lag:
    def __init__(self, rate):
        self._rate, self._value = rate, None

    def see(self, dt, values):
        before = values if self._value is None else self._value
        self._value = before + (values - before) * -math.expm1(-self._rate * dt)

    def value(self):
        return self._value

    def kept(self):
        return [] if self._value is None else self._value.tolist()

    def restore(self, kept):
        self._value = np.array(kept) if kept else None


class Filters:
    """Those of several sensors, `names` as series have them, "none" without one; `which`: the numbers of the others."""

    def __init__(self, sensors: Sequence[Any]) -> None:
        self.names = ["none" if sensor.filter is None else str(sensor.filter) for sensor in sensors]
        self._each = {k: sensor.filter.memory() for k, sensor in enumerate(sensors) if sensor.filter is not None}
        self.which = list(self._each)

    def see(self, dt: float, values: np.ndarray) -> None:
        """Take in what the sensors `which` read, (k, c), after a step of dt, s."""
        for memory, row in zip(self._each.values(), values, strict=True):
            memory.see(dt, row)

    def applied(self, values: np.ndarray) -> np.ndarray:
        """What all sensors read (n, c), filtered."""
        out = values.copy()
        for k, memory in self._each.items():
            if (value := memory.value()) is not None:
                out[k] = value
        return out

    def kept(self) -> dict[str, Any]:
        """See `Follower`."""
        return {str(k): memory.kept() for k, memory in self._each.items()}

    def restore(self, kept: dict[str, Any]) -> None:
        """See `Follower`."""
        for k, memory in self._each.items():
            memory.restore(kept[str(k)])
