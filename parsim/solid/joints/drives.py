"""Joints that prescribe a motion: steady, by a table of times, to and fro, around an axis."""

import bisect
import itertools
import math
import operator
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Moderate, Number, Positive, Real, Vector
from parsim.solid.joints.joint import DrivingTable, Pose

_ZERO = (0.0, 0.0, 0.0)
Row = Annotated[tuple[Number, ...], Field(min_length=4, max_length=7)]


class SteadyTable(DrivingTable):
    """Constant velocity and spin."""

    kind: Literal["steady"] = Field(description="moves at constant velocity")
    velocity: Vector = Field(_ZERO, description="velocity, m/s")
    spin: Vector = Field(_ZERO, description="angular velocity, global axes, rad/s")

    def pose(self, time, centre):
        """See `DrivingTable`."""
        return Pose(time * np.array(self.velocity), time * np.array(self.spin))

    def fastest(self, centre, radius):
        """See `DrivingTable`."""
        return math.hypot(*self.velocity) + math.hypot(*self.spin) * radius

    def ways(self):
        """See `DrivingTable`."""
        yield f"velocity = {list(self.velocity)}", self.velocity, _ZERO
        yield f"spin = {list(self.spin)}", _ZERO, self.spin


class ScheduleTable(DrivingTable):
    """Places at given times, straight in between, at rest after the last."""

    kind: Literal["schedule"] = Field(description="moves by a table of times")
    rows: Annotated[tuple[Row, ...], Field(min_length=2)] = Field(
        description="rows of time, s, shift along x, y, z, m, and if wanted turn as a vector along x, y, z, degrees"
    )

    def pose(self, time, centre):
        """See `DrivingTable`."""
        after = bisect.bisect_right(self.rows, time, key=operator.itemgetter(0))  # in every step, of many rows
        near = self.rows[max(after - 1, 0) : after + 1]
        rows = np.array([(*row, *(0.0,) * (7 - len(row))) for row in near])
        x = np.array([np.interp(time, rows[:, 0], column) for column in rows[:, 1:].T])
        return Pose(x[:3], np.radians(x[3:]))

    def fastest(self, centre, radius):
        """See `DrivingTable`."""
        rows = np.array([(*row, *(0.0,) * (7 - len(row))) for row in self.rows])
        change, span = np.abs(np.diff(rows[:, 1:], axis=0)), np.diff(rows[:, 0])
        moved = np.hypot.reduce(change[:, :3], axis=1) + radius * np.hypot.reduce(np.radians(change[:, 3:]), axis=1)
        return float((moved[span > 0.0] / span[span > 0.0]).max(initial=0.0))

    def ways(self):
        """See `DrivingTable`."""
        for number, row in enumerate(self.rows):
            yield f"rows.{number} = {list(row)}", row[1:4], (*row[4:], *_ZERO)[:3]

    def faults(self, body, planar):
        """See `JointTable`."""
        times = [row[0] for row in self.rows]
        if any(later <= earlier for earlier, later in itertools.pairwise(times)):
            yield f"rows: times {times[:5]} must grow from row to row"
        if any(len(row) not in (4, 7) for row in self.rows):
            yield "rows: each has 4 numbers (time, x, y, z) or 7 (and the turn about x, y, z)"
        if any(self.rows[0][1:]):
            yield f"rows.0 = {list(self.rows[0])}: shift and turn must begin with zero; they count from the start"
        yield from super().faults(body, planar)


class SwayTable(DrivingTable):
    """To and fro by a sine of time."""

    kind: Literal["sway"] = Field(description="moves to and fro by a sine of time")
    amplitude: Vector = Field(_ZERO, description="amplitude of the shift, m")
    turn: Vector = Field(_ZERO, description="amplitude of the turn, as a vector, degrees")
    frequency: Positive = Field(description="frequency, 1/s")
    phase: Real = Field(0.0, ge=-360, le=360, description="phase, degrees")

    def pose(self, time, centre):
        """See `DrivingTable`."""
        phase = math.radians(self.phase)
        share = math.sin(2.0 * math.pi * self.frequency * time + phase) - math.sin(phase)
        return Pose(share * np.array(self.amplitude), share * np.radians(self.turn))

    def fastest(self, centre, radius):
        """See `DrivingTable`."""
        most = math.hypot(*self.amplitude) + radius * math.radians(math.hypot(*self.turn))
        return 2.0 * math.pi * self.frequency * most

    def ways(self):
        """See `DrivingTable`."""
        yield f"amplitude = {list(self.amplitude)}", self.amplitude, _ZERO
        yield f"turn = {list(self.turn)}", _ZERO, self.turn


class SwingTable(DrivingTable):
    """Around an axis, at constant angular speed."""

    kind: Literal["swing"] = Field(description="goes around an axis at constant speed, turning with it")
    pivot: Vector = Field(description="a point of the axis, m")
    axis: Vector = Field((0.0, 1.0, 0.0), description="direction of the axis; any length")
    speed: Number = Field(description="angular speed, rad/s, by the right hand about the axis")
    until: Moderate | None = Field(None, description="time after it began at which it stops, s; left out: never")

    def pose(self, time, centre):
        """See `DrivingTable`."""
        along = np.array(self.axis) / math.hypot(*self.axis)
        angle = self.speed * min(time, self.until or math.inf)
        arm = centre - np.array(self.pivot)
        turned = (
            arm * math.cos(angle)
            + np.cross(along, arm) * math.sin(angle)
            + along * (along @ arm) * (1.0 - math.cos(angle))
        )
        return Pose(turned - arm, angle * along)

    def fastest(self, centre, radius):
        """See `DrivingTable`."""
        return abs(self.speed) * (float(np.linalg.norm(centre - np.array(self.pivot))) + radius)

    def ways(self):
        """See `DrivingTable`."""
        yield f"axis = {list(self.axis)}", _ZERO, self.axis

    def faults(self, body, planar):
        """See `JointTable`."""
        if not any(self.axis):
            yield f"axis = {list(self.axis)}: has no direction"
        else:
            yield from super().faults(body, planar)
