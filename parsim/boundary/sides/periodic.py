"""A side beyond which the box begins again at the opposite one."""

from typing import Literal

from pydantic import Field

from parsim.boundary.sides.side import SideTable


class PeriodicSide(SideTable):
    """Periodic: what passes comes in at the opposite side."""

    kind: Literal["periodic"] = Field("periodic", description="what passes comes in at the opposite side")
    repeats = True
