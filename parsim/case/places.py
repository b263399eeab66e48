"""Exact tests on turned boxes and balls: reach, distance, overlap. Angles in degrees, lengths in m."""

from dataclasses import dataclass, replace

import numpy as np

from parsim.solid.shapes.box import distance


@dataclass(frozen=True)
class TurnedBox:
    """A box, or the ball in it: centre (3,), half edges (3,), axes (3, 3) whose columns are its edge directions."""

    centre: np.ndarray
    half: np.ndarray
    axes: np.ndarray
    round: bool = False

    @property
    def reach(self):
        """Half extents along x, y and z, (3,), m."""
        return self.half if self.round else np.abs(self.axes) @ self.half

    def grown(self, by):
        """The same with its surface moved outwards by `by`, m."""
        return replace(self, half=self.half + by)


def rotation(angles):
    """Matrix (3, 3) that turns about the fixed x, then y, then z axis by `angles` (3,), degrees."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def of_body(body):
    """The place that a body of a case takes."""
    return TurnedBox(np.array(body.position), np.array(body.shape.half), rotation(body.angles), body.shape.ROUND)


def clearance(box, points):
    """Distance (n,) of points (n, 3) from a box or ball, m; 0 inside."""
    if box.round:
        return np.maximum(np.linalg.norm(points - box.centre, axis=1) - box.half[0], 0.0)
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
    if first.round or second.round:
        ball, other, way = (first, second, -between) if first.round else (second, first, between)
        if other.round:
            return float(first.half[0] + second.half[0] - np.linalg.norm(between))
        high, _ = distance(other.axes.T @ way, other.half, (True, True, True))
        return float(ball.half[0] - high)
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
