"""A side where water comes in."""

from typing import Literal

from pydantic import Field

from parsim.boundary.sides.side import SideTable
from parsim.case.course import Course
from parsim.case.types import Share
from parsim.fluid.profiles import Profile


class InletSide(SideTable):
    """Inlet: a discharge comes in; walls go on beyond it."""

    kind: Literal["inlet"] = Field(description="water comes in")
    discharge: Course = Field(
        description='discharge, m3/s (2D: m2/s): a number, rows of [time, s, value] or {file = "q.csv"}'
    )
    level: Course | None = Field(
        None, description="height of the water that comes in, m; left out: that of the water inside, one depth on"
    )
    profile: Profile | None = Field(
        None, description="velocity over the depth, as a share of its mean; left out: the same everywhere"
    )
    absorb: Share = Field(
        0.0, description="share of a wave from inside that is let out, by a discharge that gives way to it for its time"
    )
    continues = True
