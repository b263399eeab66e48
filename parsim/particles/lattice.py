"""Even points in a box."""

import numpy as np

from parsim.case.fill import corners


class Lattice:
    """Even points in a box with about the spacing, numbered with z fastest; an axis not in `axes` keeps its middle.

    Attributes: rows, three arrays of coordinates, m; spacing (3,), m; size, the number of points.
    """

    def __init__(self, low, high, spacing, axes):
        lengths = [high[a] - low[a] for a in range(3)]
        counts = [max(round(lengths[a] / spacing), 1) if a in axes else 1 for a in range(3)]
        self.spacing = [length / count for length, count in zip(lengths, counts, strict=True)]
        self.rows = [low[a] + (np.arange(counts[a]) + 0.5) * self.spacing[a] for a in range(3)]
        self.size = counts[0] * counts[1] * counts[2]

    def points(self, number):
        """The points of these numbers: (n, 3), m."""
        at = np.unravel_index(number, [row.size for row in self.rows])
        return np.stack([row[index] for row, index in zip(self.rows, at, strict=True)], -1)

    def within(self, *wanted):
        """Numbers of the points whose three indices are all `wanted`, by axis: bool (points of that row,)."""
        grid = np.ix_(*(np.flatnonzero(rows) for rows in wanted))
        return np.ravel_multi_index(grid, [row.size for row in self.rows]).ravel()


def lattice_of(case, fill):
    """The `Lattice` of a fill of a case."""
    low, high = corners(case, fill)
    return Lattice(low, high, case.spacing, case.axes)
