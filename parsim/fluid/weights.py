"""The MPS weight and its lattice constants."""

import math

import numpy as np


class Lattice:
    """Constants of the full square or cubic lattice for the weight W = re / r - 1 (Mellado 2021, eqs 5.4, 5.12).

    Attributes: dimensions; spacing, m; radius re, m; number n0, the sum of W; spread lambda, m2, the W-mean of r2;
    count, the number of neighbours.
    """

    def __init__(self, dimensions, spacing, support):
        self.dimensions, self.spacing, self.radius = dimensions, spacing, support * spacing
        reach = math.ceil(support)
        offsets = np.arange(-reach, reach + 1)
        axes = [offsets] * dimensions
        r2 = sum(a.astype(float) ** 2 for a in np.meshgrid(*axes)).ravel()
        r = np.sort(np.sqrt(r2[(r2 > 0) & (r2 < support * support)]))
        weights = support / r - 1.0
        self.number = math.fsum(weights)
        self.spread = math.fsum(weights * r * r) / self.number * spacing**2
        self.count = r.size

    @property
    def volume(self):
        """Volume of one lattice particle, m^d."""
        return self.spacing**self.dimensions
