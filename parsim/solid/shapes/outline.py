"""Outlines of what is drawn in a plane: closed, convex, sampled in rings from the outside in.

A ring is a strip along the outline, of even width; its points lie on the middle line, each with its share of the strip.
"""

import math
from typing import NamedTuple

import numpy as np


class Ring(NamedTuple):
    """Points (n, 2), m, of one ring, the area of each (n,), m2; of the strip's outer line, next to each point: place
    (n, 2), m, normal (n, 2), outwards, and length (n,), m."""

    points: np.ndarray
    area: np.ndarray
    place: np.ndarray
    normal: np.ndarray
    length: np.ndarray


def disc_rings(radius, spacing):
    """Rings of a disc about its centre, from the outside in; the points of each are a spacing apart and even."""
    number = max(round(radius / spacing), 1)
    width = radius / number
    for ring in range(number):
        outer, middle = radius - ring * width, radius - (ring + 0.5) * width
        count = max(round(2.0 * math.pi * middle / spacing), 3)
        count += count % 2  # so that they pull nowhere
        angle = 2.0 * math.pi * (np.arange(count) + 0.5 * (ring % 2)) / count
        normal = np.stack([np.cos(angle), np.sin(angle)], -1)
        even = np.ones(count)
        area = math.pi * (outer**2 - (outer - width) ** 2) / count
        yield Ring(middle * normal, area * even, outer * normal, normal, 2.0 * math.pi * outer / count * even)


def polygon_rings(corners, spacing):
    """Rings of a convex polygon with `corners` (k, 2), anticlockwise, from the outside in."""
    deepest = most_inset(corners)
    number = max(round(deepest / spacing), 1)
    width = deepest / number
    for ring in range(number):
        lines, parts = [inset(corners, (ring + share) * width) for share in (0.0, 0.5, 1.0)], []
        for side, (normal, _) in enumerate(sides_of(corners)):
            ends = [line[side] for line in lines]
            lengths = [np.linalg.norm(q - p) for p, q in ends]
            if lengths[0] <= 1e-9 * deepest:
                continue
            count = max(round(lengths[1] / spacing), 1)
            at = (np.arange(count) + 0.5)[:, None] / count
            place, points = (p + at * (q - p) for p, q in ends[:2])
            if lengths[1] <= 1e-9 * deepest:  # a corner, cut off by a side that ends within the strip
                points = place - 0.1 * width * normal
            strip, even = lengths[0] + 4.0 * lengths[1] + lengths[2], np.ones(count)
            parts.append((points, strip / count * even, place, normal * even[:, None], lengths[0] / count * even))
        made = Ring(*map(np.concatenate, zip(*parts, strict=True)))
        yield made._replace(area=made.area * (_area(lines[0]) - _area(lines[2])) / made.area.sum())


def _area(ends):
    """Area, m2, of what `inset` has left."""
    x, y = np.array([p for p, q in ends if (p != q).any()]).reshape(-1, 2).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def sides_of(corners):
    """(outward normal (2,), its distance from the origin, m) of each side of a polygon, anticlockwise."""
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = (q - p) / np.linalg.norm(q - p)
        normal = np.array([along[1], -along[0]])
        yield normal, float(normal @ p)


def inset(corners, by):
    """Both ends ((2,), (2,)), m, of each side of a convex polygon moved inwards by `by`, m; equal if none is left."""
    lines, ends = [(normal, offset - by) for normal, offset in sides_of(corners)], []
    for normal, offset in lines:
        along, start, low, high = np.array([-normal[1], normal[0]]), offset * normal, -math.inf, math.inf
        for other, limit in lines:
            slope, room = other @ along, limit - other @ start
            if slope > 1e-12:
                high = min(high, room / slope)
            elif slope < -1e-12:
                low = max(low, room / slope)
            elif room < -1e-12 * abs(limit):
                high = -math.inf
        ends.append((start + low * along, start + high * along) if low < high else (start, start))
    return ends


def most_inset(corners):
    """By how much, m, the sides of a convex polygon can move inwards before none is left: its inradius."""
    normals, offsets = map(np.array, zip(*sides_of(corners), strict=True))
    along = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    slope, across = normals @ along.T, normals @ normals.T  # of each side (row) along and across each other
    ahead, behind = slope > 1e-12, slope < -1e-12
    steep = np.where(ahead | behind, slope, 1.0)
    low, high = 0.0, float(np.ptp(corners, axis=0).max())
    for _ in range(60):
        by = 0.5 * (low + high)
        limit = offsets - by
        room = limit[:, None] - limit * across
        last = np.where(ahead, room / steep, np.inf).min(axis=0)
        first = np.where(behind, room / steep, -np.inf).max(axis=0)
        shut = (~(ahead | behind) & (room < -1e-12 * np.abs(limit)[:, None])).any(axis=0)
        low, high = (by, high) if ((first < last) & ~shut).any() else (low, by)
    return low
