"""Signed distance of a closed surface of triangles on a grid, negative inside, and what lies between its nodes.

Exact beside the surface; farther off each node takes the nearest triangle of its neighbours, in sweeps (Zhao 2004,
doi 10.1090/S0025-5718-04-01678-3). Inside is where a line along x has crossed the surface an odd number of times.
"""

import math
from typing import NamedTuple

import numpy as np

from parsim.machine.jit import kernel

_BAND = 2  # nodes around each triangle that are exact
_SWEEPS = 2  # of all eight directions
_ROUNDS = 100  # steps along a line to the surface


class Field(NamedTuple):
    """value (nx, ny, nz), m, at the nodes start + step * (i, j, k); start (3,), step, m."""

    value: np.ndarray
    start: np.ndarray
    step: float


def field_of(points, triangles, step):
    """`Field` of a closed surface, points (k, 3), m, triangles (n, 3), with its nodes `step`, m, apart."""
    low, high = points.min(axis=0), points.max(axis=0)
    start = low - (_BAND + 0.5) * step
    count = np.ceil((high - start) / step).astype(int) + _BAND + 2
    value, nearest = np.full(tuple(count), np.inf), np.full(tuple(count), -1)
    crossings = np.zeros(tuple(count), np.int64)
    _mark(points, triangles, start, step, value, nearest, crossings)
    for _ in range(_SWEEPS):
        for way in range(8):
            _sweep(points, triangles, start, step, value, nearest, (way & 1, way >> 1 & 1, way >> 2 & 1))
    inside = np.cumsum(crossings, axis=0) % 2 == 1
    return Field(np.where(inside, -value, value), start, step)


@kernel
def _mark(points, triangles, start, step, value, nearest, crossings):
    """Exact distances around each triangle, and where lines along x cross it."""
    n = value.shape
    for t in range(len(triangles)):
        a, b, c = points[triangles[t, 0]], points[triangles[t, 1]], points[triangles[t, 2]]
        low, high = np.empty(3, np.int64), np.empty(3, np.int64)
        for k in range(3):
            least, most = min(a[k], b[k], c[k]), max(a[k], b[k], c[k])
            low[k] = max(math.floor((least - start[k]) / step) - _BAND, 0)
            high[k] = min(math.ceil((most - start[k]) / step) + _BAND, n[k] - 1)
        for i in range(low[0], high[0] + 1):
            for j in range(low[1], high[1] + 1):
                for k in range(low[2], high[2] + 1):
                    p = (start[0] + i * step, start[1] + j * step, start[2] + k * step)
                    far = _from_triangle(p, a, b, c)
                    if far < value[i, j, k]:
                        value[i, j, k], nearest[i, j, k] = far, t
        for j in range(low[1], high[1] + 1):
            for k in range(low[2], high[2] + 1):
                hit, x = _crossing(start[1] + j * step, start[2] + k * step, a, b, c)
                if hit:
                    i = math.ceil((x - start[0]) / step)
                    if 0 <= i < n[0]:
                        crossings[i, j, k] += 1


@kernel
def _sweep(points, triangles, start, step, value, nearest, way):
    """Let each node take the nearest triangle of those before it, along one diagonal of the grid."""
    n = value.shape
    for first in range(n[0]):
        i, di = (first, -1) if way[0] else (n[0] - 1 - first, 1)
        for second in range(n[1]):
            j, dj = (second, -1) if way[1] else (n[1] - 1 - second, 1)
            for third in range(n[2]):
                k, dk = (third, -1) if way[2] else (n[2] - 1 - third, 1)
                p = (start[0] + i * step, start[1] + j * step, start[2] + k * step)
                for q in range(1, 8):
                    u, v, w = i + di * (q & 1), j + dj * (q >> 1 & 1), k + dk * (q >> 2 & 1)
                    if not (0 <= u < n[0] and 0 <= v < n[1] and 0 <= w < n[2]):
                        continue
                    t = nearest[u, v, w]
                    if t < 0 or t == nearest[i, j, k]:
                        continue
                    corners = triangles[t]
                    far = _from_triangle(p, points[corners[0]], points[corners[1]], points[corners[2]])
                    if far < value[i, j, k]:
                        value[i, j, k], nearest[i, j, k] = far, t


@kernel
def _from_triangle(p, a, b, c):
    """Distance of a point from a triangle, m (Ericson 2005, Real-Time Collision Detection, sec. 5.1.5)."""
    abx, aby, abz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    acx, acy, acz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    x, y, z = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    d1, d2 = abx * x + aby * y + abz * z, acx * x + acy * y + acz * z
    bb, bc, cc = abx * abx + aby * aby + abz * abz, abx * acx + aby * acy + abz * acz, acx * acx + acy * acy + acz * acz
    d3, d4, d5, d6 = d1 - bb, d2 - bc, d1 - bc, d2 - cc
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if d1 <= 0.0 and d2 <= 0.0:
        s, t = 0.0, 0.0
    elif d3 >= 0.0 and d4 <= d3:
        s, t = 1.0, 0.0
    elif d6 >= 0.0 and d5 <= d6:
        s, t = 0.0, 1.0
    elif vc <= 0.0 <= d1 and d3 <= 0.0:
        s, t = d1 / (d1 - d3), 0.0
    elif vb <= 0.0 <= d2 and d6 <= 0.0:
        s, t = 0.0, d2 / (d2 - d6)
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        s = 1.0 - t
    else:
        s, t = vb / (va + vb + vc), vc / (va + vb + vc)
    x, y, z = x - s * abx - t * acx, y - s * aby - t * acy, z - s * abz - t * acz
    return math.sqrt(x * x + y * y + z * z)


@kernel
def _crossing(y, z, a, b, c):
    """(whether the line along x at (y, z) crosses a triangle, at which x).

    Points on edges belong to one side alone, by their order: a line through an edge crosses one of its two triangles.
    """
    s1, w1 = _side(y, z, b, c)
    s2, w2 = _side(y, z, c, a)
    s3, w3 = _side(y, z, a, b)
    if s1 == 0 or s1 != s2 or s2 != s3:
        return False, 0.0
    return True, (w1 * a[0] + w2 * b[0] + w3 * c[0]) / (w1 + w2 + w3)


@kernel
def _side(y, z, p, q):
    """(1 or -1, on which side of the edge from p to q a point of the y-z plane lies, 0: nowhere; twice the area).

    An edge and the same gone along the other way have sides that differ in their sign alone, rounding included.
    """
    if q[1] < p[1] or (q[1] == p[1] and q[2] < p[2]):
        sign, area = _side_of(y, z, q, p)
        return -sign, -area
    return _side_of(y, z, p, q)


@kernel
def _side_of(y, z, p, q):
    area = (q[1] - p[1]) * (z - p[2]) - (q[2] - p[2]) * (y - p[1])
    if area > 0.0:
        return 1, area
    if area < 0.0:
        return -1, area
    if q[2] > p[2]:
        return 1, area
    if q[2] < p[2]:
        return -1, area
    if q[1] < p[1]:
        return 1, area
    if q[1] > p[1]:
        return -1, area
    return 0, area


@kernel
def field_distance(p, values, grid):
    """(signed distance, m, direction in which it grows (3,)) at `p` (3,), m; `grid` (8,): see `shapes.meshed.flat`.

    Beyond its nodes from the nearest of its points on.
    """
    first, nx, ny, nz, step = int(grid[0]), int(grid[1]), int(grid[2]), int(grid[3]), grid[4]
    x, y, z = (p[0] - grid[5]) / step, (p[1] - grid[6]) / step, (p[2] - grid[7]) / step
    u, v, w = min(max(x, 0.0), nx - 1.000001), min(max(y, 0.0), ny - 1.000001), min(max(z, 0.0), nz - 1.000001)
    i, j, k = int(u), int(v), int(w)
    s, t, r = u - i, v - j, w - k
    at = first + (i * ny + j) * nz + k
    a, b, c, d = values[at], values[at + 1], values[at + nz], values[at + nz + 1]
    at += ny * nz
    e, f, g, h = values[at], values[at + 1], values[at + nz], values[at + nz + 1]
    # along z, then y, then x
    ab, cd, ef, gh = a + r * (b - a), c + r * (d - c), e + r * (f - e), g + r * (h - g)
    back, front = ab + t * (cd - ab), ef + t * (gh - ef)
    high = back + s * (front - back)
    gx = front - back
    gy = (1.0 - s) * (cd - ab) + s * (gh - ef)
    gz = (1.0 - s) * ((1.0 - t) * (b - a) + t * (d - c)) + s * ((1.0 - t) * (f - e) + t * (h - g))
    x, y, z = step * (x - u), step * (y - v), step * (z - w)
    beyond = math.sqrt(x * x + y * y + z * z)
    if beyond > 1e-5 * step:
        gx, gy, gz, high = x, y, z, high + beyond
    size = math.sqrt(gx * gx + gy * gy + gz * gz)
    if size == 0.0:
        return high, (0.0, 0.0, 1.0)
    return high, (gx / size, gy / size, gz / size)


@kernel
def field_ahead(p, n, values, grid, behind):
    """Distance along `n` from `p`, m, from `behind` it on, to where the field is zero; inf where missed."""
    along = -behind
    far = grid[4] * (grid[1] + grid[2] + grid[3]) + abs(p[0]) + abs(p[1]) + abs(p[2])
    for _ in range(_ROUNDS):
        high, _ = field_distance((p[0] + along * n[0], p[1] + along * n[1], p[2] + along * n[2]), values, grid)
        if high <= 1e-3 * grid[4]:
            return along
        along += high
        if along > far:
            return math.inf
    return math.inf


@kernel
def distances(points, values, grid):
    """Signed distances (n,), m, of points (n, 3), m."""
    out = np.empty(len(points))
    for k in range(len(points)):
        out[k] = field_distance((points[k, 0], points[k, 1], points[k, 2]), values, grid)[0]
    return out
