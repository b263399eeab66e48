"""What a case may say of a place where something is measured: one table for each kind, listed at the end."""

import math
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from parsim.case.friction import FaceName
from parsim.case.types import Count, Name, Number, Positive, Table, Vector, choice
from parsim.observe.filters import Filter


class Sensing(Table):
    """What all sensors have in common."""

    def rows(self, case: Any) -> int:
        """How many rows it writes each time."""
        return 1

    def doubts(self, case: Any) -> Iterator[str]:
        """What of it is allowed in a checked case but doubtful: messages, after the name of the sensor."""
        yield from ()


class Gauge(Sensing):
    """Where the water level is written: the top of the highest connected water within `REACH` spacings."""

    REACH: ClassVar[float] = 1.5

    kind: Literal["gauge"] = Field("gauge", description="the water level at a place")
    name: Name = Field(description="name, used in results: a letter, then letters, digits, _ or -")
    x: Number = Field(description="place, m")
    y: Number | None = Field(None, description="place, m; left out: the middle of the box")


class Levelling(Sensing):
    """A line along which the water level is written, at points that are even apart."""

    kind: Literal["levels"] = Field(description="the water level along a line")
    name: Name = Field(description="name, used in results")
    start: tuple[Number, Number] = Field(description="first point, x and y, m; in 2D y is of no matter")
    end: tuple[Number, Number] = Field(description="last point, x and y, m")
    points: Annotated[Count, Field(ge=2, le=10000)] = Field(description="number of points, the ends with them")

    def rows(self, case: Any) -> int:
        """See `Sensing`."""
        return self.points

    def faults(self, case: Any) -> Iterator[str]:
        """What is wrong with it in a completed case: messages, after the name of the sensor."""
        for key, place in (("start", self.start), ("end", self.end)):
            for axis in case.axes[:-1]:
                low, high = case.box.min[axis], case.box.max[axis]
                if not low <= place[axis] <= high:
                    yield f"{key}.{axis} = {place[axis]!r}: outside the box; must be {low!r} to {high!r}"
        if all(self.start[axis] == self.end[axis] for axis in case.axes[:-1]):
            yield f"start, end = {list(self.start)}: must be two points"
        if case.gravity[2] >= 0.0:
            yield f"kind: gravity = {list(case.gravity)}: must go along -z where there are levels"


class Probe(Sensing):
    """Where the pressure of the water is written."""

    kind: Literal["pressure"] = Field(description="the pressure of the water at a point, of a wall too")
    name: Name = Field(description="name, used in results")
    x: Number = Field(description="place, m")
    y: Number | None = Field(None, description="place, m; left out: the middle of the box")
    z: Number = Field(description="place, m")
    body: Name | None = Field(None, description="body with which it moves, from that place at the start")
    filter: Filter | None = Field(None, description="what smooths it, over all steps; left out: nothing")


class Patch(Sensing):
    """Part of a wall on which the force of the water is written, by kind."""

    kind: Literal["force"] = Field(description="the force of the water on a wall, by pressure and by friction")
    name: Name = Field(description="name, used in results")
    wall: FaceName = Field(description="side of the box")
    min: Vector | None = Field(None, description="lowest corner of what counts, m; left out: all of it")
    max: Vector | None = Field(None, description="highest corner of what counts, m")
    filter: Filter | None = Field(None, description="what smooths it, over all steps; left out: nothing")

    def rows(self, case: Any) -> int:
        """See `Sensing`."""
        return 2


class Section(Sensing):
    """A plane x = constant through which flows are written."""

    WIDTH: ClassVar[float] = 3.0  # spacings to either side that count, less and less

    kind: Literal["flux"] = Field(description="discharge, wetted area and momentum flux through a plane")
    name: Name = Field(description="name, used in results")
    x: Number = Field(description="place, m")

    def doubts(self, case: Any) -> Iterator[str]:
        """See `Sensing`."""
        away = self.x - case.box.min[0]
        if case.box.faces.x_min.kind == "inlet" and away < self.WIDTH * case.spacing:
            yield (
                f"x = {self.x!r}: {away:.3g} m from the inlet; within {self.WIDTH:g} spacings of it the discharge is "
                "told up to a tenth too low"
            )


class Line(Sensing):
    """A plumb line on which the velocity of the water is written."""

    kind: Literal["velocity"] = Field(description="the velocity of the water along a plumb line")
    name: Name = Field(description="name, used in results")
    x: Number = Field(description="place, m")
    y: Number | None = Field(None, description="place, m; left out: the middle of the box")
    width: Positive = Field(description="edge of the square column over which is averaged, m")

    def rows(self, case: Any) -> int:
        """See `Sensing`."""
        return math.ceil(case.box.size[2] / case.spacing)

    def doubts(self, case: Any) -> Iterator[str]:
        """See `Sensing`."""
        if self.width < case.spacing:
            yield f"width = {self.width!r}: less than the spacing, {case.spacing!r} m; often there is no particle in it"


class Load(Sensing):
    """A body whose loads are told of all steps: mean, extremes and impulse between rows."""

    kind: Literal["load"] = Field(description="mean, extremes and impulse of what water and contacts do to bodies")
    name: Name = Field(description="name, used in results")
    body: Name | None = Field(None, description="body; left out: every fixed one")

    def rows(self, case: Any) -> int:
        """See `Sensing`."""
        return 2 * (1 if self.body else sum(body.fixed for body in case.bodies))


Sensor = choice(Gauge, Levelling, Probe, Patch, Section, Line, Load)
