"""What becomes of blocks that drift against a floating cover."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import matrices

LEVEL, FLAT, OVER = 15.0, 45.0, 90.0  # degrees: stable below, submerged flat below, under-turned from
UNDER = 0.25  # of its length, that the centre of a submerged block is under the cover
AT_REST = 0.05  # of the water's speed


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


def block(x: np.ndarray, tilt: np.ndarray, speed: np.ndarray, length: float, cover: Cover, water: float) -> Block:
    """Class of a block of a `length` along x, m, from its centre (T,), m, tilt (T,), degrees, and speed (T,), m/s.

    `water`: speed of the water, m/s. One that has turned over is "under-turned", one whose centre has come UNDER of its
    length under the cover and had not tilted by FLAT till then is "submerged", whatever becomes of either. Any other
    has "passed", or is "stuck" if it rests under the cover, or "stable" if it rests level at its edge. One that began
    downstream of the cover is undecided unless it turned over.
    """
    there = np.isfinite(x)
    x, tilt, speed = x[there], tilt[there], speed[there]
    most = float(tilt.max(initial=0.0))
    name = _name(x, tilt, speed, length, cover, water) if len(x) else "undecided"
    return Block(name, most, name not in ("stable", "undecided"))


def _name(x, tilt, speed, length, cover, water):
    if (tilt >= OVER).any():
        return "under-turned"
    under = (x >= cover.begin + UNDER * length) & (x <= cover.end)
    if under.any() and tilt[: under.argmax() + 1].max() < FLAT:
        return "submerged"
    if x[-1] > cover.end:
        return "passed" if x[0] <= cover.end else "undecided"
    if abs(speed[-1]) > AT_REST * water:
        return "undecided"
    if x[-1] > cover.begin:
        return "stuck"
    touching = x[-1] >= cover.begin - length
    return "stable" if touching and tilt[-1] < LEVEL else "undecided"
