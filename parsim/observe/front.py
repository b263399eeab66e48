"""How far the water has come."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.machine.jit import kernel
from parsim.observe.observer import columns
from parsim.particles.state import DETACHED

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Front:
    """One row: the first place beyond which there is no connected water."""

    name = "front"
    columns = columns(x="m")

    def __init__(self, case: Case) -> None:
        self._low, self._high, self._spacing = case.box.min[0], case.box.max[0], case.spacing

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        p, width = s.domain.particles, 2.0 * self._spacing
        count = int((self._high - self._low) / width) + 1
        filled, farthest = np.zeros(count), np.full(count, -np.inf)
        wet_columns(s.near.fluid, p.surface, p.x, self._low, width, filled, farthest)
        both = s.domain.max(*filled, *farthest)
        return [[float(front(both[:count], both[count:], self._spacing))]]


@kernel
def wet_columns(at, surface, x, low, width, filled, farthest):
    """Mark the columns of `width`, m, that hold connected water, and its largest x in each."""
    for i in at:
        if surface[i] < DETACHED:
            k = min(max(int((x[i] - low) / width), 0), filled.size - 1)
            filled[k] = 1.0
            farthest[k] = max(farthest[k], x[i])


def front(filled: np.ndarray, farthest: np.ndarray, spacing: float) -> float:
    """Place of the first column without connected water downstream of the first with some, m: the last water before."""
    wet = np.flatnonzero(filled)
    if not wet.size:
        return np.nan
    gap = np.flatnonzero(filled[wet[0] :] == 0)
    last = wet[0] + gap[0] - 1 if gap.size else filled.size - 1
    return farthest[last] + 0.5 * spacing
