"""The rows of the series: exact sums over the particles of all ranks."""

import numpy as np

from parsim.case.bodies import GAUGE_REACH
from parsim.geometry.faces import planes_of_walls
from parsim.geometry.rotation import matrices
from parsim.observe import water


class Measure:
    """Reads a simulation; `rows` is called on all ranks together."""

    def __init__(self, case, simulation):
        self.case = case
        self.walls, self.axes = planes_of_walls(case), np.array(case.axes)
        middle = 0.5 * (case.box.min[1] + case.box.max[1])
        self.gauges = np.array([[g.x, middle if g.y is None else g.y] for g in case.output.gauges]).reshape(-1, 2)

    def rows(self, simulation):
        """Rows of every series but "lost": name -> list of rows, without step and time."""
        return {
            "energy": [self._energy(simulation)],
            "counts": [self._counts(simulation)],
            "front": [[self._front(simulation)]],
            "gauges": self._gauges(simulation),
            "bodies": self._bodies(simulation),
            "loads": self._loads(simulation),
        }

    def _energy(self, s):
        p, at, out = s.domain.particles, s.near.fluid, np.empty((s.near.fluid.size, 4))
        constants = s.scheme.mass, s.scheme.lattice.number, s.scheme.sound**2
        water.energies(at, p.kinematics, p.n, constants, self.case.gravity, out)
        kinetic, potential, elastic, volume = (float(value) for value in s.domain.sum(out))
        self.volume = volume * s.scheme.lattice.volume  # of m / rho, not of N
        b, c = s.bodies, s.contacts
        parts = [kinetic, potential, elastic, b.kinetic_energy(), b.potential_energy(self.case.gravity),
                 c.elastic_energy()]
        return [s.dt, *parts, c.gate_work, c.dissipated, sum(parts)]

    def _counts(self, s):
        p, at, count = s.domain.particles, s.near.fluid, np.zeros(3, np.int64)
        gate = (s.gate.min_x, s.gate.max_x, s.gate.barrier(s.time)) if s.gate else (0.0, 0.0, np.inf)
        bodies = s.bodies.position, matrices(s.bodies.quaternion), s.bodies.half, self.axes
        water.misplaced(at, p.place, self.walls, bodies, gate, 0.25 * self.case.spacing, count)
        surface = water.count_surface(at, p.surface)
        fluid, *rest = s.domain.count(at.size, *count, s.domain.lost, surface)
        every = fluid + len(s.solids.walls) + len(s.solids.samples)
        return [fluid, s.active, every, *rest, self.volume, int(s.bodies.gone.sum())]

    def _front(self, s):
        p, width = s.domain.particles, 2.0 * self.case.spacing
        low, high = self.case.box.min[0], self.case.box.max[0]
        count = int((high - low) / width) + 1
        filled, farthest = np.zeros(count), np.full(count, -np.inf)
        water.columns(s.near.fluid, p.surface, p.x, low, width, filled, farthest)
        both = s.domain.max(*filled, *farthest)
        return float(water.front(both[:count], both[count:], self.case.spacing))

    def _gauges(self, s):
        if not len(self.gauges):
            return []
        p, top = s.domain.particles, np.full(len(self.gauges), -np.inf)
        water.levels(s.near.fluid, p.surface, p.place, self.gauges, GAUGE_REACH * self.case.spacing,
                     self.case.dimensions == 2, top)
        top = s.domain.max(*top)
        level = np.where(np.isfinite(top), top + 0.5 * self.case.spacing, np.nan)
        return [[g.name, float(x), float(y), float(z)]
                for g, (x, y), z in zip(self.case.output.gauges, self.gauges, level, strict=True)]

    def _bodies(self, s):
        values = np.hstack([s.bodies.shown(name) for name in ("position", "quaternion", "velocity", "spin")])
        return [[name, *map(float, row)] for name, row in zip(s.bodies.names, values, strict=True)]

    def _loads(self, s):
        loads = {kind: s.bodies.shown(f"{kind}_load") for kind in ("water", "contact", "gravity")}
        return [[name, kind, *map(float, load[k])]
                for k, name in enumerate(s.bodies.names) for kind, load in loads.items()]
