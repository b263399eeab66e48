"""Velocity of the water along plumb lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.case.scales import scales
from parsim.geometry.faces import period, to_nearest_image
from parsim.observe.observer import columns
from parsim.observe.sensors import Line

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Velocities:
    """A row for each spacing of height on each line where there is water: its mean velocity there."""

    name = "velocities"
    columns = columns(line="-", z="m", u="m/s", v="m/s", w="m/s", particles="-")

    def __init__(self, case: Case) -> None:
        self._lines = [sensor for sensor in case.output.sensors if isinstance(sensor, Line)]
        self._middle = 0.5 * (case.box.min[1] + case.box.max[1])
        self._low, self._spacing, self._flat = case.box.min[2], case.spacing, case.dimensions == 2
        self._count = max(int(np.ceil((case.box.max[2] - case.box.min[2]) / case.spacing)), 1)
        scale, self._period = scales(case), period(case)
        self._units = np.array([*(scale.length / scale.time,) * 3, 1.0])

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        if not self._lines:
            return []
        p, at, values, index = s.domain.particles, s.near.fluid, [np.zeros((0, 4))], [np.zeros(0, np.int64)]
        for k, line in enumerate(self._lines):
            y = self._middle if line.y is None else line.y
            level = np.floor((p.z[at] - self._low) / self._spacing).astype(np.int64)
            near = (self._away(p.x[at] - line.x, 0) < 0.5 * line.width) & (level >= 0) & (level < self._count)
            if not self._flat:
                near &= self._away(p.y[at] - y, 1) < 0.5 * line.width
            here, row = at[near], level[near]
            values.append(np.stack([p.u[here], p.v[here], p.w[here], np.ones(here.size)], axis=1))
            index.append(row + k * self._count)
        count = len(self._lines) * self._count
        total = s.domain.sum(np.concatenate(values), self._units, np.concatenate(index), count)
        rows = []
        for at_row in np.flatnonzero(total[:, 3] > 0.0).tolist():
            number, level = divmod(at_row, self._count)
            *sums, particles = total[at_row].tolist()
            z = self._low + (level + 0.5) * self._spacing
            rows.append([self._lines[number].name, z, *(value / particles for value in sums), int(particles)])
        return rows

    def _away(self, d, axis):
        return np.abs(to_nearest_image(d, float(self._period[axis])))
