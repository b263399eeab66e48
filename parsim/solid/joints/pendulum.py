"""A joint that hangs a body: a rigid rod without mass from its centre to a point."""

import math
from typing import Literal

from pydantic import Field

from parsim.case.types import Vector
from parsim.solid.joints.joint import JointTable


class PendulumTable(JointTable):
    """The centre of the body keeps its distance from a pivot; the body turns freely about its centre."""

    kind: Literal["pendulum"] = Field(description="hangs by a rigid rod from a point, and swings freely")
    pivot: Vector = Field(description="where it hangs, m")

    def faults(self, body, planar):
        """See `JointTable`."""
        if planar and self.pivot[1] != 0.5:
            yield f"pivot = {list(self.pivot)}: y must be 0.5 in a 2D case"
        if body.position[2] == "float":
            return
        arm = [p - q for p, q in zip(body.position, self.pivot, strict=True)]
        length = math.hypot(*arm)
        if length == 0.0:
            yield f"pivot = {list(self.pivot)}: is the centre of the body; hang it by a rod of some length"
        elif abs(sum(v * r for v, r in zip(body.velocity, arm, strict=True))) > 1e-9 * length:
            yield f"body: starts with a velocity {list(body.velocity)} along the rod; across it is allowed"
