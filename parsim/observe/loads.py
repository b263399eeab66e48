"""What acts on the bodies, by kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation

KINDS = ("water", "contact", "gravity", "joint")


class Loads:
    """One row for each body and kind of load: the mean of the last step."""

    name = "loads"
    columns = columns(body="-", kind="-", fx="N", fy="N", fz="N", tx="N m", ty="N m", tz="N m")

    def __init__(self, case: Case) -> None:
        pass

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        loads = {kind: s.bodies.shown(f"{kind}_load") for kind in KINDS}
        return [
            [name, kind, *map(float, load[k])] for k, name in enumerate(s.bodies.names) for kind, load in loads.items()
        ]
