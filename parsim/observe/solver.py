"""What the pressure equation of an implicit scheme has cost."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Solver:
    """One row: iterations of the last step and the residual that is left, over the right-hand side."""

    name = "solver"
    columns = columns(iterations="-", residual="-")

    def __init__(self, case: Case) -> None:
        pass

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`; none where the scheme solves nothing."""
        solver = getattr(s.scheme, "solver", None)
        return [[solver.iterations, solver.residual]] if solver and s.step_count > 0 else []
