"""What the command `check` says of a case, or of all runs of a table."""

from collections.abc import Iterable
from pathlib import Path

from parsim.case import ice
from parsim.case import runs_table as tables
from parsim.case.estimate import brief, lines
from parsim.case.load import load
from parsim.errors import InputError


def _check_ranks(case, ranks):
    from parsim.domain.grid import check_ranks  # brings numba along, whose settings a run makes first

    check_ranks(case, ranks)


def check_cases(
    path: Path | str, changes: Iterable[str] | None, until: float | None, ranks: int, table: Path | str | None = None
) -> None:
    """Print what a case will cost on `ranks` ranks; with a `table` (CSV file) that of each row. Raises InputError."""
    if table:
        _every_row(path, changes, until, ranks, table)
        return
    case = load(path, changes, until)
    _check_ranks(case, ranks)
    print(f"{path}: a valid case", *lines(case, ranks), *ice.told(case), sep="\n")
    for warning in case.warnings():
        print(f"warning: {warning}")


def _every_row(path, changes, until, ranks, table):
    messages, told = [], []
    for number, row in enumerate(tables.rows(table), 1):
        try:
            case = load(path, changes, until, table, number)
            _check_ranks(case, ranks)
            told.append(f"row {number:<4} {brief(case, ranks)}; {', '.join(row)}")
        except InputError as error:
            messages += error.messages
    if messages:
        raise InputError(messages)
    print(f"{path} with {table}: every row is a valid case, for --array=1-{len(told)}", *told, sep="\n")
