"""From the coordinates of a file to those of a case: where its origin lies, how it is turned, where z is zero."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class Frame(NamedTuple):
    """origin (2,): the place in the file, in its units, where the case has x = y = 0; angle, degrees, by which the x
    axis of the case is turned from that of the file, anticlockwise; datum: the height in the file that is z = 0 in the
    case; scale, m, of one unit of the file."""

    origin: tuple[float, float] = (0.0, 0.0)
    angle: float = 0.0
    datum: float = 0.0
    scale: float = 1.0

    def of_file(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places in the file of places x, y, m, of the case."""
        c, s = _turn(self.angle)
        return self.origin[0] + (c * x - s * y) / self.scale, self.origin[1] + (s * x + c * y) / self.scale

    def of_case(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places in the case, m, of places x, y in the file."""
        c, s = _turn(self.angle)
        x, y = self.scale * (x - self.origin[0]), self.scale * (y - self.origin[1])
        return c * x + s * y, c * y - s * x

    def height(self, z: np.ndarray) -> np.ndarray:
        """Heights in the case, m, of heights in the file."""
        return self.scale * (z - self.datum)


def along(first: tuple[float, float], second: tuple[float, float]) -> tuple[tuple[float, float], float]:
    """Origin and angle, degrees, of a `Frame` whose x axis runs from one place of a file to another."""
    return first, math.degrees(math.atan2(second[1] - first[1], second[0] - first[0]))


def _turn(angle):
    """Cosine and sine, exact for quarter turns."""
    quarters = angle / 90.0
    if quarters == round(quarters):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    return math.cos(math.radians(angle)), math.sin(math.radians(angle))
