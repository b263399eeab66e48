"""Surfaces of bodies from their outlines, and the volume in them."""

import numpy as np


def stood(corners, height):
    """Surface (see `ShapeTable.surface`) of a body `height`, m, tall about the plane of its `corners` (k, 2)."""
    count = len(corners)
    points = np.concatenate([np.column_stack([corners, np.full(count, 0.5 * sign * height)]) for sign in (-1, 1)])
    quads = [(k, (k + 1) % count, count + (k + 1) % count, count + k) for k in range(count)]
    for k in range(1, count - 1, 2):
        last = min(k + 2, count - 1)
        quads += [(0, last, k + 1, k), (count, count + k, count + k + 1, count + last)]
    return points, np.array(quads)


def laid(corners):
    """Surface of a 2D body, a metre across, from its `corners` (k, 2) in the x-z plane."""
    points, quads = stood(corners, 1.0)
    return points[:, [0, 2, 1]] * (1.0, -1.0, 1.0), quads


def volume_under(height, points, quads):
    """Volume, m3, of the part of a closed surface (see `ShapeTable.surface`) where `height` (k,), m, is below zero.

    Sums cones from the foot of the origin in the plane, whose own part of the boundary then adds nothing.
    """
    a, b, c, d = quads.T
    corners = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    corners = corners[(corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2])]
    top, place = height[corners], points[corners]
    gradient = np.linalg.lstsq(points - points[0], height - height[0], rcond=None)[0]
    apex = points[0] - height[0] * gradient / (gradient @ gradient)
    total = 0.0
    for t, p in zip(top, place - apex, strict=True):
        below = t < 0.0
        if not below.any():
            continue
        clipped = []
        for k in range(3):
            n = (k + 1) % 3
            if below[k]:
                clipped.append(p[k])
            if below[k] != below[n]:
                clipped.append(p[k] + t[k] / (t[k] - t[n]) * (p[n] - p[k]))
        for k in range(1, len(clipped) - 1):
            total += clipped[0] @ np.cross(clipped[k], clipped[k + 1]) / 6.0
    return total


def away_from_stood(level, z, height):
    """Signed distances (n,), m, from what stands `height`, m, tall on an outline that is `level` (n,) away."""
    high = np.abs(z) - 0.5 * height
    return np.hypot(np.maximum(level, 0.0), np.maximum(high, 0.0)) + np.minimum(np.maximum(level, high), 0.0)
