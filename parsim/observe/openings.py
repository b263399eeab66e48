"""What has come in and gone out through inlet and outlet, in particles and as a discharge."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Openings:
    """One row: particles let in, let out, inside now; balance: those inside, less in, plus out and lost.

    The balance is what was there at the start, always. discharge_in is what is asked for, discharge_out the running
    mean within half a depth of the outlet; clipped: share of the water beyond the outlet kept from coming back.
    """

    name = "openings"
    columns = columns(
        let_in="-",
        let_out="-",
        inside="-",
        balance="-",
        level_in="m",
        discharge_in="m3/s",
        level_out="m",
        discharge_out="m3/s",
        clipped="-",
    )

    def __init__(self, case: Case) -> None:
        pass

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`. Water that waits to be let in or out at the next rebuild is counted as it was."""
        openings = s.solids.openings
        if not openings:
            return []
        inside, lost = s.domain.count(s.near.fluid.size, s.domain.lost)
        inlet, outlet = openings.inlet, openings.outlet
        came, left = inlet.emitted if inlet else 0, outlet.removed if outlet else 0
        row: list[Any] = [came, left, inside, inside - came + left + lost]
        row += [inlet.level, inlet.discharge] if inlet else [math.nan, 0.0]
        row += [outlet.level, outlet.discharge] if outlet else [math.nan, 0.0]
        return [[*row, openings.clipped]]
