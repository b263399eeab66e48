"""What bars and studies ask of the river in a run: what `measure` of its case tells, at its end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.errors import InputError, nearest, suggestion
from parsim.river import verdicts
from parsim.river.reader import river_of

if TYPE_CHECKING:
    from parsim.output.reader import Run
    from parsim.river.reader import River


def reach_mean(run: Run, name: str) -> float:
    """Mean of a quantity over the reach in the last window of a run, `name` in the table `reach`."""
    river, end = _ended(run)
    return _of(river.reach_means(end), name)


def reach_most(run: Run, name: str) -> float:
    """Largest value of a quantity along the reach in the last window of a run, `name` in the table `river`."""
    river, end = _ended(run)
    here = _of(river.along(end), name)[river.within]
    return float(np.nanmax(here)) if np.isfinite(here).any() else float("nan")


def jam_length(run: Run) -> float:
    """Length over which ice stands upstream of the control plane when a jam has formed, m; NaN without a jam."""
    river, _ = _ended(run)
    found = verdicts.verdict(river)
    return found.toe - found.head if found is not None else float("nan")


def measured(run: Run) -> River:
    """The river of a run. Raises InputError where its case has no table `measure`."""
    if run.case.get("measure") is None:
        raise InputError("the case has no table measure")
    return river_of(run)


def _ended(run):
    """The river of a run and the time of its last frame, s."""
    river = measured(run)
    if not len(river.fields.time):
        raise InputError("the run has no frames")
    return river, float(river.fields.time[-1])


def _of(table, name):
    if name not in table:
        raise InputError(
            f"name = {name!r}: there is no such one{suggestion(nearest(name, table))}; allowed: {', '.join(table)}"
        )
    return table[name]
