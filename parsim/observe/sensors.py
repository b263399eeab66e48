"""What a case may say of a place where something is measured: one table for each kind, listed at the end."""

from typing import ClassVar, Literal

from pydantic import Field

from parsim.case.types import Name, Number, Table, choice


class Gauge(Table):
    """Where the water level is written: the top of the highest connected water within `REACH` spacings."""

    REACH: ClassVar[float] = 1.5

    kind: Literal["gauge"] = Field("gauge", description="the water level at a place")
    name: Name = Field(description="name, used in results: a letter, then letters, digits, _ or -")
    x: Number = Field(description="place, m")
    y: Number | None = Field(None, description="place, m; left out: the middle of the box")


Sensor = choice(Gauge)
