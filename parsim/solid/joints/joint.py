"""What every joint is: a table that ties one body to the world."""

from collections.abc import Iterator
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

    def ways(self) -> Iterator[tuple[str, tuple[float, ...], tuple[float, ...]]]:
        """Where it leads: of each key that says so its name, shifts (3,) and vectors of turns (3,), of any size."""
        raise NotImplementedError

    def fastest(self, centre, radius):
        """Bound of the speed, m/s, of any point of a body of this radius, m, with its centre (3,), m, at the start."""
        raise NotImplementedError

    def faults(self, body, planar):
        """See `JointTable`."""
        if any((*body.velocity, *body.spin)) or body.fixed or body.released is not None:
            yield "body: its motion is prescribed; leave out velocity, spin, fixed and released of the body"
        for key, shift, turn in self.ways() if planar else ():
            if shift[1] or turn[0] or turn[2]:
                yield f"{key}: leads out of the plane of a 2D case; bodies move in x and z and turn about y only"
                return
