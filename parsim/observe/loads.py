"""What acts on the bodies, by kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.case.scales import scales
from parsim.coupling.response import levers
from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation

KINDS = ("water", "contact", "gravity", "joint")
FRICTION = "water_friction"  # what of "water" is friction


class Loads:
    """One row for each body and kind of load: the mean of the last step."""

    name = "loads"
    columns = columns(body="-", kind="-", fx="N", fy="N", fz="N", tx="N m", ty="N m", tz="N m")

    def __init__(self, case: Case) -> None:
        self._rubs, scale = case.water.friction is not None, scales(case)
        self._units = np.repeat([scale.force, scale.force * scale.length], 3)

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        loads = {kind: s.bodies.shown(f"{kind}_load") for kind in KINDS}
        if self._rubs:
            loads[FRICTION] = self._friction(s)
        return [
            [name, kind, *map(float, load[k])] for k, name in enumerate(s.bodies.names) for kind, load in loads.items()
        ]

    def _friction(self, s):
        """Force and torque of the friction of the water on each body: (bodies, 6), N, N m."""
        p, at = s.domain.particles, s.near.body
        each = np.empty((at.size, 6))
        arms = s.solids.samples.arms(p, at, s.bodies.position)
        levers(arms, s.scheme.rubbed(s.flow(), s.solids, at), each)
        total = s.domain.sum(each, self._units, p.body[at].astype(np.int64), len(s.bodies))
        total[s.bodies.gone] = np.nan
        return total
