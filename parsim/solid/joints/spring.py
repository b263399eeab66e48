"""A joint that pulls: a spring and dashpot from a point of a body to a point or a line, a mooring or a boom."""

import math
from typing import Literal

from pydantic import Field

from parsim.case.types import NotNegative, Positive, Switch, Vector
from parsim.solid.joints.joint import JointTable


class SpringTable(JointTable):
    """A linear spring and dashpot to the nearest point of a line, or to a point."""

    kind: Literal["spring"] = Field(description="a spring to a point or to a line")
    at: Vector = Field((0.0, 0.0, 0.0), description="where on the body it is fixed, from its centre before turning, m")
    to: Vector = Field(description="where it is fixed in space, m: the point, or the start of the line")
    line_to: Vector | None = Field(None, description="end of the line, m; left out: a point")
    stiffness: Positive = Field(description="stiffness, N/m")
    damping: NotNegative = Field(0.0, description="force over speed along it, N s/m")
    length: NotNegative = Field(0.0, description="its length without force, m")
    slack: Switch = Field(False, description="pulls only, as a rope does")

    def row(self):
        """Where it is fixed on the body (3,), m, and ten numbers as kernels take them: see `ties.Joints`."""
        end = self.to if self.line_to is None else self.line_to
        return [self.at, *self.to, *end, self.stiffness, self.damping, self.length, float(self.slack)]

    def faults(self, body, planar):
        """See `JointTable`."""
        if self.line_to is not None and math.dist(self.to, self.line_to) == 0.0:
            yield f"line_to = {list(self.line_to)}: is where the line starts; leave it out for a point"
        if planar:
            for key, value in (("to", self.to), ("line_to", self.line_to)):
                if value is not None and value[1] != 0.5:
                    yield f"{key} = {list(value)}: y must be 0.5 in a 2D case"
            if self.at[1]:
                yield f"at = {list(self.at)}: y must be 0 in a 2D case"
