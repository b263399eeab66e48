"""The scheme of a run without water: bodies and contacts, no particles."""

import math

import numpy as np

from parsim.fluid.reference import Lattice

_LONGEST = 0.1  # of the time between rows of the series, that a step may be


class Dry:
    """See `parsim.fluid.scheme.Scheme`."""

    STATE = ("x",)  # nothing is needed; the exchange wants one field

    def __init__(self, case):
        self.lattice = Lattice(case.dimensions, case.spacing, case.water.scheme.support, "wendland_c2")
        self.mass, self.sound, self._cfl = 0.0, math.inf, case.run.cfl
        self._longest = _LONGEST * case.output.series

    def time_step(self, speed, acceleration=0.0):
        """A time, s, in which nothing moves more than a spacing; contacts have steps of their own within it."""
        limits = [self._longest]
        if speed > 0.0:
            limits.append(self._cfl * self.lattice.spacing / speed)
        if acceleration > 0.0:
            limits.append(self._cfl * math.sqrt(2.0 * self.lattice.spacing / acceleration))
        return min(limits)

    def at_rest(self, pressure):
        """No fields."""
        return {}

    def step(self, flow, solids, time, dt):
        """Bodies over dt, s, under gravity and contacts."""
        solids.advance(flow, time, dt)

    def rubbed(self, flow, solids, at):
        """Nothing, (0, 3)."""
        return np.zeros((at.size, 3))

    def extremes(self, p, near, start):
        """No water moves."""
        return 0.0, 0.0

    def compression(self, p, at):
        """Of nothing, (0,)."""
        return np.ones(at.size)

    def shares(self, p, at):
        """Of nothing, (0,)."""
        return np.ones(at.size)

    def elastic(self, p, at):
        """Of nothing, (0,)."""
        return np.zeros(at.size)
