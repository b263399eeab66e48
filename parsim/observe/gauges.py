"""Water levels at given places."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.geometry.faces import images
from parsim.machine.jit import kernel
from parsim.observe.observer import columns
from parsim.observe.sensors import Gauge
from parsim.particles.state import DETACHED

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Gauges:
    """One row for each gauge: the highest connected water near it."""

    name = "gauges"
    columns = columns(gauge="-", x="m", y="m", level="m")

    def __init__(self, case: Case) -> None:
        middle = 0.5 * (case.box.min[1] + case.box.max[1])
        gauges = [sensor for sensor in case.output.sensors if isinstance(sensor, Gauge)]
        self._names = [gauge.name for gauge in gauges]
        places = [[gauge.x, middle if gauge.y is None else gauge.y] for gauge in gauges]
        self._places, self._spacing = np.array(places).reshape(-1, 2), case.spacing
        self._reach, self._flat = Gauge.REACH * case.spacing, case.dimensions == 2
        self._images, self._of = images(case, self._places, np.full(len(places), self._reach))

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        if not self._names:
            return []
        p, top, found = s.domain.particles, np.full(len(self._names), -np.inf), np.full(len(self._of), -np.inf)
        levels(s.near.fluid, p.surface, p.place, self._images, self._reach, self._flat, found)
        np.maximum.at(top, self._of, found)
        top = s.domain.max(*top)
        level = np.where(np.isfinite(top), top + 0.5 * self._spacing, np.nan)
        return [
            [name, float(x), float(y), float(z)]
            for name, (x, y), z in zip(self._names, self._places, level, strict=True)
        ]


@kernel
def levels(at, surface, place, gauges, reach, flat, out):
    """Highest connected particle within `reach`, m, of each gauge (k, 2) into out (k,); `flat` ignores y."""
    x, y, z = place
    for k in range(gauges.shape[0]):
        for i in at:
            if surface[i] < DETACHED:
                dx, dy = x[i] - gauges[k, 0], y[i] - gauges[k, 1]
                if dx * dx + (0.0 if flat else dy * dy) < reach * reach:
                    out[k] = max(out[k], z[i])
