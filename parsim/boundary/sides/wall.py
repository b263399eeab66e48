"""A wall along a side of the box."""

from typing import Literal

from pydantic import Field

from parsim.boundary.sides.side import SideTable


class WallSide(SideTable):
    """A wall: nothing passes."""

    kind: Literal["wall"] = Field("wall", description="a wall")
    holds_water = holds_bodies = True
