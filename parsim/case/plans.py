"""What bodies cover in plan, as convex polygons that hold all of it. Lengths in m."""

import math

import numpy as np

from parsim.ice.outlines import Outlines, outlines
from parsim.solid.shapes.meshed import Meshed

_WAYS = 24  # directions along which a body is felt, besides those of its faces
_STEPS = 10**7  # of a turn: directions as near as that are one


def plan_of(place, bottom, end=math.inf):
    """Outlines that hold all of a body in plan; of a mesh or a bed those of its faces that reach above `bottom`, m, and
    begin before `end` along x, m."""
    if isinstance(place.shape, Meshed):
        points, faces = place.shape.surface()
        corners = (points @ place.axes.T + place.centre)[faces]
        corners = corners[(corners[:, :, 2].max(axis=1) > bottom) & (corners[:, :, 0].min(axis=1) < end)]
        polygons = [_around(lambda way, own=own: float((own @ way).max())) for own in corners]
    else:
        polygons = [place.centre[:2] + _around(place.along, (place.axes @ place.shape.normals().T).T)]
    centres = [polygon.mean(axis=0) for polygon in polygons]
    there = outlines([p - c for p, c in zip(polygons, centres, strict=True)], [0.0] * len(polygons))
    cx, cy = np.array(centres).reshape(-1, 2).T
    return Outlines(there.x + cx[:, None], there.y + cy[:, None], cx, cy, there.radius, there.round)


def _around(reach, normals=()):
    """Corners (k, 2) of the polygon by lines across some directions, as far as `reach` says, m, from the origin."""
    flat = [math.atan2(s * n[1], s * n[0]) for n in normals if math.hypot(n[0], n[1]) > 0.5 for s in (1.0, -1.0)]
    turns = [angle / (2.0 * math.pi) for angle in flat] + [k / _WAYS for k in range(_WAYS)]
    every = [2.0 * math.pi * step / _STEPS for step in sorted({round(turn * _STEPS) % _STEPS for turn in turns})]
    far = [reach(np.array([math.cos(a), math.sin(a), 0.0])) for a in every]
    corners = []
    for a, b, g, h in zip(every, every[1:] + every[:1], far, far[1:] + far[:1], strict=True):
        across = math.sin(b - a)
        corners.append(((g * math.sin(b) - h * math.sin(a)) / across, (h * math.cos(a) - g * math.cos(b)) / across))
    return np.array(corners)
