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


def gravity_at(case, time):
    """Gravity (3,), m/s2, at a time, s: it may grow from nothing at the start."""
    share = min(max(time / case.gravity_ramp, 0.0), 1.0) if case.gravity_ramp > 0.0 else 1.0
    return tuple(share * g for g in case.gravity)


def power_of_two(value):
    """The largest power of two that is at most `value` > 0."""
    return 2.0 ** (math.frexp(value)[1] - 1)
