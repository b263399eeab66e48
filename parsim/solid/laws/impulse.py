"""The contact law "impulse": bodies that do not yield. Contacts take no time: see `solid.impulses`."""

from typing import Annotated, Literal

from pydantic import Field

from parsim.case.types import Count, Real
from parsim.solid.laws.law import LawTable


class ImpulseLaw(LawTable):
    """Hard bodies: impulses with friction, found for all contacts together."""

    NUMBER = 3
    INSTANT = True

    kind: Literal["impulse"] = Field(description="hard bodies, whose contacts take no time")
    sweeps: Count = Field(200, description="sweeps over all contacts to find the impulses, at most")
    residual: Annotated[Real, Field(gt=0, le=1e-2)] = Field(
        1e-6, description="change of speed in a sweep, over the largest, at which they are found"
    )

    def of_pair(self, one, two, thinnest):
        """Nothing: hard bodies have no stiffness."""
        return 0.0
