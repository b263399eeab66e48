"""The global grid of cells and layers, anchored to the box: cell of a point, sort by cell, what a slab stores where.

Cells of edge (re + skin) / REACH make a halo of REACH cells. A *layer* is a slice across x of 1 / LAYERS of a cell: a
slab is a run of whole layers, so that work can be cut finely while lists are still searched in large cells. A column
is all cells with the same x-index; one that a cut runs through is stored in two pieces, one for each owner.
"""

import numpy as np

from parsim.machine.jit import kernel

REACH = 2
LAYERS = 8
HALO = REACH * LAYERS  # layers of a halo, and the fewest that a slab may have
_ID_BITS = 59  # ids are smaller than 2^59: what the layer within the cell is put above


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
        self.layers = int(inner[0]) * LAYERS
        self.per_column = int(self.count[1] * self.count[2])

    def layer(self, x):
        """Layer of each x (n,), clipped to the grid."""
        return layer_index(x, self.origin[0], self.edge[0] / LAYERS, self.layers)

    def cell(self, slot, y, z):
        """Cell of each point (n,) in column or piece `slot` (n,): y slower, z fastest; clipped to the grid."""
        return cell_index(slot, y, z, self.origin, self.edge, self.count)


class Stack:
    """How a slab of layers `begin` to `end` and its halos are stored: in pieces of columns, halos and owned apart.

    Attributes: piece (layers,), the piece of each stored layer; column (pieces,), the stored column of each piece;
    pieces (columns + 1,), the first piece of each stored column; own, the slice of owned pieces.
    """

    def __init__(self, begin, end):
        layers = np.arange(begin - HALO, end + HALO)
        column = layers // LAYERS
        new = (np.diff(column) != 0) | (layers[1:] == begin) | (layers[1:] == end)
        self.piece = np.concatenate([[0], np.cumsum(new)])
        self.column = column[np.concatenate([[True], new])] - column[0]
        self.pieces = np.searchsorted(self.column, np.arange(self.column[-1] + 2))
        self.own = slice(int(self.piece[HALO]), int(self.piece[HALO + end - begin - 1]) + 1)


@kernel
def layer_index(x, origin, thickness, layers):
    """Layer of each x (n,) int64, clipped to 0..layers - 1."""
    out = np.empty(x.size, np.int64)
    for i in range(x.size):
        out[i] = min(max(int(np.floor((x[i] - origin) / thickness)), 0), layers - 1)
    return out


@kernel
def cell_index(slot, y, z, origin, edge, count):
    """Cell of each point (n,) int64: slot slowest, z fastest."""
    out = np.empty(y.size, np.int64)
    for i in range(y.size):
        cy = min(max(int(np.floor((y[i] - origin[1]) / edge[1])), 0), count[1] - 1)
        cz = min(max(int(np.floor((z[i] - origin[2]) / edge[2])), 0), count[2] - 1)
        out[i] = (slot[i] * count[1] + cy) * count[2] + cz
    return out


def sort_key(layer, ident):
    """What particles (n,) of one cell are sorted by, int64: the layer within the cell, then the id.

    So the part of a cell on one side of a cut comes in the same order as in the whole cell.
    """
    return ((layer % LAYERS) << _ID_BITS) + ident


@kernel
def sort_by_cell(cell, key, cells):
    """Order (n,) that sorts by (cell, key), and the first particle of each cell (cells + 1,).

    Counting sort, then insertion by key inside a cell, which holds only a few particles.
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
        while at > first[c] and key[order[at - 1]] > key[i]:
            order[at] = order[at - 1]
            at -= 1
        order[at] = i
        filled[c] += 1
    return order, first


@kernel
def occupied(cell, cells):
    """Which of `cells` cells hold a particle of cell (n,): uint8 (cells,)."""
    out = np.zeros(cells, np.uint8)
    for i in range(cell.size):
        out[cell[i]] = 1
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
