"""Powers of two near the size of what a case is about: units in which sums over ranks are exact."""

import math
from typing import NamedTuple


class Scales(NamedTuple):
    """length, m; mass, kg (2D: per metre of width); time, s."""

    length: float
    mass: float
    time: float

    @property
    def energy(self):
        """J."""
        return self.mass * (self.length / self.time) ** 2

    @property
    def force(self):
        """N."""
        return self.energy / self.length

    def pressure(self, dimensions):
        """Pa."""
        return self.energy / self.length**dimensions


def scales(case):
    """Those of a case: the longest edge of its box, the water of a cube of that, the time that water takes along it."""
    longest = max(case.box.size[axis] for axis in case.axes)
    gravity = math.hypot(*case.gravity)
    speed = case.speed or math.sqrt(gravity * longest) or longest
    length = power_of_two(longest)
    return Scales(length, power_of_two(case.water.density * longest ** len(case.axes)), length / power_of_two(speed))


def power_of_two(value):
    """The largest power of two that is at most `value` > 0."""
    return 2.0 ** (math.frexp(value)[1] - 1)
