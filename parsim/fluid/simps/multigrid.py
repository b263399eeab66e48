"""Multigrid on a box of nodes joined along its axes: one cycle, the same linear, symmetric, positive map at any time.

Every second node of an axis goes on to the next level (Briggs, Henson & McCormick 2000, ch. 3), the last one always,
until one node is left. Edges get what linear fields between these nodes have of energy; what that gives to an edge
across goes to the two beside it, which never takes energy away. Damped Jacobi before and after keeps the cycle
symmetric and, edges and what holds nodes never being negative, positive. Every rank does all of it, in one order.
"""

from typing import NamedTuple

import numpy as np

from parsim.machine.jit import inlined, kernel

_DAMPING = 0.8  # of Jacobi: at most 1, for the largest eigenvalue that it sees is 2 at most


class Levels(NamedTuple):
    """Of each level: shape (levels, 3) and first node (levels + 1,); of each level but the last and each axis, from
    begin (levels - 1, 3) on, low and high: the two next nodes of the level below, twice the same where there is one."""

    shape: np.ndarray
    first: np.ndarray
    begin: np.ndarray
    low: np.ndarray
    high: np.ndarray


class Multigrid:
    """For a box of `shape` (3,) nodes; ring (3,): whether an axis closes to one.

    edges (3, n): of each node to the next one along each axis, zero where there is none; held (n,): to what is zero.
    Both are to be set, those of the first level, before `prepare`. n: of all levels; `size`: of the first.
    """

    def __init__(self, shape, ring):
        self.levels = _levels(shape, ring)
        self.size, count = (int(self.levels.first[at]) for at in (1, -1))
        self.edges, self.held = np.zeros((3, count)), np.zeros(count)
        self._diagonal, self._inverse = np.zeros(count), np.zeros(count)
        self._work = tuple(np.zeros((3, count)))

    def prepare(self):
        """Make the coarser levels."""
        self.edges[:, self.size :], self.held[self.size :] = 0.0, 0.0
        coarsen(self.levels, self.edges, self.held, self._diagonal, self._inverse)

    def solve(self, right):
        """About the values (size,), void at the next call, whose image is `right` (size,), and their product."""
        product = cycle(self.levels, self.edges, (self._diagonal, self._inverse), self._work, right)
        return self._work[0][: self.size], product


def _levels(shape, ring):
    shapes, parents = [np.array(shape, np.int64)], []
    while shapes[-1].max() > 1:
        shapes.append(np.array([_fewer(n, r) for n, r in zip(shapes[-1], ring, strict=True)], np.int64))
        parents += [_parents(*each) for each in zip(*shapes[-2:], ring, strict=True)]
    first = np.cumsum([0] + [int(shape.prod()) for shape in shapes])
    begin = np.cumsum([0] + [low.size for low, _ in parents])[:-1].reshape(-1, 3)
    low, high = (np.concatenate([pair[side] for pair in parents] or [np.zeros(0, np.int64)]) for side in (0, 1))
    return Levels(np.array(shapes), first, begin, low, high)


def _fewer(count, ring):
    if count < (4 if ring else 3):
        return 1
    return (count + 1) // 2 if ring else count // 2 + 1


def _parents(count, fewer, ring):
    at = np.arange(count)
    low = at // 2
    high = low + at % 2
    if not ring:
        low[-1] = high[-1] = fewer - 1
    return low % fewer, high % fewer


@kernel
def coarsen(levels, edges, held, diagonal, inverse):
    """Edges and `held` of all levels from those of the first, with the diagonals (n,) and their inverses, or zero."""
    shape, first, begin, low, high = levels
    x, y, z = edges
    for level in range(len(shape)):
        nx, ny, nz = shape[level]
        more = level + 1 < len(shape)
        if more:
            mx, my, mz = shape[level + 1]
            bx, by, bz = begin[level]
        for i in range(nx):
            for j in range(ny):
                for k in range(nz):
                    n = first[level] + (i * ny + j) * nz + k
                    down = first[level] + (before(i, nx) * ny + j) * nz + k
                    s = held[n] + x[n] + x[down]
                    down = first[level] + (i * ny + before(j, ny)) * nz + k
                    s += y[n] + y[down]
                    down = first[level] + (i * ny + j) * nz + before(k, nz)
                    diagonal[n] = s + z[n] + z[down]
                    inverse[n] = 1.0 / diagonal[n] if diagonal[n] > 0.0 else 0.0
                    if not more:
                        continue
                    li, hi, lj, hj = low[bx + i], high[bx + i], low[by + j], high[by + j]
                    lk, hk = low[bz + k], high[bz + k]
                    ex = x[n] if li == hi and low[bx + after(i, nx)] == high[bx + after(i, nx)] else 0.25 * x[n]
                    ey = y[n] if lj == hj and low[by + after(j, ny)] == high[by + after(j, ny)] else 0.25 * y[n]
                    ez = z[n] if lk == hk and low[bz + after(k, nz)] == high[bz + after(k, nz)] else 0.25 * z[n]
                    for a in range(2):
                        for b in range(2):
                            ci, cj, ck = (hi if a else li), (hj if a else lj), (hk if b else lk)
                            if mx > 1:
                                x[first[level + 1] + (li * my + cj) * mz + ck] += 0.25 * ex
                            if my > 1:
                                y[first[level + 1] + (ci * my + lj) * mz + ck] += 0.25 * ey
                            if mz > 1:
                                z[first[level + 1] + (ci * my + (hj if b else lj)) * mz + lk] += 0.25 * ez
                            for c in range(2):
                                cj = hj if c else lj
                                held[first[level + 1] + (ci * my + cj) * mz + ck] += 0.125 * held[n]


@kernel
def remainder(shape, first, edges, diagonal, values, right, out):
    """What the `values` of the level of this shape and first node leave of `right`: out."""
    x, y, z = edges
    nx, ny, nz = shape
    for i in range(nx):
        for j in range(ny):
            row = first + (i * ny + j) * nz
            east, west = first + (after(i, nx) * ny + j) * nz, first + (before(i, nx) * ny + j) * nz
            north, south = first + (i * ny + after(j, ny)) * nz, first + (i * ny + before(j, ny)) * nz
            for k in range(nz):
                n, up, down = row + k, row + after(k, nz), row + before(k, nz)
                s = diagonal[n] * values[n] - x[n] * values[east + k] - x[west + k] * values[west + k]
                s -= z[n] * values[up] + z[down] * values[down]
                if ny > 1:
                    s -= y[n] * values[north + k] + y[south + k] * values[south + k]
                out[n] = right[n] - s


@kernel
def cycle(levels, edges, matrix, work, right):
    """One cycle: values of the first level to work[0], their product with `right` (size,) returned.

    matrix: diagonals and their inverses; work: values, right and remainders of all levels.
    """
    shape, first, begin, low, high = levels
    diagonal, inverse = matrix
    values, rest, left = work
    last = len(shape) - 1
    rest[: right.size] = right
    rest[right.size :] = 0.0
    for level in range(last):
        for n in range(first[level], first[level + 1]):
            values[n] = _DAMPING * inverse[n] * rest[n]
        remainder(shape[level], first[level], edges, diagonal, values, rest, left)
        hand_down(level, levels, left, rest)
    n = first[last]
    values[n] = inverse[n] * rest[n]
    for level in range(last - 1, -1, -1):
        hand_up(level, levels, values)
        remainder(shape[level], first[level], edges, diagonal, values, rest, left)
        for n in range(first[level], first[level + 1]):
            values[n] += _DAMPING * inverse[n] * left[n]
    product = 0.0
    for n in range(right.size):
        product += values[n] * right[n]
    return product


@kernel
def hand_down(level, levels, source, out):
    """Add to each node of the next level what the nodes of this one have of it."""
    shape, first, begin, low, high = levels
    nx, ny, nz = shape[level]
    _, my, mz = shape[level + 1]
    bx, by, bz = begin[level]
    for i in range(nx):
        for j in range(ny):
            li, hi, lj, hj = low[bx + i], high[bx + i], low[by + j], high[by + j]
            row, start = first[level] + (i * ny + j) * nz, first[level + 1]
            r0, r1 = start + (li * my + lj) * mz, start + (hi * my + lj) * mz
            r2, r3 = start + (li * my + hj) * mz, start + (hi * my + hj) * mz
            for k in range(nz):
                f, lk, hk = 0.125 * source[row + k], low[bz + k], high[bz + k]
                out[r0 + lk] += f
                out[r1 + lk] += f
                out[r2 + lk] += f
                out[r3 + lk] += f
                out[r0 + hk] += f
                out[r1 + hk] += f
                out[r2 + hk] += f
                out[r3 + hk] += f


@kernel
def hand_up(level, levels, values):
    """Add to each node of this level the mean of those of the next level beside it."""
    shape, first, begin, low, high = levels
    nx, ny, nz = shape[level]
    _, my, mz = shape[level + 1]
    bx, by, bz = begin[level]
    for i in range(nx):
        for j in range(ny):
            li, hi, lj, hj = low[bx + i], high[bx + i], low[by + j], high[by + j]
            row, start = first[level] + (i * ny + j) * nz, first[level + 1]
            r0, r1 = start + (li * my + lj) * mz, start + (hi * my + lj) * mz
            r2, r3 = start + (li * my + hj) * mz, start + (hi * my + hj) * mz
            for k in range(nz):
                lk, hk = low[bz + k], high[bz + k]
                s = (values[r0 + lk] + values[r0 + hk]) + (values[r1 + lk] + values[r1 + hk])
                s += (values[r2 + lk] + values[r2 + hk]) + (values[r3 + lk] + values[r3 + hk])
                values[row + k] += 0.125 * s


@inlined
def after(index, count):
    """The next node along an axis; of the last one the first."""
    return index + 1 if index + 1 < count else 0


@inlined
def before(index, count):
    """The node before along an axis; of the first one the last."""
    return index - 1 if index > 0 else count - 1
