"""What a source of samples needs to know of the slab that it gives them to."""

import numpy as np

from parsim.particles.cells import LAYERS, REACH


class Slab:
    """Layers `begin` to `end`, and which of their cells water can reach."""

    def __init__(self, grid, begin, end, marks):
        self.begin, self.end = begin, end
        self._grid, self._marks = grid, marks

    def cells(self, x, y, z):
        """Cell of each point (n,) within the slab, -1 for points of other slabs."""
        layer = self._grid.layer(x)
        cell = self._grid.cell(layer // LAYERS - self.begin // LAYERS, y, z)
        return np.where((layer >= self.begin) & (layer < self.end), cell, -1)

    def reached(self, x, radius):
        """Which of the balls about x (n,) of `radius` (n,), m, reach into the slab: bool (n,)."""
        return (self._grid.layer(x + radius) >= self.begin) & (self._grid.layer(x - radius) < self.end)

    def beside_period(self, x, y, z, radius=0.0):
        """Which of the balls about x, y, z (n,) of `radius`, m, come within a halo of a periodic side: bool (n,)."""
        g, points, found = self._grid, (x, y, z), np.zeros(x.size, bool)
        for axis in np.flatnonzero(g.periodic):
            inside = np.minimum(points[axis] - g.low[axis], g.high[axis] - points[axis]) - radius
            found |= inside < REACH * g.edge[axis]
        return found

    def awake(self, cells):
        """Which of `cells` (n,) are in the slab and within reach of water: bool (n,)."""
        return (cells >= 0) & (self._marks[cells] == 1)
