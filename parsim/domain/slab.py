"""What a source of samples needs to know of the slab that it gives them to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from parsim.particles.cells import LAYERS

if TYPE_CHECKING:
    from parsim.particles.cells import Grid
    from parsim.particles.state import Particles


class Source(Protocol):
    """What gives samples of something solid: bodies, gate, walls."""

    def samples(self, slab: Slab, time: float) -> Particles:
        """Those that stand in the slab at `time`, s."""


class Slab:
    """Layers `begin` to `end`, and which of their cells water can reach."""

    def __init__(self, grid: Grid, begin: int, end: int, marks: np.ndarray) -> None:
        self.begin, self.end = begin, end
        self._grid, self._marks = grid, marks

    def cells(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Cell of each point (n,) within the slab, -1 for points of other slabs."""
        layer = self._grid.layer(x)
        cell = self._grid.cell(layer // LAYERS - self.begin // LAYERS, y, z)
        return np.where((layer >= self.begin) & (layer < self.end), cell, -1)

    def reached(self, x: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Which of the balls about x (n,) of `radius` (n,), m, reach into the slab: bool (n,)."""
        return (self._grid.layer(x + radius) >= self.begin) & (self._grid.layer(x - radius) < self.end)

    def awake(self, cells: np.ndarray) -> np.ndarray:
        """Which of `cells` (n,) are in the slab and within reach of water: bool (n,)."""
        return (cells >= 0) & (self._marks[cells] == 1)
