"""Neighbour lists from cell-sorted particles, fluid neighbours first, then boundary ones.

The candidates of a block of _TALL cells are found once and copied into small contiguous buffers, from which each of
its particles selects. Every selection is done in two passes, marks by SIMD and then a compaction without a branch: a
third faster than both in one. Blocks of one cell cost a fifth more, of three or four as much as of two.
"""

from typing import NamedTuple

import numpy as np

from parsim.machine.jit import kernel, prange, rows
from parsim.particles.cells import REACH
from parsim.particles.sight import cut_rows
from parsim.particles.state import BODY, FLUID, GATE_DOWN, GATE_UP, SURFACE
from parsim.particles.tables import Lists

_TALL = 2  # cells of a block, one above the other
_BLOCKS_PER_TASK = 32
_BOUNDARY = 0.6  # length of a row of a boundary particle, which holds fluid only, over that of a fluid one
_ROOM = 1.02
_BOUNDARY_PAIR = 3  # pairs of boundary particles that cost as much as one of water
_PARTICLE, _SURFACE, _SAMPLE = 50, 55, 120  # such pairs for any particle, more near the surface, more in a body


class Cells(NamedTuple):
    """Where the particles of each cell begin, first cells of the blocks, column and pieces of the stack, its shape."""

    first: np.ndarray
    blocks: np.ndarray
    column: np.ndarray
    pieces: np.ndarray
    shape: np.ndarray


class Neighbours:
    """Lists of one rank: row i holds index[start[i]:middle[i]] fluid and index[middle[i]:end[i]] boundary particles.

    `fluid` and `boundary` are the owned particles (int64 indices) that have neighbours to look at; `inner` and `border`
    are the `fluid` that cannot and that may see a halo; `body` and `gate` those of `boundary` that sample a rigid body
    or the gate. Rows of boundary particles hold fluid only. Rows are packed: `expected` is the length that they get
    room for on average.
    """

    def __init__(self, expected):
        self.expected = float(expected)
        self.start = self.middle = self.end = np.zeros(0, np.int64)
        self.index = np.zeros(0, np.uint32)
        self.fluid = self.inner = self.border = self.boundary = self.body = self.gate = np.zeros(0, np.int64)

    @property
    def lists(self):
        """The lists as kernels take them."""
        return Lists(self.start, self.middle, self.end, self.index)

    def build(self, domain, radius):
        """Fill the lists of the owned particles of a `domain` that has just been rebuilt, up to `radius` m."""
        p, first, stack = domain.particles, domain.first, domain.stack
        self.start, self.middle, self.end = (np.zeros(len(p), np.int64) for _ in range(3))
        shape = np.array([stack.pieces.size - 1, *domain.grid.count[1:]], np.int64)
        blocks = filled_blocks(first, shape, stack.own.start, stack.own.stop)
        room = largest_block(first, blocks, stack.column, stack.pieces, shape)
        rows = rows_of_tasks(p.kind, first, blocks, shape)
        while True:
            offsets = self._offsets(rows, room)
            if self.index.size < offsets[-1]:
                self.index = np.empty(int(offsets[-1] * _ROOM), np.uint32)
            full = np.zeros(len(rows), np.uint8)
            cells = Cells(first, blocks, stack.column, stack.pieces, shape)
            list_pairs(p.place, p.kind, p.image, cells, (room, radius * radius), offsets, self.lists, full)
            if not full.any():
                break
            self.expected *= 1.1
        self._sort_rows(p, domain.own, domain.border)

    def work(self, domain):
        """Cost of the owned particles of a `domain` in one step, in listed fluid pairs: int64 (owned,)."""
        p, owned = domain.particles, domain.own
        pairs, fluid = (self.end - self.start)[owned], p.kind[owned] == FLUID
        work = np.where(fluid, pairs, pairs // _BOUNDARY_PAIR) + _PARTICLE
        work += np.where(p.body[owned] >= 0, _SAMPLE, 0)
        return work + np.where(fluid & domain.near(SURFACE, "surface")[owned], _SURFACE, 0)

    def _offsets(self, rows, room):
        """Where the rows of each task begin, and the end of the last: (tasks + 1,) int64."""
        lengths = np.ceil(self.expected * (rows[:, 0] + _BOUNDARY * rows[:, 1])).astype(np.int64) + room
        return np.concatenate([[0], np.cumsum(lengths)])

    def _sort_rows(self, p, owned, border):
        real = np.arange(owned.start, owned.stop)[p.image[owned] == 0]
        self.fluid = real[p.kind[real] == FLUID]
        edge = border[self.fluid - owned.start]
        self.inner, self.border = self.fluid[~edge], self.fluid[edge]
        self.boundary = real[(p.kind[real] != FLUID) & (self.end[real] > self.start[real])]
        self._sort_boundary(p)

    def _sort_boundary(self, p):
        kind = p.kind[self.boundary]
        self.body = self.boundary[kind == BODY]
        self.gate = self.boundary[(kind == GATE_UP) | (kind == GATE_DOWN)]

    def cut_by_gate(self, particles, radius, gate, time):
        """Take out the pairs that the gate hides from each other at `time`, s."""
        p, barrier = particles, gate.barrier(time)
        if barrier > p.z[p.kind == FLUID].max(initial=-np.inf) + radius:  # of the halo too: walls look into it
            return
        near = np.sort(np.concatenate([self.fluid, self.boundary]))
        # each side's samples reach up to a support, less than `radius`, beyond the other face
        near = near[(p.x[near] > gate.min_x - 2.5 * radius) & (p.x[near] < gate.max_x + 2.5 * radius)]
        cut_rows(near, p.place, p.kind, (gate.min_x, gate.max_x, barrier), self.lists)
        self.boundary = self.boundary[self.end[self.boundary] > self.start[self.boundary]]
        self._sort_boundary(p)


@kernel
def filled_blocks(first, shape, begin, end):
    """First cells of the blocks of pieces `begin` to `end` that hold a particle; a block is _TALL cells in z."""
    out = np.empty((end - begin) * shape[1] * (shape[2] // _TALL + 1), np.int64)
    count = 0
    for row in range(begin * shape[1], end * shape[1]):
        for cz in range(0, shape[2], _TALL):
            c = row * shape[2] + cz
            if first[row * shape[2] + min(cz + _TALL, shape[2])] > first[c]:
                out[count] = c
                count += 1
    return out[:count]


@kernel
def largest_block(first, blocks, column, pieces, shape):
    """Largest number of particles within REACH cells of any of `blocks`."""
    largest = 0
    for c in blocks:
        cz = c % shape[2]
        cy = (c // shape[2]) % shape[1]
        cx = column[c // (shape[1] * shape[2])]
        z0, z1 = max(cz - REACH, 0), min(cz + _TALL + REACH, shape[2])
        count = 0
        for piece in range(pieces[max(cx - REACH, 0)], pieces[min(cx + REACH, shape[0] - 1) + 1]):
            for jy in range(max(cy - REACH, 0), min(cy + REACH, shape[1] - 1) + 1):
                row = (piece * shape[1] + jy) * shape[2]
                count += first[row + z1] - first[row + z0]
        largest = max(largest, count)
    return largest


@kernel
def rows_of_tasks(kind, first, blocks, shape):
    """Number of fluid and of boundary particles in each task of _BLOCKS_PER_TASK blocks: (tasks, 2) int64."""
    out = np.zeros(((blocks.size + _BLOCKS_PER_TASK - 1) // _BLOCKS_PER_TASK, 2), np.int64)
    for k in range(blocks.size):
        c = blocks[k]
        for i in range(first[c], first[c + min(_TALL, shape[2] - c % shape[2])]):
            out[k // _BLOCKS_PER_TASK, np.int64(kind[i] != FLUID)] += 1
    return out


@rows
def list_pairs(place, kind, image, cells, limits, offsets, lists, full):
    """Fill the rows of all particles in the blocks of `cells`; those of a task stand between its `offsets`.

    A column in two pieces is read cell by cell, so that candidates always come in the order of the whole column.
    Where a task might run out of room it is marked in `full` and left: the caller starts again with more.
    limits: room for the candidates of a block, and the squared radius, m2.
    """
    x, y, z = place
    first, blocks, column, pieces, shape = cells
    start, middle, end, index = lists.start, lists.middle, lists.end, lists.index
    room, radius2 = limits
    for task in prange(full.size):
        mark = np.empty(room, np.uint8)
        wet, dry = np.empty(room, np.uint32), np.empty(room, np.uint32)  # fluid and boundary candidates
        px, py, pz = np.empty(room), np.empty(room), np.empty(room)
        qx, qy, qz = np.empty(room), np.empty(room), np.empty(room)
        m = np.uint64(offsets[task])
        for c in blocks[task * _BLOCKS_PER_TASK : (task + 1) * _BLOCKS_PER_TASK]:
            cz = c % shape[2]
            cy = (c // shape[2]) % shape[1]
            cx = column[c // (shape[1] * shape[2])]
            a, b = np.uint64(first[c]), np.uint64(first[c + min(_TALL, shape[2] - cz)])
            low_x, low_y, low_z = np.inf, np.inf, np.inf
            high_x, high_y, high_z = -np.inf, -np.inf, -np.inf
            both = np.uint8(0)  # boundary particles look for fluid only
            for j in range(a, b):
                low_x, high_x = min(low_x, x[j]), max(high_x, x[j])
                low_y, high_y = min(low_y, y[j]), max(high_y, y[j])
                low_z, high_z = min(low_z, z[j]), max(high_z, z[j])
                both |= np.uint8(kind[j] == FLUID)
            fluids, walls = np.uint64(0), np.uint64(0)
            z0, z1 = max(cz - REACH, 0), min(cz + _TALL + REACH, shape[2])
            for jx in range(max(cx - REACH, 0), min(cx + REACH, shape[0] - 1) + 1):
                parts = pieces[jx + 1] - pieces[jx]
                for jy in range(max(cy - REACH, 0), min(cy + REACH, shape[1] - 1) + 1):
                    for run in range(1 if parts == 1 else parts * (z1 - z0)):
                        row = ((pieces[jx] + run % parts) * shape[1] + jy) * shape[2]
                        c0 = row + z0 + run // parts
                        c1 = row + z1 if parts == 1 else c0 + 1
                        begin, count = np.uint64(first[c0]), np.uint64(first[c1] - first[c0])
                        for t in range(count):
                            j = begin + t
                            dx = max(max(low_x - x[j], x[j] - high_x), 0.0)
                            dy = max(max(low_y - y[j], y[j] - high_y), 0.0)
                            dz = max(max(low_z - z[j], z[j] - high_z), 0.0)
                            close = np.uint8(dx * dx + dy * dy + dz * dz < radius2)
                            mark[t] = close * (np.uint8(1) if kind[j] == FLUID else np.uint8(2) * both)
                        for t in range(count):
                            wet[fluids] = begin + t
                            dry[walls] = begin + t
                            fluids += np.uint64(mark[t] & np.uint8(1))
                            walls += np.uint64(mark[t] >> np.uint8(1))
            for t in range(fluids):
                px[t], py[t], pz[t] = x[wet[t]], y[wet[t]], z[wet[t]]
            for t in range(walls):
                qx[t], qy[t], qz[t] = x[dry[t]], y[dry[t]], z[dry[t]]
            for i in range(a, b):
                start[i] = middle[i] = end[i] = m
                if image[i]:
                    continue
                if m + fluids + walls > np.uint64(offsets[task + 1]):
                    full[task] = 1
                    break
                xi, yi, zi = x[i], y[i], z[i]
                for t in range(fluids):
                    dx, dy, dz = px[t] - xi, py[t] - yi, pz[t] - zi
                    mark[t] = (dx * dx + dy * dy + dz * dz < radius2) & (wet[t] != i)
                for t in range(fluids):
                    index[m] = wet[t]
                    m += np.uint64(mark[t])
                middle[i] = m
                if kind[i] == FLUID:
                    for t in range(walls):
                        dx, dy, dz = qx[t] - xi, qy[t] - yi, qz[t] - zi
                        mark[t] = dx * dx + dy * dy + dz * dz < radius2
                    for t in range(walls):
                        index[m] = dry[t]
                        m += np.uint64(mark[t])
                end[i] = m
