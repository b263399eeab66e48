"""The contact law "spring": a linear spring of given stiffness between two bodies (Robb 2016, eqs 6-9)."""

from typing import Literal

from pydantic import Field

from parsim.case.types import Positive
from parsim.machine.compiled import compiled
from parsim.solid.laws.law import LawTable


class SpringLaw(LawTable):
    """A linear spring and dashpot, its stiffness given."""

    NUMBER = 2

    kind: Literal["spring"] = Field(description="a linear spring and dashpot")
    stiffness: Positive = Field(description="stiffness of a contact, N/m")

    def of_pair(self, one, two, thinnest):
        """Stiffness, N/m."""
        return self.stiffness


@compiled
def stiffness(own, area, bend, radius, depth):
    """See `kernels.stiffness`."""
    return own / area, 0.5, 1.0
