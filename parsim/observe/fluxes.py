"""What flows through planes across the box."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.case.scales import scales
from parsim.geometry.faces import period, to_nearest_image
from parsim.observe.observer import columns
from parsim.observe.sensors import Section

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Fluxes:
    """One row for each plane: discharge, wetted area, mean velocity and flux of momentum, by a hat of six spacings."""

    name = "fluxes"
    columns = columns(section="-", x="m", discharge="m3/s", area="m2", velocity="m/s", momentum="N")

    def __init__(self, case: Case) -> None:
        self._sections = [sensor for sensor in case.output.sensors if isinstance(sensor, Section)]
        self._width, self._density, scale = Section.WIDTH * case.spacing, case.water.density, scales(case)
        self._period = float(period(case)[0])
        self._inside = [self._share(case, section.x) for section in self._sections]
        volume, speed = scale.mass / case.water.density, scale.length / scale.time
        self._units = np.array([volume, volume * speed, volume * speed * speed]) / scale.length

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        if not self._sections:
            return []
        p, at, values, index = s.domain.particles, s.near.fluid, [np.zeros((0, 3))], [np.zeros(0, np.int64)]
        for k, section in enumerate(self._sections):
            away = np.abs(to_nearest_image(p.x[at] - section.x, self._period))
            here, away = at[away < self._width], away[away < self._width]
            share = s.scheme.lattice.volume / s.scheme.compression(p, here) / self._width
            share *= (1.0 - away / self._width) / self._inside[k]
            u = p.u[here]
            values.append(np.stack([share, share * u, share * u * u], axis=1))
            index.append(np.full(here.size, k))
        total = s.domain.sum(np.concatenate(values), self._units, np.concatenate(index), len(self._sections))
        rows: list[list[Any]] = []
        for section, (area, discharge, momentum) in zip(self._sections, total.tolist(), strict=True):
            speed = discharge / area if area > 0.0 else 0.0
            rows.append([section.name, float(section.x), discharge, area, speed, self._density * momentum])
        return rows

    def _share(self, case, x):
        """The part of the hat that is in the box; at an outlet or an open side the water goes on beyond it."""
        if np.isfinite(self._period):
            return 1.0
        sides = (case.box.faces.x_min, case.box.min[0]), (case.box.faces.x_max, case.box.max[0])
        ends = (level for side, level in sides if side.kind not in ("outlet", "open"))
        cut = (max(1.0 - abs(level - x) / self._width, 0.0) for level in ends)
        return 1.0 - sum(0.5 * each * each for each in cut)
