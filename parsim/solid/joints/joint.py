"""What every joint is: a table that ties one body to the world."""

from typing import ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from parsim.case.types import Name, Number, Table


class Pose(NamedTuple):
    """How a body has been moved from its start: shift (3,), m, then turned about its centre by turn (3,), rad."""

    shift: np.ndarray
    turn: np.ndarray


class JointTable(Table):
    """What a case may say of a joint. DRIVES: it prescribes the motion of its body, by `pose`."""

    DRIVES: ClassVar[bool] = False

    body: Name = Field(description="name of the body that it ties")

    def faults(self, body, planar):
        """What is wrong with it for this body of the case: messages, each beginning with a key."""
        return []


class DrivingTable(JointTable):
    """A joint that prescribes how its body moves, from a time on."""

    DRIVES = True

    begins: Number = Field(0.0, description="time at which the motion begins, s; held before")

    def pose(self, time, centre):
        """`Pose` of the body, whose centre (3,), m, was there at the start, `time`, s, after it began."""
        raise NotImplementedError

    def faults(self, body, planar):
        """See `JointTable`."""
        if any((*body.velocity, *body.spin)) or body.fixed or body.released is not None:
            yield "body: its motion is prescribed; leave out velocity, spin, fixed and released of the body"
        if planar:
            for time in (0.1, 0.3, 1.0):
                pose = self.pose(time, np.array([v if v != "float" else 0.0 for v in body.position]))
                if abs(pose.shift[1]) > 1e-12 or np.abs(pose.turn[[0, 2]]).max() > 1e-12:
                    yield "kind: leads out of the plane of a 2D case; bodies move in x and z and turn about y only"
                    return
