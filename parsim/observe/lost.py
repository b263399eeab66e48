"""What has left the box."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Lost:
    """One row for each particle or body that has left since it was last told of, on rank 0; told at once.

    Unlike those of others its rows begin with a step and a time of their own.
    """

    name = "lost"
    columns = columns(what="-", id="-", x="m", y="m", z="m", u="m/s", v="m/s", w="m/s")

    def __init__(self, case: Case) -> None:
        pass

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        return [
            [int(step), float(time), what, int(ident), *map(float, rest)] for step, time, what, ident, *rest in s.gone
        ]
