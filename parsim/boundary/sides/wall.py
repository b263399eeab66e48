"""A wall along a side of the box."""

from typing import Literal

from pydantic import Field

from parsim.boundary.sides.side import SideTable
from parsim.case.types import Vector


class WallSide(SideTable):
    """A wall: nothing passes."""

    kind: Literal["wall"] = Field("wall", description="a wall")
    velocity: Vector | None = Field(
        None, description="velocity in its own plane, m/s, which the water feels by friction; left out: at rest"
    )
    holds_water = holds_bodies = True
