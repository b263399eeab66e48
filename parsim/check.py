"""What the command `check` says of a case, or of all runs of a table."""

from parsim import case as cases
from parsim import case_table
from parsim.errors import InputError
from parsim.estimate import brief, lines


def load(path, changes=(), until=None, table=None, row=None):
    """The case in a file, changed by a row of a table (CSV), then by "key=value" texts, then to another end, s.

    Raises InputError.
    """
    if (table is None) != (row is None):
        raise InputError("--table TABLE and --row N belong together")
    end = [] if until is None else [f"run.until={until!r}"]
    cells = case_table.row(table, row) if table else []
    try:
        return cases.load(path, [*cells, *(changes or ()), *end])
    except InputError as error:
        place = f"{table}: row {row}: " if table else ""
        raise InputError([place + message for message in error.messages]) from None


def _check_ranks(case, ranks):
    from parsim.setup import check_ranks  # brings numba along, whose settings a run makes first

    check_ranks(case, ranks)


def main(path, changes, until, ranks, table=None):
    """Print what a case will cost on `ranks` ranks; with a `table` (CSV file) that of each row. Raises InputError."""
    if table:
        _every_row(path, changes, until, ranks, table)
        return
    case = load(path, changes, until)
    _check_ranks(case, ranks)
    print(f"{path}: a valid case", *lines(case, ranks), sep="\n")
    for warning in case.warnings():
        print(f"warning: {warning}")


def _every_row(path, changes, until, ranks, table):
    messages, told = [], []
    for number, row in enumerate(case_table.rows(table), 1):
        try:
            case = load(path, changes, until, table, number)
            _check_ranks(case, ranks)
            told.append(f"row {number:<4} {brief(case, ranks)}; {', '.join(row)}")
        except InputError as error:
            messages += error.messages
    if messages:
        raise InputError(messages)
    print(f"{path} with {table}: every row is a valid case, for --array=1-{len(told)}", *told, sep="\n")
