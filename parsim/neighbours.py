"""Neighbour lists from cell-sorted particles, fluid neighbours first, then boundary ones.

Candidates of a cell are copied once into small contiguous buffers, from which each of its particles selects without a
branch: 1.3-2 us per row at 160 listed neighbours in 3D, of which copying is about half. Cells finer than half the reach
cost more in copying than they save in candidates (1.0, 1.8 and 2.7 us at 1/2, 1/3 and 1/4 of the reach).
"""

import numpy as np

from parsim.cells import REACH
from parsim.jit import kernel, prange, rows
from parsim.state import BODY, FLUID, GATE_DOWN, GATE_UP, WALL

_CELLS_PER_TASK = 64


class Neighbours:
    """Lists of one rank: row i holds index[start[i]:middle[i]] fluid and index[middle[i]:end[i]] boundary particles.

    `fluid` and `boundary` are the owned particles (int64 indices) that have neighbours to look at; `body` those of
    `boundary` that sample a rigid body. Rows of boundary particles hold fluid only.
    """

    def __init__(self, stride):
        self.stride = stride
        self.start = self.middle = self.end = np.zeros(0, np.int64)
        self.index = np.zeros(0, np.uint32)
        self.fluid = self.boundary = self.body = np.zeros(0, np.int64)

    def build(self, particles, first, grid, owned, radius):
        """Fill the lists of the owned particles (slice), sorted into cells with offsets `first`, up to `radius` m."""
        p, count = particles, len(particles)
        self.start, self.middle, self.end = (np.zeros(count, np.int64) for _ in range(3))
        shape = np.array([(first.size - 1) // grid.per_layer, grid.count[1], grid.count[2]], np.int64)
        cells = filled_cells(first, shape[0] - 2 * REACH, REACH * grid.per_layer)
        room = largest_block(first, cells, shape)
        while True:
            needed = (owned.stop - owned.start) * self.stride + room
            if self.index.size < needed:
                self.index = np.empty(int(needed * 1.1), np.uint32)
            list_pairs(p.x, p.y, p.z, p.kind, p.image, first, cells, shape, room, radius * radius, owned.start,
                       self.stride, self.start, self.middle, self.end, self.index)
            longest = int((self.end - self.start).max(initial=0))
            if longest <= self.stride:
                break
            self.stride = int(longest * 1.1) + 8
        self._sort_rows(p, owned)

    def _sort_rows(self, p, owned):
        real = np.arange(owned.start, owned.stop)[p.image[owned] == 0]
        self.fluid = real[p.kind[real] == FLUID]
        self.boundary = real[(p.kind[real] != FLUID) & (self.end[real] > self.start[real])]
        self.body = self.boundary[p.body[self.boundary] >= 0]

    def cut_by_gate(self, particles, radius, gate, time):
        """Take out the pairs that the gate hides from each other at `time`, s."""
        p, barrier = particles, gate.barrier(time)
        if barrier > p.z[p.kind == FLUID].max(initial=-np.inf) + radius:  # of the halo too: walls look into it
            return
        near = np.sort(np.concatenate([self.fluid, self.boundary]))
        # each side's samples reach up to a support, less than `radius`, beyond the other face
        near = near[(p.x[near] > gate.min_x - 2.5 * radius) & (p.x[near] < gate.max_x + 2.5 * radius)]
        cut_rows(near, p.x, p.z, p.kind, gate.min_x, gate.max_x, barrier, self.start, self.middle, self.end,
                 self.index)
        self.boundary = self.boundary[self.end[self.boundary] > self.start[self.boundary]]
        self.body = self.body[self.end[self.body] > self.start[self.body]]


@kernel
def filled_cells(first, layers, begin):
    """Indices of the cells in the owned layers, starting at cell `begin`, that hold a particle."""
    last = first.size - 1 - begin
    out = np.empty(last - begin, np.int64)
    count = 0
    for c in range(begin, last):
        if first[c + 1] > first[c]:
            out[count] = c
            count += 1
    return out[:count]


@kernel
def largest_block(first, cells, shape):
    """Largest number of particles in the block of cells around any of `cells`."""
    largest = 0
    for c in cells:
        cz = c % shape[2]
        cy = (c // shape[2]) % shape[1]
        cx = c // (shape[1] * shape[2])
        block = 0
        for jx in range(max(cx - REACH, 0), min(cx + REACH, shape[0] - 1) + 1):
            for jy in range(max(cy - REACH, 0), min(cy + REACH, shape[1] - 1) + 1):
                row = (jx * shape[1] + jy) * shape[2]
                block += first[row + min(cz + REACH, shape[2] - 1) + 1] - first[row + max(cz - REACH, 0)]
        largest = max(largest, block)
    return largest


@rows
def list_pairs(x, y, z, kind, image, first, cells, shape, room, radius2, offset, stride, start, middle, end, index):
    """Fill the rows of all particles in `cells`.

    A row longer than `stride` runs into the next one: the caller sees its length and starts again with longer rows.
    """
    for task in prange((cells.size + _CELLS_PER_TASK - 1) // _CELLS_PER_TASK):
        # fluid candidates grow from the front, boundary ones from the back of the same buffers
        bx, by, bz = np.empty(room + 1), np.empty(room + 1), np.empty(room + 1)
        bj = np.empty(room + 1, np.uint32)
        for c in cells[task * _CELLS_PER_TASK : (task + 1) * _CELLS_PER_TASK]:
            cz = c % shape[2]
            cy = (c // shape[2]) % shape[1]
            cx = c // (shape[1] * shape[2])
            fluids = np.uint64(0)
            walls = np.uint64(room)
            a, b = np.uint64(first[c]), np.uint64(first[c + 1])
            wanted = np.uint64(kind[a] == FLUID)  # by id fluid comes first, and boundary particles look for fluid only
            low_x, low_y, low_z = np.inf, np.inf, np.inf
            high_x, high_y, high_z = -np.inf, -np.inf, -np.inf
            for j in range(a, b):
                low_x, high_x = min(low_x, x[j]), max(high_x, x[j])
                low_y, high_y = min(low_y, y[j]), max(high_y, y[j])
                low_z, high_z = min(low_z, z[j]), max(high_z, z[j])
            for jx in range(max(cx - REACH, 0), min(cx + REACH, shape[0] - 1) + 1):
                for jy in range(max(cy - REACH, 0), min(cy + REACH, shape[1] - 1) + 1):
                    row = (jx * shape[1] + jy) * shape[2]
                    c0, c1 = row + max(cz - REACH, 0), row + min(cz + REACH, shape[2] - 1) + 1
                    for j in range(np.uint64(first[c0]), np.uint64(first[c1])):
                        dx = max(max(low_x - x[j], x[j] - high_x), 0.0)
                        dy = max(max(low_y - y[j], y[j] - high_y), 0.0)
                        dz = max(max(low_z - z[j], z[j] - high_z), 0.0)
                        # without a branch: a candidate that is too far is overwritten by the next one
                        close = np.uint64(dx * dx + dy * dy + dz * dz < radius2)
                        water = np.uint64(kind[j] == FLUID)
                        at = fluids if water else walls
                        bx[at] = x[j]
                        by[at] = y[j]
                        bz[at] = z[j]
                        bj[at] = j
                        fluids += close & water
                        walls -= close & (np.uint64(1) - water) & wanted
            for i in range(a, b):
                m = np.uint64((i - offset) * stride)
                start[i] = middle[i] = end[i] = m
                if image[i]:
                    continue
                xi, yi, zi = x[i], y[i], z[i]
                for t in range(fluids):
                    dx, dy, dz = bx[t] - xi, by[t] - yi, bz[t] - zi
                    index[m] = bj[t]
                    m += np.uint64((dx * dx + dy * dy + dz * dz < radius2) & (bj[t] != i))
                middle[i] = m
                if kind[i] == FLUID:
                    # from the back, so that boundary neighbours too come in the order of the cells
                    for s in range(np.uint64(room) - walls):
                        t = np.uint64(room) - s
                        dx, dy, dz = bx[t] - xi, by[t] - yi, bz[t] - zi
                        index[m] = bj[t]
                        m += np.uint64(dx * dx + dy * dy + dz * dz < radius2)
                end[i] = m


@kernel
def hidden(xa, za, xb, zb, low, high, barrier):
    """Whether the segment a-b meets the plate low <= x <= high at z >= barrier; low = high for its middle plane."""
    if min(xa, xb) > high or max(xa, xb) < low:
        return False
    if barrier == -np.inf:
        return True
    top = -np.inf
    for x in (low, high):
        if min(xa, xb) <= x <= max(xa, xb) and xa != xb:
            top = max(top, za + (zb - za) * (x - xa) / (xb - xa))
    if low <= xa <= high:
        top = max(top, za)
    if low <= xb <= high:
        top = max(top, zb)
    return top >= barrier


@kernel
def sees_gate(xf, zf, xg, zg, kind, low, high, barrier):
    """Whether a particle at f meets the gate sample at g: each side its own samples, from below the inner ones."""
    if kind == GATE_UP:
        if xf >= 0.5 * (low + high):
            return False
        face = low
    else:
        if xf < 0.5 * (low + high):
            return False
        face = high
    if low <= xg <= high:
        return True
    if low < xf < high:
        return False
    return zf + (zg - zf) * (face - xf) / (xg - xf) >= barrier


@kernel
def visible(i, j, other, x, z, low, high, barrier):
    """Whether the gate leaves particles i and j, one of them fluid and `other` the kind of the other, in sight.

    Water and bodies are hidden from each other where the middle plane of the plate lies between them: around its edge
    they are one water, and hiding what is behind the corner would leave holes in the support that look like a free
    surface. Walls are hidden by the whole plate, whose own samples stand there.
    """
    if other == WALL:
        return not hidden(x[i], z[i], x[j], z[j], low, high, barrier)
    if other == GATE_UP or other == GATE_DOWN:
        return sees_gate(x[i], z[i], x[j], z[j], other, low, high, barrier)
    middle = 0.5 * (low + high)
    return not hidden(x[i], z[i], x[j], z[j], middle, middle, barrier)


@kernel
def cut_rows(near, x, z, kind, low, high, barrier, start, middle, end, index):
    """Compact the rows `near` in place, keeping only neighbours that the gate leaves in sight.

    Nearly all pairs are settled by lying on one side of the plate.
    """
    between = 0.5 * (low + high)
    for i in near:
        m = start[i]
        own = kind[i]
        if own == FLUID or own == BODY:
            for t in range(start[i], middle[i]):
                j = index[t]
                index[m] = j
                m += (x[i] - between) * (x[j] - between) > 0.0 or visible(i, j, BODY, x, z, low, high, barrier)
        else:
            for t in range(start[i], middle[i]):
                j = index[t]
                index[m] = j
                m += visible(j, i, own, x, z, low, high, barrier)
        kept = m
        for t in range(middle[i], end[i]):
            j = index[t]
            index[m] = j
            m += visible(i, j, kind[j], x, z, low, high, barrier)
        middle[i] = kept
        end[i] = m
