"""Water levels along lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.case.scales import scales
from parsim.geometry.faces import images
from parsim.observe.observer import columns
from parsim.observe.sensors import Gauge, Levelling
from parsim.particles.state import DETACHED

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Levels:
    """One row for each point of each line: the top of the highest connected water near it, as a gauge has it, and the
    piezometric level there, the mean of z + p / (rho g) of that water. Both are nan where it is dry."""

    name = "levels"
    columns = columns(line="-", distance="m", x="m", y="m", level="m", piezometric="m")

    def __init__(self, case: Case) -> None:
        lines = [sensor for sensor in case.output.sensors if isinstance(sensor, Levelling)]
        self._names = [line.name for line in lines for _ in range(line.points)]
        shares = [np.linspace(0.0, 1.0, line.points)[:, None] for line in lines]
        ends = [(np.array(line.start), np.array(line.end)) for line in lines]
        parts = [begin + share * (end - begin) for (begin, end), share in zip(ends, shares, strict=True)]
        far = [share[:, 0] * np.hypot(*(end - begin)) for (begin, end), share in zip(ends, shares, strict=True)]
        self._places = np.concatenate([np.zeros((0, 2)), *parts])
        self._distance = np.concatenate([np.zeros(0), *far])
        self._spacing, self._reach, self._flat = case.spacing, Gauge.REACH * case.spacing, case.dimensions == 2
        self._images, self._of = images(case, self._places, np.full(len(self._places), self._reach))
        self._head, self._unit = case.water.density * -case.gravity[2], scales(case).length

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        if not self._names:
            return []
        p, count = s.domain.particles, len(self._names)
        top, values, index = np.full(count, -np.inf), [np.zeros((0, 2))], [np.zeros(0, np.int64)]
        wet = s.near.fluid[p.surface[s.near.fluid] < DETACHED]
        wet = wet[np.argsort(p.x[wet], kind="stable")]
        along = p.x[wet]
        for k, (x, y) in zip(self._of.tolist(), self._images, strict=True):
            first, last = np.searchsorted(along, (x - self._reach, x + self._reach))
            here = wet[first:last]
            across = 0.0 if self._flat else p.y[here] - y
            here = here[(p.x[here] - x) ** 2 + across**2 < self._reach**2]
            top[k] = max(top[k], p.z[here].max(initial=-np.inf))
            values.append(np.stack([p.z[here] + p.p[here] / self._head, np.ones(here.size)], axis=1))
            index.append(np.full(here.size, k))
        top = np.array(s.domain.max(*top))
        total, number = s.domain.sum(
            np.concatenate(values), np.array([self._unit, 1.0]), np.concatenate(index), count
        ).T
        there = (number > 0.0) & (s.step_count > 0)  # at the start there are no pressures yet
        head = np.where(there, total / np.where(there, number, 1.0), np.nan)
        level = np.where(np.isfinite(top), top + 0.5 * self._spacing, np.nan)
        every = zip(self._names, self._distance, *self._places.T, level, head, strict=True)
        return [[name, *map(float, row)] for name, *row in every]
