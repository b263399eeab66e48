"""What flows through a channel that repeats, and what drives it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.case.course import at_time
from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Channel:
    """One row: means over the length of the channel at the last step.

    drive: the force along x in all besides gravity, by mass; energy_slope: all that drives along x over what pulls
    across it, which with steady flow is what bed, walls and ice take; ice: discharge of the volume of free bodies.
    """

    name = "channel"
    columns = columns(discharge="m3/s", wanted="m3/s", ice="m3/s", drive="m/s2", energy_slope="-")

    def __init__(self, case: Case) -> None:
        self._channel, self._gravity, self._length = case.channel, case.gravity, case.box.size[0]
        self._volumes = np.array([body.shape.volume for body in case.bodies])

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        if self._channel is None:
            return []
        pull, bodies = s.solids.pull, s.bodies
        free = ~(bodies.held(s.time) | bodies.gone)
        ice = float((self._volumes[free] * bodies.velocity[free, 0]).sum()) / self._length
        x, y, z = self._gravity
        slope = (x + pull.drive) / np.hypot(y, z) if y or z else np.nan
        return [[pull.discharge, at_time(self._channel.discharge, s.time), ice, pull.drive, float(slope)]]
