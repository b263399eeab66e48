"""A side of the box with nothing on it."""

from typing import Literal

from pydantic import Field

from parsim.boundary.sides.side import SideTable


class OpenSide(SideTable):
    """Open: water and bodies that pass have left; see `run.outside`."""

    kind: Literal["open"] = Field("open", description="what passes has left")
