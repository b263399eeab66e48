"""A plate across the whole box that rises at constant speed, thinner than the support of the water.

The waters on its two sides must not see each other through it: each side meets its own samples, up to a whole support
deep, and pairs that the plate hides are taken out of the lists (`parsim.particles.neighbours`).
"""

import math

import numpy as np

from parsim.boundary.wall_samples import lattice_axis, samples_of
from parsim.particles.state import GATE_DOWN, GATE_UP, Particles

_FAR = 1e3  # half edges of the plate over the size of the box: it has neither ends nor a top


class Gate:
    """Motion of the plate. Attributes: min_x, max_x, m, its faces; half (3,), m, half edges, of no end but below."""

    def __init__(self, case):
        gate = case.gate
        self.min_x, self.max_x = gate.min_x, gate.max_x
        far = _FAR * max(high - low for low, high in zip(case.box.min, case.box.max, strict=True))
        self.half = np.array([0.5 * (gate.max_x - gate.min_x), far, far])
        self._floor = case.box.min[2]
        self._lowest = gate.bottom
        self._speed, self._opens = gate.speed, gate.opens

    def bottom(self, time):
        """Height of the lower edge at `time`, m."""
        return self._lowest + self._speed * max(time - self._opens, 0.0)

    def centre(self, time):
        """Where its middle is at `time`, (3,), m."""
        return np.array([0.5 * (self.max_x + self.min_x), 0.0, self.bottom(time) + self.half[2]])

    def velocity(self, time):
        """Upward speed at `time`, m/s."""
        return self._speed if time > self._opens else 0.0

    def barrier(self, time):
        """Height above which the plate hides, m: everything while it stands on the floor."""
        return -math.inf if self.closed(time) else self.bottom(time)

    def outline(self, time):
        """Low and high x and lower edge of the plate at `time`, m, and 1: (4,)."""
        return np.array([self.min_x, self.max_x, self.bottom(time), 1.0])

    def closed(self, time):
        """Whether the plate stands on the floor at `time`, s."""
        return self.bottom(time) <= self._floor


class GateSamples:
    """The samples that each side of the gate shows to the water, a lattice that hangs on the plate.

    Where floor and sides of the tank go on behind the plate they are on the lattice of the walls, from the first one
    that the plate hides: else there is a hole of up to half a spacing in the floor, through which water leaves.
    """

    def __init__(self, case, gate, layers):
        self.gate, self._case, self._layers = gate, case, layers
        x, _ = lattice_axis(case, 0, layers)
        self._behind_up, self._behind_down = x[x >= gate.min_x][:layers], x[x <= gate.max_x][::-1][:layers]

    def samples(self, slab, time):
        """Samples of the slab at `time`, s: Particles with the row above the edge as `sample`."""
        case, l0 = self._case, self._case.spacing
        begin = -self._layers if self.gate.closed(time) else 0
        rows = np.arange(begin, math.ceil((case.box.max[2] - self.gate.bottom(time)) / l0))
        across, side = lattice_axis(case, 1, self._layers)
        depth = (np.arange(self._layers) + 0.5) * l0
        in_walls = np.tile((side != 0)[:, None] | (rows < 0), (self._layers, 1, 1)).ravel()
        parts = []
        for kind, x, behind in (
            (GATE_UP, self.gate.min_x + depth, self._behind_up),
            (GATE_DOWN, self.gate.max_x - depth, self._behind_down),
        ):
            part = samples_of(kind, x, across, self.gate.bottom(time) + (rows + 0.5) * l0)
            part.x[in_walls] = np.repeat(behind, across.size * rows.size)[in_walls]
            part.sample = np.tile(rows, x.size * across.size).astype(np.int32)
            part.w[:] = self.gate.velocity(time)
            parts.append(part)
        both = Particles.join(parts)
        return both.take(slab.awake(slab.cells(both.x, both.y, both.z)))

    def place(self, p, time):
        """Move the samples among the particles `p` to where the plate is at `time`."""
        at = np.flatnonzero((p.kind == GATE_UP) | (p.kind == GATE_DOWN))
        p.z[at] = self.gate.bottom(time) + (p.sample[at] + 0.5) * self._case.spacing
        p.w[at] = self.gate.velocity(time)
