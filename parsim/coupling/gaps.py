"""How far what a body looks at is away."""

from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import to_body
from parsim.machine.jit import kernel
from parsim.solid.shapes.forms import Forms
from parsim.solid.shapes.kernels import ahead

FAR = 2.5  # spacings beyond which a gap holds water as any other room


class Bodies(NamedTuple):
    """Centre (b, 3), turn (b, 9), forms, radius (b,), m; others[first[b]:first[b + 1]] are near b; period (3,), m."""

    centre: np.ndarray
    turn: np.ndarray
    forms: Forms
    radius: np.ndarray
    first: np.ndarray
    others: np.ndarray
    period: np.ndarray


@kernel
def gap_to_plane(x, n, plane):
    """Distance along the direction n (3,) from x (3,) to a wall in front of it; inf where it faces away or ends."""
    along = -(n[0] * plane[0] + n[1] * plane[1] + n[2] * plane[2])
    if along <= 0.5:
        return np.inf
    gap = (x[0] * plane[0] + x[1] * plane[1] + x[2] * plane[2] - plane[3]) / along
    for k in range(3):
        if not plane[4 + k] <= x[k] + (gap * n[k] if plane[k] == 0.0 else 0.0) <= plane[7 + k]:
            return np.inf
    return gap


@kernel
def gap_ahead(x, n, b, solids, spacing):
    """Distance from x (3,) on body `b` along n (3,) to the nearest wall, gate or other body; inf where there is none.

    Of other bodies those within FAR spacings.

    `solids`: Bodies, the walls' planes, and the gate (4,): its low and high x, the height of its lower edge, and 1
    where there is one.
    """
    bodies, planes, gate = solids
    centre, turn, forms, radius, first, others, period = bodies
    gap = np.inf
    for w in range(len(planes)):
        gap = min(gap, gap_to_plane(x, n, planes[w]))
    if gate[3] > 0.0 and x[2] >= gate[2]:
        level, side = (gate[0], 1.0) if centre[b, 0] < 0.5 * (gate[0] + gate[1]) else (gate[1], -1.0)
        if n[0] * side > 0.5:
            gap = min(gap, (level - x[0]) * side / (n[0] * side))
    for d in others[first[b] : first[b + 1]]:
        dx, dy = x[0] - centre[d, 0], x[1] - centre[d, 1]
        if period[0] < np.inf:
            dx -= period[0] * np.rint(dx / period[0])
        if period[1] < np.inf:
            dy -= period[1] * np.rint(dy / period[1])
        dz, reach = x[2] - centre[d, 2], radius[d] + FAR * spacing
        if dx * dx + dy * dy + dz * dz > reach * reach:
            continue
        place = to_body(turn[d], dx, dy, dz)
        along = to_body(turn[d], n[0], n[1], n[2])
        gap = min(gap, ahead(forms, d, place, along, spacing))
    return gap
