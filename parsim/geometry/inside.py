"""Whether a point is inside a body, and how it would come out."""

import numpy as np

from parsim.machine.jit import kernel


@kernel
def nearest_face(point, b, position, turn, half, axes):
    """(depth, m, axis, side) of the nearest face of box `b` as seen from a point (3,); depth <= 0 outside.

    position, half (b, 3), m; turn (b, 3, 3); `axes`: those along which the boxes have faces.
    """
    dx, dy, dz = point[0] - position[b, 0], point[1] - position[b, 1], point[2] - position[b, 2]
    depth, axis, sign = np.inf, 0, 1.0
    for a in axes:
        along = turn[b, 0, a] * dx + turn[b, 1, a] * dy + turn[b, 2, a] * dz
        if half[b, a] - abs(along) < depth:
            depth, axis, sign = half[b, a] - abs(along), a, 1.0 if along > 0.0 else -1.0
    return depth, axis, sign
