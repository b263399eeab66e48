"""From a case to its models: the only place where they are built."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.coupling.solids import Solids
from parsim.domain.domain import Domain
from parsim.domain.grid import grid_of
from parsim.domain.shares import Shares
from parsim.particles.neighbours import Neighbours

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.domain.comm import Comm
    from parsim.machine.timers import Timers

_ROOM = 1.03  # length of the neighbour rows over that of the full lattice


class Models:
    """The models of one case, as attributes: scheme, solids, domain, near; reach, m, of the neighbour lists."""

    def __init__(self, case: Case, comm: Comm, timers: Timers) -> None:
        self.reach = case.reach
        self.scheme = case.water.scheme.scheme(case, timers)
        shares = Shares(comm) if comm.size > 1 else None
        self.solids = Solids(case, case.layers, self.scheme.lattice, timers, shares)
        self.domain = Domain(grid_of(case), comm, self.solids.sources, case.water.scheme.fields, timers)
        share = (case.reach / self.scheme.lattice.radius) ** case.dimensions
        self.near = Neighbours(self.scheme.lattice.count * share * _ROOM)
