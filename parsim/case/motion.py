"""The table of a case about a box that moves, and what may be wrong with it."""

import math
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from parsim.case.course import Rows, wrong_course
from parsim.case.types import Number, Positive, Real, Table, Vector, choice
from parsim.geometry.faces import SIDES


class MotionTable(Table):
    """What moves by a sine of time, or by a table of times; `ROWS`: the key of that, `UNIT`: of its values, SI."""

    ROWS: ClassVar[str]
    UNIT: ClassVar[float] = 1.0

    amplitude: Number | None = Field(None, description="amplitude: m of a sway, degrees of a roll")
    period: Positive | None = Field(None, description="period of the sine, s")
    phase: Real = Field(0.0, ge=-360, le=360, description="phase of the sine at t = 0, degrees")

    def course(self):
        """The function of time, s, that gives value, rate and second derivative, SI: at rest before t = 0."""
        rows = getattr(self, self.ROWS)
        return Sine(self.amplitude * self.UNIT, self.period, self.phase) if rows is None else Spline(rows, self.UNIT)


class Sway(MotionTable):
    """To and fro along x."""

    ROWS: ClassVar[str] = "displacement"

    kind: Literal["sway"] = Field(description="moves to and fro along x")
    displacement: Rows | None = Field(
        None, description='in place of the sine: rows of [time, s, displacement, m] or {file = "x.csv"}'
    )


class Roll(MotionTable):
    """Around an axis along y."""

    ROWS: ClassVar[str] = "angle"
    UNIT: ClassVar[float] = math.pi / 180.0

    kind: Literal["roll"] = Field(description="turns about an axis along y; positive sinks x_max")
    about: Vector = Field(description="a point of the axis, m")
    angle: Rows | None = Field(
        None, description='in place of the sine: rows of [time, s, angle, degrees] or {file = "angle.csv"}'
    )


Motion = choice(Sway, Roll)


class Sine:
    """A sin(2 pi t / T + phase), its rate and its second derivative; before t = 0 as it is there, at rest."""

    def __init__(self, amplitude, period, phase):
        self._amplitude, self._omega, self._phase = amplitude, 2.0 * math.pi / period, math.radians(phase)

    def __call__(self, time):
        """Value, rate, second derivative at a time, s."""
        a, w, phase = self._amplitude, self._omega, self._omega * max(time, 0.0) + self._phase
        s = a * math.sin(phase)
        return (s, 0.0, 0.0) if time < 0.0 else (s, a * w * math.cos(phase), -w * w * s)


class Spline:
    """The cubic spline through rows of time, s, and value, times `unit`; at rest before, after and at both ends."""

    def __init__(self, rows, unit):
        self._t, self._y = t, y = np.array(rows).T * [[1.0], [unit]]
        h, slope = np.diff(t), np.concatenate([[0.0], np.diff(y) / np.diff(t), [0.0]])
        low, high = np.append(h, 0.0), np.insert(h, 0, 0.0)
        main, right = 2.0 * (low + high), 6.0 * np.diff(slope)
        for k in range(1, t.size):  # of a tridiagonal system, Thomas' algorithm
            share = h[k - 1] / main[k - 1]
            main[k] -= share * h[k - 1]
            right[k] -= share * right[k - 1]
        self._m = m = right / main
        for k in range(t.size - 2, -1, -1):
            m[k] = (right[k] - h[k] * m[k + 1]) / main[k]

    def __call__(self, time):
        """Value, rate, second derivative at a time, s."""
        t, y, m = self._t, self._y, self._m
        if not t[0] <= time <= t[-1] or time < 0.0:
            return float(np.interp(max(time, 0.0), t, y)), 0.0, 0.0
        k = min(int(np.searchsorted(t, time, side="right")), t.size - 1)
        h, a, b = t[k] - t[k - 1], t[k] - time, time - t[k - 1]
        left, right = y[k - 1] / h - m[k - 1] * h / 6.0, y[k] / h - m[k] * h / 6.0
        value = (m[k - 1] * a**3 + m[k] * b**3) / (6.0 * h) + left * a + right * b
        rate = (m[k] * b * b - m[k - 1] * a * a) / (2.0 * h) - left + right
        return float(value), float(rate), float((m[k - 1] * a + m[k] * b) / h)


def faults(case):
    """What is wrong with the motion of a completed case: messages."""
    motion = case.motion
    if motion is None:
        return []
    out = [f"motion.{text}" for text in _course(motion)]
    others = {"gate": case.gate, "channel": case.channel, "measure": case.measure}
    out += [f"motion: with a box that moves there is no {name}" for name, given in others.items() if given is not None]
    if case.gravity_ramp > 0.0:
        out.append(f"motion: gravity_ramp = {case.gravity_ramp!r}: must be 0 in a box that moves")
    for name in (name for axis in case.axes for name in SIDES[axis]):
        kind = getattr(case.box.faces, name).kind
        if kind in ("inlet", "outlet") or (kind == "periodic" and motion.kind == "roll" and name[0] != "y"):
            out.append(f'motion.kind = "{motion.kind}": box.faces.{name} = "{kind}": must be a wall or open')
    return out


def _course(motion):
    rows = getattr(motion, motion.ROWS)
    sine = {name: getattr(motion, name) for name in ("amplitude", "period")}
    given = [name for name, value in sine.items() if value is not None] + ["phase"] * (motion.phase != 0.0)
    if rows is None:
        missing = [name for name, value in sine.items() if value is None]
        return [f"{name}: missing; give amplitude and period, or {motion.ROWS}" for name in missing]
    return [f"{name}: is given, and {motion.ROWS} too; must be one of both" for name in given] + wrong_course(
        motion.ROWS, rows
    )
