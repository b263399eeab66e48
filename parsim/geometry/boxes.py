"""Exact tests on turned boxes: corners, reach, overlap. Angles in degrees, lengths in m."""

from dataclasses import dataclass
from itertools import product

import numpy as np


@dataclass(frozen=True)
class TurnedBox:
    """A box: centre (3,), half edge lengths (3,), axes (3, 3) whose columns are its edge directions."""

    centre: np.ndarray
    half: np.ndarray
    axes: np.ndarray

    @property
    def corners(self):
        """The eight corners, (8, 3), m."""
        signs = np.array(list(product((-1.0, 1.0), repeat=3)))
        return self.centre + (signs * self.half) @ self.axes.T

    @property
    def reach(self):
        """Half extents along x, y and z, (3,), m."""
        return np.abs(self.axes) @ self.half


def rotation(angles):
    """Matrix (3, 3) that turns about the fixed x, then y, then z axis by `angles` (3,), degrees."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def of_body(body):
    """The box of a body of a case."""
    return TurnedBox(np.array(body.position), np.array(body.shape.size) / 2, rotation(body.angles))


def clearance(box, points):
    """Distance (n,) of points (n, 3) from a box, m; 0 inside."""
    over = np.maximum(np.abs((points - box.centre) @ box.axes) - box.half, 0.0)
    return np.sqrt((over**2).sum(axis=1))


def upright(low, high):
    """The box between the corners `low` and `high`, (3,)."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    return TurnedBox((low + high) / 2, (high - low) / 2, np.eye(3))


def overlap(first, second, shift=(0.0, 0.0, 0.0)):
    """Least depth, m, by which `first` enters `second` moved by `shift`; 0 or less when they are apart or touch.

    Separating axes (Gottschalk, Lin & Manocha 1996): three of each box and their nine cross products.
    """
    between = second.centre + np.asarray(shift) - first.centre
    crosses = np.cross(first.axes.T[:, None, :], second.axes.T[None, :, :]).reshape(9, 3)
    lengths = np.linalg.norm(crosses, axis=1)
    directions = np.vstack([first.axes.T, second.axes.T, crosses[lengths > 1e-9] / lengths[lengths > 1e-9, None]])
    reach = np.abs(directions @ first.axes) @ first.half + np.abs(directions @ second.axes) @ second.half
    return float(np.min(reach - np.abs(directions @ between)))


def near_pairs(boxes, period=(np.inf, np.inf, np.inf)):
    """Yield (i, j, shift) of boxes whose extents overlap, j > i; `shift` moves j to its nearest periodic image."""
    centres = np.array([box.centre for box in boxes]).reshape(-1, 3)
    reaches = np.array([box.reach for box in boxes]).reshape(-1, 3)
    period = np.asarray(period)
    length = np.where(np.isfinite(period), period, 0.0)
    for i in range(len(boxes) - 1):
        between = centres[i + 1 :] - centres[i]
        shifts = -length * np.round(between / period)
        near = np.all(np.abs(between + shifts) < reaches[i + 1 :] + reaches[i], axis=1)
        for j in np.flatnonzero(near):
            yield i, i + 1 + int(j), shifts[j]
