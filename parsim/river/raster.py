"""Closed surfaces cut by plumb lines through the middles of pixels: footprints and volumes of bodies follow from it.

The footprint of a body is the union of its faces as seen from above, each a convex polygon.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.machine.jit import kernel

if TYPE_CHECKING:
    from parsim.river.columns import Columns


class Cuts(NamedTuple):
    """Where plumb lines pass through surfaces, n rows: pixel (n,), numbered as columns are, x first; column (n,); body
    (n,); side (n,), 1 where a line leaves the body upward and -1 where it enters it; height (n,), m.

    So the sum of side times height over the rows of a line is the length of it that is in bodies.
    """

    pixel: np.ndarray
    column: np.ndarray
    body: np.ndarray
    side: np.ndarray
    height: np.ndarray


def cuts_of(points: np.ndarray, quads: np.ndarray, body: np.ndarray, columns: Columns) -> Cuts:
    """Cuts of closed surfaces: points (k, 3), m, quads (m, 4) of them, anticlockwise seen from outside, and the body
    (m,) of each. What is beyond a side that does not repeat is left out."""
    a, b, c, d = quads.T
    corners = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    count = np.array(columns.shape) * columns.pixels
    pitch = columns.step / columns.pixels
    plan = (*columns.low, *pitch, *count, *columns.wraps)
    triangles = np.ascontiguousarray(points[corners], float)
    found = np.empty((cut(triangles, plan, np.empty((0, 4))), 4))
    cut(triangles, plan, found)
    i, j, triangle = found[:, :3].astype(np.int64).T
    up = _twice_the_area(triangles)[triangle] > 0.0
    column = (i // columns.pixels[0]) * columns.shape[1] + j // columns.pixels[1]
    owner = np.concatenate([body, body])[triangle]
    return Cuts(i * int(count[1]) + j, column, owner, np.where(up, 1.0, -1.0), found[:, 3])


def _twice_the_area(triangles):
    """Twice the area (n,), m2, of triangles (n, 3, 3) on the plan, positive where they look up."""
    p, q, r = (triangles[:, k, :2] for k in range(3))
    return (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0])


@kernel
def left_of(p, q, x, y):
    """Whether a point is on the left of the edge from p to q (3,), which two triangles share with p and q swapped.

    On one of the two sides of an edge, whatever the rounding, and never on both.
    """
    swapped = p[0] > q[0] or (p[0] == q[0] and p[1] > q[1])
    s, e = (q, p) if swapped else (p, q)
    left = (e[0] - s[0]) * (y - s[1]) - (e[1] - s[1]) * (x - s[0]) >= 0.0
    return left != swapped


@kernel
def cut(triangles, plan, out):
    """Number of cuts of triangles (n, 3, 3), m; rows of out: pixel along x, along y, triangle, height, m.

    `plan`: corner and pitch along x and y, m, numbers of pixels, whether it repeats.
    Rows beyond `out` are counted only.
    """
    x0, y0, dx, dy, nx, ny, wraps_x, wraps_y = plan
    count = 0
    for t in range(len(triangles)):
        p, q, r = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        if area == 0.0:
            continue
        if area < 0.0:
            q, r = r, q
        lowest, highest = min(p[2], q[2], r[2]), max(p[2], q[2], r[2])
        first_i = int(np.ceil((min(p[0], q[0], r[0]) - x0) / dx - 0.5))
        last_i = int(np.floor((max(p[0], q[0], r[0]) - x0) / dx - 0.5))
        first_j = int(np.ceil((min(p[1], q[1], r[1]) - y0) / dy - 0.5))
        last_j = int(np.floor((max(p[1], q[1], r[1]) - y0) / dy - 0.5))
        for i in range(first_i, last_i + 1):
            for j in range(first_j, last_j + 1):
                if not ((wraps_x or 0 <= i < nx) and (wraps_y or 0 <= j < ny)):
                    continue
                x, y = x0 + (i + 0.5) * dx, y0 + (j + 0.5) * dy
                if left_of(p, q, x, y) and left_of(q, r, x, y) and left_of(r, p, x, y):
                    if count < len(out):
                        along = ((x - p[0]) * (r[1] - p[1]) - (y - p[1]) * (r[0] - p[0])) / abs(area)
                        across = ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) / abs(area)
                        z = p[2] + along * (q[2] - p[2]) + across * (r[2] - p[2])
                        out[count, 0], out[count, 1], out[count, 2] = i % nx, j % ny, t
                        out[count, 3] = min(max(z, lowest), highest)
                    count += 1
    return count
