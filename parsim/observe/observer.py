"""What watches a run: an object with a name, columns and rows. One file each, listed in `observers`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation

CLOCK = {"step": "-", "time": "s"}  # the columns that begin every row


class Column(NamedTuple):
    """One column of a series: its name and its unit."""

    name: str
    unit: str


class Observer(Protocol):
    """Looks at a simulation and changes nothing: no order among observers."""

    name: str
    columns: tuple[Column, ...]

    def __init__(self, case: Case) -> None:
        """For one case."""

    def rows(self, simulation: Simulation) -> list[list[Any]]:
        """Rows, lists of values in the order of the columns; called on all ranks together."""


@runtime_checkable
class Follower(Observer, Protocol):
    """One that looks at every step, and so has something to keep between rows."""

    def see(self, simulation: Simulation) -> None:
        """After every step; called on all ranks together."""

    def kept(self) -> dict[str, Any]:
        """What a restart needs, as JSON has it; the same on all ranks."""

    def restore(self, kept: dict[str, Any]) -> None:
        """Go on from what `kept` returned."""


def columns(**units: str) -> tuple[Column, ...]:
    """Columns from their units by name."""
    return tuple(Column(name, unit) for name, unit in units.items())


def table(observer: type[Observer]) -> dict[str, str]:
    """Unit of every column of a series by name, those of the clock first."""
    return CLOCK | {column.name: column.unit for column in observer.columns}
