"""Where there is room for a floe in plan: places and turns at random until one is clear of all that is taken."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.ice.draw import evenly
from parsim.ice.outlines import Outlines, gaps, moved, outlines

if TYPE_CHECKING:
    from parsim.ice.draw import Floe

TRIES = 50  # places looked at for a floe
_PLACES = 1  # part of a floe's counter


class Pose(NamedTuple):
    """Centre x, y, m, and turn, rad, of a floe."""

    x: float
    y: float
    turn: float


class Region(NamedTuple):
    """The rectangle in plan in which floes may be, m."""

    low: tuple[float, float]
    high: tuple[float, float]


class Taken:
    """What is taken of the plan, in a grid of cells; all that comes to it keeps a `gap`, m, to what is there."""

    def __init__(self, region: Region, gap: float, cell: float) -> None:
        self.region, self.gap, self._cell = region, gap, cell
        self._cells: dict[tuple[int, int], list[int]] = {}
        self._there: list[Outlines] = []
        self._discs: list[tuple[float, ...]] = []  # centre, radius of the circle in it and of that around it

    def add(self, own: Outlines) -> None:
        """Take what one outline covers."""
        for cell in self._over([float(end[0]) for end in own.extents()], self.gap):  # beside the region too
            self._cells.setdefault(cell, []).append(len(self._there))
        self._there.append(own)
        self._discs.append(_discs_of(own))

    def clear(self, own: Outlines) -> bool:
        """Whether one outline keeps the gap to all that is there."""
        cells = self._over([float(end[0]) for end in own.extents()], self.gap)
        cx, cy, inner, outer = _discs_of(own)
        unsure = []
        for row in {row for cell in cells for row in self._cells.get(cell, ())}:
            x, y, within, around = self._discs[row]
            square = (x - cx) ** 2 + (y - cy) ** 2
            if square < (inner + within + self.gap) ** 2:
                return False
            if square < (outer + around + self.gap) ** 2:
                unsure.append(row)
        return all((gaps(own, self._there[row]).apart >= self.gap).all() for row in sorted(unsure))

    def _over(self, box, margin):
        """Cells that a box (x, y, x, y) and a margin around it reach into, of those that the region has."""
        ranges = []
        for axis in (0, 1):
            low = max(box[axis] - margin, self.region.low[axis]) - self.region.low[axis]
            high = min(box[axis + 2] + margin, self.region.high[axis]) - self.region.low[axis]
            ranges.append(range(math.floor(low / self._cell), math.floor(high / self._cell) + 1))
        return list(itertools.product(*ranges))


def place(floe: Floe, taken: Taken, tries: int = TRIES) -> Pose | None:
    """A place for a floe that is clear of all that is taken, which it then takes too; None if none was found."""
    own = outlines([floe.outline], [floe.round])
    dice = evenly(floe.key, _PLACES, 3 * tries)
    for along, across, around in zip(dice[::3], dice[1::3], dice[2::3], strict=True):
        pose = somewhere(own, taken.region, (along, across, around))
        if pose is None:
            continue
        there = at(own, pose)
        if taken.clear(there):
            taken.add(there)
            return pose
    return None


def somewhere(own: Outlines, region: Region, dice: tuple[float, float, float]) -> Pose | None:
    """The pose in a region that three numbers from 0 to 1 mean; None where the floe, so turned, does not fit."""
    turn = 2.0 * math.pi * dice[2]
    box = [float(end[0]) for end in at(own, Pose(0.0, 0.0, turn)).extents()]
    centre = []
    for axis in (0, 1):
        low, high = region.low[axis] - box[axis], region.high[axis] - box[axis + 2]
        if low > high:
            return None
        centre.append(low + dice[axis] * (high - low))
    return Pose(centre[0], centre[1], turn)


def at(own: Outlines, pose: Pose) -> Outlines:
    """One outline at a pose."""
    return moved(own, *(np.array([v]) for v in (pose.x, pose.y, math.cos(pose.turn), math.sin(pose.turn))))


def _discs_of(own):
    """Centre x, y of one outline, radius of the circle about it within, and of that around it, m."""
    point = own._replace(x=own.cx[:, None], y=own.cy[:, None], round=np.zeros(1))
    within = own.round if own.round[0] else -gaps(own._replace(round=np.zeros(1)), point).apart
    return float(own.cx[0]), float(own.cy[0]), float(within[0]), float(own.round[0] or own.radius[0])
