"""What is measured of a run while it runs: what exists is listed here, in the order of its tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from parsim.observe.bodies import Bodies
from parsim.observe.channel import Channel
from parsim.observe.counts import Counts
from parsim.observe.energy import Energy
from parsim.observe.fluxes import Fluxes
from parsim.observe.forces import Forces
from parsim.observe.front import Front
from parsim.observe.gauges import Gauges
from parsim.observe.ice import Ice
from parsim.observe.levels import Levels
from parsim.observe.loads import Loads
from parsim.observe.lost import Lost
from parsim.observe.observer import table
from parsim.observe.openings import Openings
from parsim.observe.peaks import Peaks
from parsim.observe.probes import Probes
from parsim.observe.solver import Solver
from parsim.observe.velocities import Velocities

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation

# what is seen at a time; what has left is told at once
OBSERVERS = (
    Energy, Counts, Bodies, Loads, Gauges, Levels, Front, Probes, Forces, Fluxes, Velocities, Channel, Openings, Ice,
    Peaks, Solver,
)  # fmt: skip
# unit of every column of every series, by names
TABLES = {observer.name: table(observer) for observer in (*OBSERVERS, Lost)}


def rows_now(case: Case, simulation: Simulation) -> dict[str, dict[str, list[Any]]]:
    """What every observer says of a simulation as it is: {name: {column: list of values}}."""
    found = {}
    for observer in OBSERVERS:
        rows = observer(case).rows(simulation)
        names = [column.name for column in observer.columns]
        found[observer.name] = dict(zip(names, map(list, zip(*rows, strict=True)), strict=True)) if rows else {}
    return found
