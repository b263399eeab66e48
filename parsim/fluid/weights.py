"""The MPS weight and its lattice constants."""

import math

import numpy as np


class Lattice:
    """Constants of the full square or cubic lattice for the weight W = re / r - 1 (Mellado 2021, eqs 5.4, 5.12).

    Attributes: dimensions; spacing, m; radius re, m; number n0, the sum of W; spread lambda, m2, the W-mean of r2;
    count, the number of neighbours; cut: what a flat surface that leaves one row above a particle cuts off of n0, over
    the length of the sum of W e that is cut off with it, e towards the neighbours.
    """

    def __init__(self, dimensions, spacing, support):
        self.dimensions, self.spacing, self.radius = dimensions, spacing, support * spacing
        reach = math.ceil(support)
        offsets = np.arange(-reach, reach + 1)
        axes = [offsets] * dimensions
        grid = [a.astype(float).ravel() for a in np.meshgrid(*axes)]
        r2 = sum(a * a for a in grid)
        r = np.sort(np.sqrt(r2[(r2 > 0) & (r2 < support * support)]))
        weights = support / r - 1.0
        self.number = math.fsum(weights)
        self.spread = math.fsum(weights * r * r) / self.number * spacing**2
        self.count = r.size
        away = (r2 < support * support) & (grid[0] >= 2.0)
        lost = support / np.sqrt(r2[away]) - 1.0
        self.cut = math.fsum(lost) / math.fsum(lost * grid[0][away] / np.sqrt(r2[away]))

    @property
    def volume(self):
        """Volume of one lattice particle, m^d."""
        return self.spacing**self.dimensions
