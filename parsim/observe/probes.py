"""Pressure of the water at points, of walls and of bodies that move too."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.case.scales import scales
from parsim.fluid.weights.choice import weight_at
from parsim.geometry.faces import period
from parsim.geometry.rotation import matrices
from parsim.machine.jit import kernel
from parsim.observe.filters import Filters
from parsim.observe.observer import columns
from parsim.observe.sensors import Probe
from parsim.particles.state import DETACHED
from parsim.solid.bodies import from_case

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation

_DRY = 0.05  # of the weight of a full support, below which a point is dry


class Probes:
    """One row for each probe: the mean of the water in the support, by the measure of concentration, each particle's
    brought to the depth of the point. At this instant, or by its filter; zero where it is dry."""

    name = "pressures"
    columns = columns(probe="-", filter="-", x="m", y="m", z="m", pressure="Pa")

    def __init__(self, case: Case) -> None:
        middle = 0.5 * (case.box.min[1] + case.box.max[1])
        probes = [sensor for sensor in case.output.sensors if isinstance(sensor, Probe)]
        self._names, names = [probe.name for probe in probes], [body.name for body in case.bodies]
        self._filters, self._density = Filters(probes), case.water.density
        self._places = np.array([[p.x, middle if p.y is None else p.y, p.z] for p in probes]).reshape(-1, 3)
        self._body = np.array([-1 if p.body is None else names.index(p.body) for p in probes], int)
        self._arms = np.zeros((len(probes), 3))
        if (self._body >= 0).any():
            bodies = from_case(case)  # at the start, whenever a run goes on
            turn = matrices(bodies.quaternion)
            for k in np.flatnonzero(self._body >= 0):
                b = self._body[k]
                self._arms[k] = (self._places[k] - bodies.position[b]) @ turn[b]
        self._period, self._unit = period(case), scales(case).pressure(case.dimensions)

    def see(self, s: Simulation) -> None:
        """See `Follower`."""
        if self._filters.which and s.step_count > 0:
            _, pressure = self._read(s, self._filters.which)
            self._filters.see(s.dt, pressure[:, None])

    def kept(self) -> dict[str, Any]:
        """See `Follower`."""
        return self._filters.kept()

    def restore(self, kept: dict[str, Any]) -> None:
        """See `Follower`."""
        self._filters.restore(kept)

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        if not self._names:
            return []
        places, pressure = self._read(s, list(range(len(self._names))))
        if s.step_count > 0:
            pressure = self._filters.applied(pressure[:, None])[:, 0]
        return [
            [name, told, *map(float, place), float(value)]
            for name, told, place, value in zip(self._names, self._filters.names, places, pressure, strict=True)
        ]

    def _read(self, s, which):
        """Places (k, 3), m, and pressures (k,), Pa, of the probes of these numbers at this instant."""
        p, lattice, places, body = s.domain.particles, s.scheme.lattice, self._places[which], self._body[which]
        turn = matrices(s.bodies.quaternion)
        for k in np.flatnonzero(body >= 0):
            places[k] = s.bodies.position[body[k]] + turn[body[k]] @ self._arms[which[k]]
        if s.step_count == 0:  # there are no pressures yet
            return places, np.full(len(places), np.nan)
        # nothing rises along an axis that repeats
        head = np.where(np.isinf(self._period), self._density * np.array(s.solids.pull.at(s.time)), 0.0)
        found = np.empty((len(places) * 64, 3))
        seen = lattice.weight, lattice.radius, self._period
        while True:
            count = pressures(s.near.fluid, p.place, (p.p, p.surface), places, seen, head, found)
            if count <= len(found):
                break
            found = np.empty((2 * count, 3))
        row, values, units = found[:count, 0].astype(np.int64), found[:count, 1:], np.array([self._unit, 1.0])
        total = s.domain.sum(values, units, row, len(places))
        wet = total[:, 1] > _DRY * lattice.whole
        pressure = np.where(wet, total[:, 0] / np.where(wet, total[:, 1], 1.0), 0.0)
        gone = (body >= 0) & s.bodies.gone[body] if len(s.bodies) else np.zeros(len(places), bool)
        pressure[gone], places[gone] = np.nan, np.nan
        return places, pressure


@kernel
def nearest(d, period):
    """The distance d, m, along an axis to the nearest image."""
    return d - period * np.rint(d / period) if period < np.inf else d


@kernel
def pressures(at, place, water, probes, seen, head, out):
    """Rows of probe, m p and m of the water `at` around each probe (k, 3): their number; out (n, 3).

    `water`: p, Pa, surface; `seen`: weight, its radius, period (3,), m; `head` (3,): rise of the pressure of water at
    rest, Pa/m. Rows beyond `out` are counted only.
    """
    (x, y, z), (p, surface), (weight, radius, period) = place, water, seen
    count = 0
    for k in range(len(probes)):
        for i in at:
            dx, dy = nearest(probes[k, 0] - x[i], period[0]), nearest(probes[k, 1] - y[i], period[1])
            dz = nearest(probes[k, 2] - z[i], period[2])
            r2 = max(dx * dx + dy * dy + dz * dz, 1e-12 * radius * radius)
            if surface[i] >= DETACHED or r2 >= radius * radius:
                continue
            if count < len(out):
                _, _, measure = weight_at(weight, r2, 1.0 / math.sqrt(r2))
                out[count, 0], out[count, 2] = k, measure
                out[count, 1] = measure * (p[i] + head[0] * dx + head[1] * dy + head[2] * dz)
            count += 1
    return count
