"""From particles to the nodes of a lattice and back, by multilinear shares: sums are of whole numbers, in any order."""

from typing import NamedTuple

import numpy as np

from parsim.machine.jit import each, inlined, kernel, prange

LARGEST = 2.0**54  # of what is gathered from one particle


class Frame(NamedTuple):
    """Of each axis (3,): coordinate of a node, m; 1 / pitch, 1/m; first node of the box and how many; 1 for a ring."""

    low: np.ndarray
    inverse: np.ndarray
    first: np.ndarray
    count: np.ndarray
    ring: np.ndarray


class Places(NamedTuple):
    """Where particles lie among the nodes: planes (n, 2), rows in a plane (n, 2) and nodes of a row (n, 2) beside each,
    by numbers int32 that add up to that of a node; share (n, 3): how far along each axis on the way to the second.

    sides: 2 with a y-axis, 1 without.
    """

    plane: np.ndarray
    row: np.ndarray
    node: np.ndarray
    share: np.ndarray
    sides: int


@kernel
def find(at, place, frame, places):
    """Write to `places` those of the particles `at`."""
    x, y, z = place
    _, ny, nz = frame.count
    plane, line, node, share = places.plane, places.row, places.node, places.share
    for row in range(at.size):
        n = at[row]
        a, b, share[row, 0] = between(x[n], 0, frame)
        plane[row, 0], plane[row, 1] = a * ny * nz, b * ny * nz
        a, b, share[row, 1] = between(y[n], 1, frame)
        line[row, 0], line[row, 1] = a * nz, b * nz
        node[row, 0], node[row, 1], share[row, 2] = between(z[n], 2, frame)


@inlined
def between(x, axis, frame):
    """The two nodes of an axis that x, m, lies between, and how far on the way to the second."""
    t = (x - frame.low[axis]) * frame.inverse[axis]
    floor = np.floor(t)
    count = frame.count[axis]
    a = np.int64(floor) - frame.first[axis]
    if frame.ring[axis] == 1:
        a %= count
        b = a + 1 if a + 1 < count else 0
    else:
        a = min(max(a, 0), count - 1)
        b = min(a + 1, count - 1)
    return a, b, t - floor


@kernel
def lay(places, terms, stiff, parts, sums):
    """Add to `sums` (4, nodes), whole numbers, what the particles at `places` give to edges along x, y, z and to nodes.

    terms: sum of the weights of the water (n,), of which `stiff` (3,) goes to edges; what holds it to zero (n,).
    parts (4,): 1 / unit.
    """
    plane, line, node, share, sides = places
    water, held = terms
    for row in range(water.size):
        fx, fy, fz = share[row, 0], share[row, 1], share[row, 2]
        ex, ey = water[row] * stiff[0] * parts[0], water[row] * stiff[1] * parts[1]
        ez, own = water[row] * stiff[2] * parts[2], held[row] * parts[3]
        (x0, x1), (y0, y1), (z0, z1) = plane[row], line[row], node[row]
        for i in range(2):
            wx, cx = (fx, x1) if i else (1.0 - fx, x0)
            wi, ci = (fy, y1) if i else (1.0 - fy, y0)
            for j in range(2):
                wy, cy = (fy, y1) if j else (1.0 - fy, y0)
                wj, cj = (fz, z1) if j else (1.0 - fz, z0)
                if i < sides and x0 != x1:
                    sums[0, x0 + ci + cj] += np.int64(np.rint(ex * wi * wj))
                if y0 != y1:
                    sums[1, cx + y0 + cj] += np.int64(np.rint(ey * wx * wj))
                if j < sides and z0 != z1:
                    sums[2, cx + cy + z0] += np.int64(np.rint(ez * wx * wy))
                if j < sides:
                    sums[3, cx + cy + z0] += np.int64(np.rint(own * wx * wy * (1.0 - fz)))
                    sums[3, cx + cy + z1] += np.int64(np.rint(own * wx * wy * fz))


@kernel
def gather(places, values, parts, sums):
    """Add to `sums` (nodes,), whole numbers, the shares of the `values` (n,) times `parts`: False if one is too large.

    Or if it is no number.
    """
    plane, line, node, share, sides = places
    good = True
    for row in range(values.size):
        v = values[row] * parts
        if not abs(v) < LARGEST:
            good = False
            continue
        fx, fy, fz = share[row, 0], share[row, 1], share[row, 2]
        for i in range(2):
            vx = v * (fx if i else 1.0 - fx)
            for j in range(sides):
                vy = vx * (fy if j else 1.0 - fy)
                c = plane[row, i] + line[row, j]
                sums[c + node[row, 0]] += np.int64(np.rint(vy * (1.0 - fz)))
                sums[c + node[row, 1]] += np.int64(np.rint(vy * fz))
    return good


@each
def spread(places, nodes, out):
    """Add to `out` (n,) the multilinear mean of the values of `nodes` at `places`."""
    plane, line, node, share, sides = places.plane, places.row, places.node, places.share, places.sides
    for row in prange(out.size):
        fx, fy, fz = share[row, 0], share[row, 1], share[row, 2]
        s = 0.0
        for i in range(2):
            wx = fx if i else 1.0 - fx
            for j in range(sides):
                w = wx * (fy if j else 1.0 - fy)
                c = plane[row, i] + line[row, j]
                s += w * ((1.0 - fz) * nodes[c + node[row, 0]] + fz * nodes[c + node[row, 1]])
        out[row] += s
