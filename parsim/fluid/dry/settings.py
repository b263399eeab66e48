"""What a case may say of a run without water: that it is one."""

import math
from typing import ClassVar, Literal

from pydantic import Field

from parsim.case.types import Table
from parsim.particles.state import COMMON


class Settings(Table):
    """Bodies alone; chosen by itself where there is no fill."""

    WET: ClassVar[bool] = False
    support: ClassVar[float] = 2.1

    kind: Literal["none"] = Field(description="no water, bodies alone; where there is no fill and nothing is said")

    @property
    def fields(self):
        """The fields of particles: those of every scheme."""
        return COMMON

    def sound_speed(self, speed):
        """Nothing is too fast."""
        return math.inf

    def faults(self, case):
        """Nothing of a completed case is unknown to it."""
        return []

    def doubts(self):
        """Nothing to doubt."""
        return []

    def scheme(self, case, timers=None):
        """The scheme of a case without water."""
        from parsim.fluid.dry.scheme import Dry  # brings numba along, whose settings a run makes first

        return Dry(case)
