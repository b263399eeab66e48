"""A side where water goes out at a level."""

from typing import Annotated, Literal

from pydantic import Field

from parsim.boundary.sides.side import SideTable
from parsim.case.course import Course, Rows
from parsim.case.types import Positive, Share, Table


class NormalDepth(Table):
    """Uniform flow beyond the outlet: Q = A R^(2/3) S^(1/2) / n (Manning)."""

    manning: Positive = Field(description="Manning's n, s/m^(1/3)")
    slope: Annotated[Positive, Field(le=1)] = Field(description="slope of the bed beyond it")


class OutletSide(SideTable):
    """Outlet: water goes out, against the pressure of water at rest with a level; walls go on beyond it."""

    kind: Literal["outlet"] = Field(description="water goes out")
    level: Course | None = Field(
        None, description='height of the water there, m: a number, rows of [time, s, value] or {file = "h.csv"}'
    )
    rating: Rows | None = Field(None, description="rows of [discharge, m3/s (2D: m2/s), level, m], both growing")
    normal: NormalDepth | None = Field(None, description="the depth of uniform flow over what stands there")
    absorb: Share = Field(1.0, description="share of a wave from inside that is let out; the rest comes back")
    continues = True
