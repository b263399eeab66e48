"""The direction from one convex body to another: between the nearest points of their cores.

Cores are the bodies less a margin all round (`shapes.kernels.core`). Bodies that touch overlap by less than that, so
their cores are apart and have nearest points, whose direction is exactly the normal of a face where one touches with
its face, and turns smoothly over edges and corners. Nearest points by the algorithm of Gilbert, Johnson & Keerthi
(1988, doi 10.1109/56.2083) on the difference of the two cores; nearest points of a simplex after Ericson (2005,
Real-Time Collision Detection, sec. 5.1). `m`: table of bodies.
"""

import math

import numpy as np

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.shapes.kernels import core, stands_upright
from parsim.solid.table import shape_of, turn_at

_ROUNDS = 64  # boxes take 3 to 6, discs up to 20
_INNER = 1.0 - 1e-6  # of the way to its end, within which the nearest point of what stands upright is on its side
_CLOSE = 1e-10  # of the square of the distance, to which it is sought; round cores come nearer step by step


@kernel
def between_cores(m, forms, a, b, apart):
    """(unit vector (3,) from body b to body a, midpoint (3,) between the nearest points of their cores, from the
    centre of b), `apart` (3,) being the vector from centre to centre. Where cores overlap, along that. 1 to 2 us.
    """
    s, t = turn_at(m, a), turn_at(m, b)
    points, others, weight = np.empty((4, 3)), np.empty((4, 3)), np.zeros(4)
    x, y, z = apart
    if x == 0.0 and y == 0.0 and z == 0.0:
        x, y, z = 0.0, 0.0, 1.0
    count, least = 0, math.inf
    for _ in range(_ROUNDS):
        p, q = _far_point(forms, a, s, -x, -y, -z), _far_point(forms, b, t, x, y, z)
        u, v, w = p[0] + apart[0] - q[0], p[1] + apart[1] - q[1], p[2] + apart[2] - q[2]
        square = x * x + y * y + z * z
        if count > 0 and square - (x * u + y * v + z * w) <= _CLOSE * square:
            break
        points[count, 0], points[count, 1], points[count, 2] = u, v, w
        others[count, 0], others[count, 1], others[count, 2] = q
        count = _nearest(points, others, weight, count + 1)
        x = y = z = 0.0
        for k in range(count):
            x, y, z = x + weight[k] * points[k, 0], y + weight[k] * points[k, 1], z + weight[k] * points[k, 2]
        square = x * x + y * y + z * z
        if count == 4 or square >= least or square == 0.0:
            break
        least = square
    length, away = (
        math.sqrt(x * x + y * y + z * z),
        math.sqrt(apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]),
    )
    mx, my, mz = 0.5 * x, 0.5 * y, 0.5 * z
    for k in range(count):
        mx, my, mz = mx + weight[k] * others[k, 0], my + weight[k] * others[k, 1], mz + weight[k] * others[k, 2]
    if count == 4 or length <= 1e-9 * away:
        if away == 0.0:
            return (0.0, 0.0, 1.0), (mx, my, mz)
        return (apart[0] / away, apart[1] / away, apart[2] / away), (mx, my, mz)
    x, y, z = _beside_axis(m, forms, a, s, (mx - apart[0], my - apart[1], mz - apart[2]), (0.5 * x, 0.5 * y, 0.5 * z))
    x, y, z = _beside_axis(m, forms, b, t, (mx, my, mz), (-x, -y, -z))
    length = -math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length), (mx, my, mz)


@kernel
def _beside_axis(m, forms, b, t, middle, way):
    """The vector `way` (3,) from `middle`, from the centre of body `b`, to the nearest point of its core.

    Across its axis where that is no end of what stands upright: of tall bodies the nearest points are known to few
    digits.
    """
    if not stands_upright(shape_of(m, b)):
        return way
    x, y, z = t[2], t[5], t[8]
    half = forms.half[b, 2] - forms.margin[b]
    high = x * (middle[0] + way[0]) + y * (middle[1] + way[1]) + z * (middle[2] + way[2])
    if abs(high) > _INNER * half:
        return way
    along = x * way[0] + y * way[1] + z * way[2]
    return way[0] - along * x, way[1] - along * y, way[2] - along * z


@kernel
def _far_point(forms, b, t, x, y, z):
    """The point of the core of body `b`, turned by `t`, that lies farthest along (x, y, z), from its centre."""
    p = core(forms, b, to_body(t, x, y, z))
    return to_global(t, p[0], p[1], p[2])


@kernel
def _nearest(points, others, weight, count):
    """Reduce a simplex of `count` points (4, 3), and what goes with them, to the part nearest to the origin.

    Returns how many points that has and sets their weights; four where the origin is inside.
    """
    if count == 1:
        weight[0] = 1.0
        return 1
    best, kept = np.zeros(4), np.zeros(4)
    least = math.inf
    if count == 2:
        _on_edge(points, 0, 1, best)
    elif count == 3:
        _on_face(points, 0, 1, 2, best)
    else:
        inside = True
        for k in range(4):
            i, j, other = (k + 1) % 4, (k + 2) % 4, (k + 3) % 4
            if _same_side(points, i, j, other, k):
                continue
            inside = False
            kept[:] = 0.0
            square = _on_face(points, i, j, other, kept)
            if square < least:
                least = square
                best[:] = kept
        if inside:
            weight[:] = 0.25
            return 4
    left = 0
    for k in range(count):
        if best[k] > 0.0:
            weight[left] = best[k]
            for c in range(3):
                points[left, c], others[left, c] = points[k, c], others[k, c]
            left += 1
    return left


@kernel
def _dot(points, i, j):
    return points[i, 0] * points[j, 0] + points[i, 1] * points[j, 1] + points[i, 2] * points[j, 2]


@kernel
def _square_of(points, weight):
    x = y = z = 0.0
    for k in range(4):
        if weight[k] > 0.0:
            x, y, z = x + weight[k] * points[k, 0], y + weight[k] * points[k, 1], z + weight[k] * points[k, 2]
    return x * x + y * y + z * z


@kernel
def _on_edge(points, i, j, weight):
    """Weights of the point of an edge that is nearest to the origin; the square of its distance."""
    ii, ij, jj = _dot(points, i, i), _dot(points, i, j), _dot(points, j, j)
    length = ii - 2.0 * ij + jj
    share = min(max((ii - ij) / length, 0.0), 1.0) if length > 0.0 else 0.0
    weight[i], weight[j] = 1.0 - share, share
    return _square_of(points, weight)


@kernel
def _on_face(points, i, j, k, weight):
    """The same of a triangle."""
    ii, jj, kk = _dot(points, i, i), _dot(points, j, j), _dot(points, k, k)
    ij, ik, jk = _dot(points, i, j), _dot(points, i, k), _dot(points, j, k)
    a, b, c, d = ij - ii, ik - ii, jj - ij, jk - ij  # of the edges i-j and i-k with i and j
    e, f = jk - ik, kk - ik  # and with k
    inner_k, inner_j, inner_i = a * d - c * b, e * b - a * f, c * f - e * d
    if inner_i > 0.0 and inner_j > 0.0 and inner_k > 0.0:
        whole = inner_i + inner_j + inner_k
        weight[i], weight[j], weight[k] = inner_i / whole, inner_j / whole, inner_k / whole
        return _square_of(points, weight)
    least, best = math.inf, (0.0, 0.0, 0.0)
    for edge in range(3):
        weight[i] = weight[j] = weight[k] = 0.0
        p, q = (i, j) if edge == 0 else ((i, k) if edge == 1 else (j, k))
        square = _on_edge(points, p, q, weight)
        if square < least:
            least, best = square, (weight[i], weight[j], weight[k])
    weight[i], weight[j], weight[k] = best
    return least


@kernel
def _same_side(points, i, j, k, other):
    """Whether the origin lies on the side of the plane of three points on which the fourth is; not where it is flat."""
    ax, ay, az = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]
    bx, by, bz = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1], points[k, 2] - points[i, 2]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    cx, cy, cz = points[other, 0] - points[i, 0], points[other, 1] - points[i, 1], points[other, 2] - points[i, 2]
    origin = -(nx * points[i, 0] + ny * points[i, 1] + nz * points[i, 2])
    fourth = nx * cx + ny * cy + nz * cz
    return origin * fourth > 0.0
