"""What becomes of blocks that drift against a floating cover."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import matrices

LEVEL, FLAT, OVER = 15.0, 45.0, 90.0  # degrees: stable below, submerged flat below, under-turned from
UNDER = 0.25  # of its length, that the centre of a submerged block is under the cover
AT_REST = 0.05  # of its length, that a block at rest moves at most while the water passes it


class Cover(NamedTuple):
    """Upstream and downstream edge of a cover, m."""

    begin: float
    end: float


class Block(NamedTuple):
    """name: "passed", "stable", "submerged", "under-turned", "stuck" or "undecided"; tilt, degrees, the largest on the
    way; critical: whether it has not stayed at the cover's edge."""

    name: str
    tilt: float
    critical: bool


def tilts(up: np.ndarray) -> np.ndarray:
    """Angles (T,), degrees, by which a block has tilted out of where it first was, from the direction (T, 3) that was
    up then and turns with it."""
    return np.degrees(np.arccos(np.clip(up[:, 2], -1.0, 1.0)))


def ups(quaternion: np.ndarray) -> np.ndarray:
    """The direction (T, 3) that is up in the first row and turns with a body, from its quaternions (T, 4)."""
    turns = matrices(np.ascontiguousarray(quaternion))
    return turns @ turns[0, 2]


class Path(NamedTuple):
    """Of a block at each row (T,): time, s; x of its centre, m, NaN where it is not there; tilt, degrees; whether its
    centre is lower than that of the cover, and not beside it."""

    time: np.ndarray
    x: np.ndarray
    tilt: np.ndarray
    below: np.ndarray


def block(path: Path, length: float, cover: Cover, water: float) -> Block:
    """Class of a block of a `length` along x, m, by its way.

    `water`: speed of the water, m/s. A block rests if it has moved by AT_REST of its length at most while the water
    passed it once. One that has turned over is "under-turned", one whose centre has come UNDER of its length under the
    cover and had not tilted by FLAT till then is "submerged", whatever becomes of either. Any other has "passed", or is
    "stuck" if it rests under the cover, or "stable" if it rests level at its edge. One that began downstream of the
    cover is undecided unless it turned over.
    """
    there = np.isfinite(path.x)
    path = Path(*(row[there] for row in path))
    most = float(path.tilt.max(initial=0.0))
    name = _name(path, length, cover, water) if there.any() else "undecided"
    return Block(name, most, name not in ("stable", "undecided"))


def _name(path, length, cover, water):
    _, x, tilt, below = path
    if (tilt >= OVER).any():
        return "under-turned"
    under = below & (x >= cover.begin + UNDER * length) & (x <= cover.end)
    if under.any() and tilt[: under.argmax() + 1].max() < FLAT:
        return "submerged"
    if x[-1] > cover.end:
        return "passed" if x[0] <= cover.end else "undecided"
    if not _rests(path, length, water):
        return "undecided"
    if x[-1] > cover.begin:
        return "stuck" if below[-1] else "undecided"
    touching = x[-1] >= cover.begin - length
    return "stable" if touching and tilt[-1] < LEVEL else "undecided"


def _rests(path, length, water):
    """Whether a block has come to rest; not known of one that is there for less than the time that this takes."""
    if water <= 0.0 or path.time[-1] - path.time[0] < length / water:
        return False
    since = np.searchsorted(path.time, path.time[-1] - length / water, side="right") - 1
    moved = np.abs(path.x[since:] - path.x[-1]).max()
    return bool(moved <= AT_REST * length)
