"""The global grid of cells, anchored to the box: cell of a point, sort by (cell, id), layer offsets.

A layer is all cells with the same x-index. Cells of edge (re + skin) / REACH make a halo of REACH layers.
"""

import numpy as np

from parsim.jit import kernel

REACH = 2


class Grid:
    """Cells over `low`..`high` (3,) m, of edge at least `reach_length / REACH`.

    On a periodic axis the edge divides the period, and in y and z REACH cells beyond each side hold the images.
    Attributes: origin (3,), edge (3,), count (3,) int: cells with image cells, pad (3,) int, layers: int.
    """

    def __init__(self, low, high, reach_length, periodic):
        low, high = np.asarray(low, float), np.asarray(high, float)
        self.low, self.high, self.periodic = low, high, tuple(bool(p) for p in periodic)
        self.period = np.where(self.periodic, high - low, 0.0)
        inner = np.maximum(1, np.floor((high - low) / (reach_length / REACH) * (1 + 1e-12))).astype(np.int64)
        self.edge = (high - low) / inner
        self.pad = np.array([0, REACH * self.periodic[1], REACH * self.periodic[2]], np.int64)
        self.origin = low - self.pad * self.edge
        self.count = inner + 2 * self.pad
        self.layers = int(inner[0])
        self.per_layer = int(self.count[1] * self.count[2])

    def layer(self, x):
        """Layer of each x (n,), clipped to the grid."""
        return np.clip(np.floor((x - self.origin[0]) / self.edge[0]).astype(np.int64), 0, self.layers - 1)

    def cell(self, x, y, z, first_layer=0):
        """Cell index of each point (n,), counted from layer `first_layer`; points outside go to the nearest cell."""
        return cell_index(x, y, z, self.origin, self.edge, self.count, first_layer)


@kernel
def cell_index(x, y, z, origin, edge, count, first_layer):
    """Cell of each point (n,) int64: x slowest, z fastest."""
    out = np.empty(x.size, np.int64)
    for i in range(x.size):
        cx = min(max(int(np.floor((x[i] - origin[0]) / edge[0])), 0), count[0] - 1)
        cy = min(max(int(np.floor((y[i] - origin[1]) / edge[1])), 0), count[1] - 1)
        cz = min(max(int(np.floor((z[i] - origin[2]) / edge[2])), 0), count[2] - 1)
        out[i] = ((cx - first_layer) * count[1] + cy) * count[2] + cz
    return out


@kernel
def sort_by_cell(cell, ident, cells):
    """Order (n,) that sorts by (cell, id), and the first particle of each cell (cells + 1,).

    Counting sort, then insertion by id inside a cell, which holds only a few particles.
    """
    first = np.zeros(cells + 1, np.int64)
    for i in range(cell.size):
        first[cell[i] + 1] += 1
    for c in range(cells):
        first[c + 1] += first[c]
    filled = first[:-1].copy()
    order = np.empty(cell.size, np.int64)
    for i in range(cell.size):
        c = cell[i]
        at = filled[c]
        while at > first[c] and ident[order[at - 1]] > ident[i]:
            order[at] = order[at - 1]
            at -= 1
        order[at] = i
        filled[c] += 1
    return order, first


@kernel
def occupied(x, y, z, origin, edge, count, first_layer, layers):
    """Which cells hold a point: uint8 (layers, count[1], count[2]), layers counted from `first_layer`."""
    out = np.zeros((layers, count[1], count[2]), np.uint8)
    for i in range(x.size):
        cx = min(max(int(np.floor((x[i] - origin[0]) / edge[0])), 0), count[0] - 1) - first_layer
        cy = min(max(int(np.floor((y[i] - origin[1]) / edge[1])), 0), count[1] - 1)
        cz = min(max(int(np.floor((z[i] - origin[2]) / edge[2])), 0), count[2] - 1)
        if 0 <= cx < layers:
            out[cx, cy, cz] = 1
    return out


@kernel
def holding(value, field, first):
    """Which cells hold a particle whose `field` is `value`: uint8 (cells,)."""
    out = np.zeros(first.size - 1, np.uint8)
    for c in range(out.size):
        for i in range(first[c], first[c + 1]):
            out[c] |= np.uint8(field[i] == value)
    return out


@kernel
def spread(marks, reach):
    """Marks (a, b, c) uint8 grown by `reach` cells along each axis in turn."""
    grown = marks
    for axis in range(3):
        source = grown
        grown = np.zeros_like(source)
        for i in range(source.shape[0]):
            for j in range(source.shape[1]):
                for k in range(source.shape[2]):
                    if source[i, j, k]:
                        at = (i, j, k)
                        low = max(at[axis] - reach, 0)
                        high = min(at[axis] + reach, source.shape[axis] - 1)
                        for m in range(low, high + 1):
                            if axis == 0:
                                grown[m, j, k] = 1
                            elif axis == 1:
                                grown[i, m, k] = 1
                            else:
                                grown[i, j, m] = 1
    return grown
