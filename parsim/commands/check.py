"""What the command `check` says of a case, or of all runs of a table."""

from collections.abc import Iterable
from pathlib import Path

from parsim.case import ice
from parsim.case import runs_table as tables
from parsim.case.estimate import brief, lines
from parsim.case.file import read
from parsim.case.load import load
from parsim.commands.trial import told, tried
from parsim.errors import InputError


def _check_ranks(case, ranks):
    from parsim.domain.grid import check_ranks  # brings numba along, whose settings a run makes first

    check_ranks(case, ranks)


def _study(path, ranks):
    """A line about the study that a case file holds, if it holds one."""
    if "study" not in read(path):
        return []
    from parsim.study.study import checked  # brings numba along too

    study, plans = checked(path, ranks)
    rows = f"{len(plans)} row{'s' if len(plans) > 1 else ''}"
    each = "a search" if study.bisection else f"{study.repeats} run{'s at most' if study.repeats > 1 else ''}"
    return [f"study      {rows} with {each} in each, for `parsim study`"]


def check_cases(
    path: Path | str,
    changes: Iterable[str] | None,
    until: float | None,
    ranks: int,
    table: Path | str | None = None,
    trial: float | None = None,
) -> None:
    """Print what a case will cost on `ranks` ranks; with a `table` (CSV file) that of each row.

    `trial`, s: run it so long, on these ranks of this machine, and print what the whole would take at that pace. Raises
    InputError, also where it can't be tried.
    """
    if table and trial:
        raise InputError("--trial: tries one case; leave --table out")
    if table:
        _every_row(path, changes, until, ranks, table)
        return
    case = load(path, changes, until)
    _check_ranks(case, ranks)
    study = _study(Path(path), ranks)
    print(f"{path}: a valid case", *lines(case, ranks), *ice.told(case), *study, sep="\n")
    if trial:
        print(f"trial      {told(case, tried(path, changes, until, ranks, trial), ranks)}")
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
