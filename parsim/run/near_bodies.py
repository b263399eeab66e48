"""What is solid beside given points: how near the next body is, and whether bodies take the place."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.geometry.faces import walled_sides
from parsim.geometry.nearby import near_points
from parsim.geometry.rotation import matrices, to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.shapes.forms import Forms
from parsim.solid.shapes.kernels import distance

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.solid import bodies as solid

_OPPOSITE = -0.9  # cosine below which two outward directions face each other across a gap
_MARGIN = 2.0  # spacings beyond a body within which its points are looked for
_MOST = 16  # bodies that are close to one point


class Bodies(NamedTuple):
    """Position, turn by rows (b, 9) and forms of the bodies."""

    position: np.ndarray
    turn: np.ndarray
    forms: Forms


class Beside:
    """The bodies near points (n, 3), m, which may then be moved by up to half a spacing along each axis."""

    def __init__(self, points: np.ndarray, case: Case, bodies: solid.Bodies) -> None:
        used = np.isin(range(3), case.axes)
        turn = matrices(bodies.quaternion).reshape(-1, 9)
        self._bodies = Bodies(bodies.position, turn, bodies.forms)
        self._planes, self._spacing = _planes(case), case.spacing
        reach = bodies.radius + _MARGIN * case.spacing
        self._first, self._near = near_points(points, bodies.position, reach, used)

    def look(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance to the nearest body (n,), m, inf where none is near, and whether a point is in a body or in a gap
        narrower than the spacing (n,)."""
        nearest, taken = np.empty(len(points)), np.empty(len(points), bool)
        look(points, (self._first, self._near), self._bodies, self._planes, self._spacing, nearest, taken)
        return nearest, taken


def _planes(case):
    """Walls and the faces of the gate, (n, 4): axis, sign of the normal, level, m, 1 where only the front counts."""
    planes = [(axis, -sign, level, 0.0) for axis, sign, level in walled_sides(case)]
    if case.gate is not None:
        planes += [(0, -1.0, case.gate.min_x, 1.0), (0, 1.0, case.gate.max_x, 1.0)]
    return np.array(planes, float).reshape(-1, 4)


@kernel
def away(p, b, bodies):
    """Signed distance of p (3,) from body `b`, m, and the outward direction (3,)."""
    c, t = bodies.position[b], bodies.turn[b]
    high, out = distance(bodies.forms, b, to_body(t, p[0] - c[0], p[1] - c[1], p[2] - c[2]))
    return high, to_global(t, out[0], out[1], out[2])


@kernel
def look(points, near, bodies, planes, spacing, nearest, taken):
    """See `Beside.look`; near: see `near_points`."""
    first, others = near
    far, ways = np.empty(_MOST), np.empty((_MOST, 3))
    for k in range(len(points)):
        p, count = (points[k, 0], points[k, 1], points[k, 2]), 0
        nearest[k] = np.inf
        for t in range(first[k], first[k + 1]):
            distance, way = away(p, others[t], bodies)
            nearest[k] = min(nearest[k], distance)
            if distance < spacing and count < _MOST:
                far[count], ways[count, 0], ways[count, 1], ways[count, 2] = distance, way[0], way[1], way[2]
                count += 1
        taken[k] = nearest[k] <= 0.0
        for i in range(0 if taken[k] else count):
            for j in range(i + 1, count):
                cosine = ways[i, 0] * ways[j, 0] + ways[i, 1] * ways[j, 1] + ways[i, 2] * ways[j, 2]
                taken[k] = taken[k] or (far[i] + far[j] < spacing and cosine < _OPPOSITE)
            for w in range(len(planes)):
                axis, sign = int(planes[w, 0]), planes[w, 1]
                distance = sign * (p[axis] - planes[w, 2])
                if (planes[w, 3] == 0.0 or distance >= 0.0) and far[i] + distance < spacing:
                    taken[k] = taken[k] or sign * ways[i, axis] < _OPPOSITE
