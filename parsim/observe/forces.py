"""Forces of the water on parts of walls, and what of those on bodies is friction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.case.scales import scales
from parsim.geometry.faces import names_of_walls, planes_of_walls
from parsim.observe.filters import Filters
from parsim.observe.observer import columns
from parsim.observe.sensors import Patch
from parsim.particles.state import WALL

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation

KINDS = "pressure", "friction"


class Forces:
    """Two rows for each patch: pressure, by the samples of the first layer behind the wall, and friction."""

    name = "forces"
    columns = columns(patch="-", filter="-", kind="-", fx="N", fy="N", fz="N")

    def __init__(self, case: Case) -> None:
        self._patches = [sensor for sensor in case.output.sensors if isinstance(sensor, Patch)]
        self._planes = dict(zip(names_of_walls(case), planes_of_walls(case), strict=True))
        self._unit, self._spacing = scales(case).force, case.spacing
        self._used, self._box = np.isin(range(3), case.axes), (np.array(case.box.min), np.array(case.box.max))
        self._density, self._filters = case.water.density, Filters(self._patches)
        self._area = case.spacing ** (case.dimensions - 1)

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        if not self._patches:
            return []
        force = self._read(s, self._patches)
        if s.step_count > 0:
            force = self._filters.applied(force)
        return [
            [patch.name, told, kind, *row[3 * k : 3 * k + 3]]
            for patch, told, row in zip(self._patches, self._filters.names, force.tolist(), strict=True)
            for k, kind in enumerate(KINDS)
        ]

    def see(self, s: Simulation) -> None:
        """See `Follower`."""
        if self._filters.which and s.step_count > 0:
            self._filters.see(s.dt, self._read(s, [self._patches[k] for k in self._filters.which]))

    def kept(self) -> dict[str, Any]:
        """See `Follower`."""
        return self._filters.kept()

    def restore(self, kept: dict[str, Any]) -> None:
        """See `Follower`."""
        self._filters.restore(kept)

    def _read(self, s, patches):
        """Forces, N, on patches at this instant: of pressure, then of friction, (k, 6)."""
        if s.step_count == 0:  # there are no pressures yet
            return np.full((len(patches), 6), np.nan)
        head, p = self._density * np.array(s.solids.pull.at(s.time)), s.domain.particles
        at = s.near.boundary[p.kind[s.near.boundary] == WALL]
        place = np.stack([p.x[at], p.y[at], p.z[at]], axis=1)
        rubbed = s.scheme.rubbed(s.flow(), s.solids, at)
        values, index = [np.zeros((0, 3))], [np.zeros(0, np.int64)]
        for k, patch in enumerate(patches):
            behind, share = self._behind(place, patch)
            within, inward = share > 0.0, self._planes[patch.wall][:3]
            first = within & (behind < self._spacing)
            pressure = np.maximum(p.p[at[first]] + head @ inward * behind[first], 0.0)  # at the wall itself
            pressure *= share[first]
            values += [-pressure[:, None] * inward * self._area, share[within, None] * rubbed[within]]
            index += [np.full(first.sum(), 2 * k), np.full(within.sum(), 2 * k + 1)]
        total = s.domain.sum(np.concatenate(values), self._unit, np.concatenate(index), 2 * len(patches))
        return total.reshape(-1, 6)

    def _behind(self, place, patch):
        """How far places (n, 3) lie behind the wall of a patch, m, and what share of them is right behind it."""
        plane = self._planes[patch.wall]
        behind = plane[3] - place @ plane[:3]
        along = (np.abs(plane[:3]) == 0.0) & self._used
        low, high = self._box  # beside inlet and outlet walls go on beyond it
        low = low if patch.min is None else np.maximum(low, patch.min)
        high = high if patch.max is None else np.minimum(high, patch.max)
        half = 0.5 * self._spacing
        inside = np.minimum(high, place + half) - np.maximum(low, place - half)
        share = np.where(along, np.clip(np.round(inside / self._spacing, 9), 0.0, 1.0), 1.0).prod(axis=1)
        for name, other in self._planes.items():
            if name != patch.wall:
                share = np.where(place @ other[:3] > other[3], share, 0.0)
        return behind, np.where(behind > 0.0, share, 0.0)
