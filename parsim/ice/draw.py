"""The draw of a floe: all its numbers from a counter that begins with its key, so that it hangs on no other floe."""

from __future__ import annotations

import math
import zlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.ice.laws import Ratio

if TYPE_CHECKING:
    from collections.abc import Iterator

    from parsim.ice.laws import LawTable

LEAST_CORNERS, MOST_CORNERS = 5, 8  # of a polygon
_UNEVEN = 0.6  # share of the angle between two corners by which they may be off
_ROUND = 24  # sides of the polygon around a disc
_DIGITS = 9  # of lengths: what processors make differently lies behind them
_NUMBERS = 4 + MOST_CORNERS


class Laws(NamedTuple):
    """What floes are drawn from: shape, laws of size, thickness and aspect, and dimensions of the case."""

    shape: str
    size: LawTable
    thickness: LawTable | Ratio
    aspect: LawTable
    dimensions: int = 3


class Floe(NamedTuple):
    """A floe. `key`: seed, stream and number. Its size is the longer edge of a box, the diameter of a disc, and that of
    the circle of a polygon's area. outline (k, 2): corners in plan about the centre of area, anticlockwise; of a disc
    those of a polygon around it. Lengths in m, area in m2; in a 2D case its outline is a metre across."""

    key: tuple[int, int, int]
    shape: str
    size: float
    thickness: float
    outline: np.ndarray
    area: float

    @property
    def round(self) -> float:
        """Radius of a disc, m; else 0."""
        return 0.5 * self.size if self.shape == "disc" else 0.0


def stream_of(name: str) -> int:
    """The number of the stream of draws of what has this name: it hangs on no other stream."""
    return zlib.crc32(name.encode())


def evenly(key: tuple[int, int, int], part: int, count: int) -> list[float]:
    """Numbers from 0 to 1 of floe `key`, from a `part` of its counter that is used for nothing else."""
    seed, stream, number = key
    counter = np.array([0, part, number, 0], dtype=np.uint64)
    raw = np.random.Philox(key=np.array([seed, stream], dtype=np.uint64), counter=counter).random_raw(count)
    return ((raw >> np.uint64(11)) * 2.0**-53).tolist()


def draw(seed: int, stream: int, number: int, laws: Laws) -> Floe:
    """Floe `number` of a stream."""
    key = (seed, stream, number)
    of_size, of_thickness, of_aspect, of_corners, *rest = evenly(key, 0, _NUMBERS)
    size = rounded(laws.size.at(of_size, laws.dimensions))
    thick = laws.thickness
    thickness = rounded(thick.of(size) if isinstance(thick, Ratio) else thick.at(of_thickness, laws.dimensions))
    aspect = laws.aspect.at(of_aspect)
    if laws.dimensions == 2:
        outline = _rectangle(size, 1.0)
    elif laws.shape == "box":
        outline = _rectangle(size, rounded(size / aspect))
    elif laws.shape == "disc":
        outline = _ring([2.0 * math.pi * k / _ROUND for k in range(_ROUND)], 0.5 * size / math.cos(math.pi / _ROUND))
    else:
        outline = _polygon(size, aspect, of_corners, rest)
    area = math.pi / 4.0 * size**2 if laws.shape == "disc" else area_of(outline)
    return Floe(key, laws.shape, size, thickness, outline, area)


def drawn(seed: int, stream: int, laws: Laws) -> Iterator[Floe]:
    """The floes of a stream, from number 1 on."""
    number = 0
    while True:
        number += 1
        yield draw(seed, stream, number, laws)


def area_of(outline: np.ndarray) -> float:
    """Area of a polygon (k, 2), m2."""
    x, y = outline.T
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def rounded(value: float, scale: float | None = None) -> float:
    """`value` to the digits that a length of this scale has, its own if left out."""
    return round(value, _DIGITS - math.ceil(math.log10(scale or value)))


def _rectangle(length, width):
    x, y = 0.5 * length, 0.5 * width
    return np.array([[-x, -y], [x, -y], [x, y], [-x, y]])


def _ring(angles, radius, aspect=1.0):
    """Corners at these angles, rad, on an ellipse: always convex."""
    return np.array([[radius * math.cos(angle), radius / aspect * math.sin(angle)] for angle in angles])


def _polygon(size, aspect, of_corners, uneven):
    """Corners on an ellipse at uneven angles, of the area that a circle of this diameter has."""
    count = min(LEAST_CORNERS + int(of_corners * (MOST_CORNERS + 1 - LEAST_CORNERS)), MOST_CORNERS)
    steps = [k + _UNEVEN * (off - 0.5) for k, off in enumerate(uneven[:count])]
    corners = _ring([2.0 * math.pi * step / count for step in steps], 1.0, aspect)
    corners *= math.sqrt(math.pi / 4.0 * size**2 / area_of(corners))
    x, y = corners.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    corners = corners - ((corners + np.roll(corners, -1, axis=0)) * cross[:, None]).sum(axis=0) / (3.0 * cross.sum())
    return np.array([[rounded(p, size) for p in corner] for corner in corners.tolist()])
