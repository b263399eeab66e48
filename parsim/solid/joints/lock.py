"""A joint that locks degrees of freedom: guide rails."""

from typing import Annotated, Literal

from pydantic import Field

from parsim.solid.joints.joint import JointTable

AXES = ("x", "y", "z", "turn_x", "turn_y", "turn_z")


class LockTable(JointTable):
    """The body cannot move along, or turn about, some of the axes of space."""

    kind: Literal["lock"] = Field(description="locks degrees of freedom, as guide rails do")
    locked: Annotated[tuple[Literal[AXES], ...], Field(min_length=1)] = Field(description="what is locked")

    def faults(self, body, planar):
        """See `JointTable`."""
        moving = dict(zip(AXES, (*body.velocity, *body.spin), strict=True))
        for name in self.locked:
            if moving[name]:
                yield f'locked: "{name}" is, but the body starts with {moving[name]:g} along it'
