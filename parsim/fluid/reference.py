"""What the sums of the water are on the full lattice: the constants that its operators are scaled with."""

import itertools
import math

from parsim.fluid.weights import WEIGHTS
from parsim.fluid.weights.choice import weight_at

_SPLASH = 0.65  # of the concentration of a flat surface: less has only a splash
_SECOND = 0.8  # of the way from the first row of a flat surface to the second: more has only the inside


class Lattice:
    """Constants of the full square or cubic lattice for one weight (Mellado 2021, eqs 5.4, 5.12).

    Attributes: dimensions; spacing, m; radius re, m; weight: parameters for `weight_at`; count, the number of
    neighbours; number n0, the sum of W; spread lambda, m2, the W-mean of r2; slopes, 1/m2, the sum of W / r2; own, a
    particle's measure of itself; whole, the sum of the measure with it; cut: what a flat surface that leaves one row
    above a particle cuts off of that, over the length of the sum of measure times e that is cut off with it, e towards
    the neighbours; lowest, highest: the concentrations between which a particle may be at the surface.
    """

    def __init__(self, dimensions, spacing, support, name):
        self.dimensions, self.spacing, self.radius = dimensions, spacing, support * spacing
        self.weight, self.own = WEIGHTS[name].of_radius(self.radius), WEIGHTS[name].OWN
        points = self.points()
        self.count = len(points)
        self.number = math.fsum(w for w, _, _, _ in points)
        self.spread = math.fsum(w * r * r for w, _, r, _ in points) / self.number
        self.slopes = math.fsum(w / (r * r) for w, _, r, _ in points)
        self.whole = self.own + math.fsum(m for _, m, _, _ in points)
        lost = [(m, m * up / r) for _, m, r, up in points if up > 1.5 * spacing]
        self.cut = math.fsum(m for m, _ in lost) / math.fsum(e for _, e in lost)
        first, second = self.concentration(0), self.concentration(1)
        self.lowest, self.highest = _SPLASH * first, first + _SECOND * (second - first)

    def points(self):
        """W, measure, distance, m, and height, m, of every neighbour on the lattice: a list of tuples."""
        reach = math.ceil(self.radius / self.spacing)
        found = []
        for offset in itertools.product(range(-reach, reach + 1), repeat=self.dimensions):
            r2 = sum(a * a for a in offset) * self.spacing**2
            if 0.0 < r2 < self.radius**2:
                w, _, measure = weight_at(self.weight, r2, 1.0 / math.sqrt(r2))
                found.append((w, measure, math.sqrt(r2), offset[-1] * self.spacing))
        return found

    def concentration(self, rows):
        """Concentration of a particle with that many rows of the lattice between it and a flat surface."""
        below = math.fsum(m for _, m, _, up in self.points() if up < (rows + 0.5) * self.spacing)
        return (self.own + below) / self.whole

    @property
    def volume(self):
        """Volume of one lattice particle, m^d."""
        return self.spacing**self.dimensions
