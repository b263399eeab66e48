"""What the command `check` says of a case, or of all runs of a table."""

from parsim import case as cases
from parsim.case_table import rows
from parsim.errors import InputError
from parsim.estimate import brief, lines


def load(path, changes, until=None):
    """The case in a file with "key=value" texts put in, and another end, s. Raises InputError."""
    return cases.load(path, [*changes, *([] if until is None else [f"run.until={until!r}"])])


def main(path, changes, until, ranks, table=None):
    """Print what a case will cost on `ranks` ranks; with a `table` (CSV file) that of each row. Raises InputError."""
    changes = list(changes or ())
    if table:
        _every_row(path, changes, until, ranks, table)
        return
    case = load(path, changes, until)
    print(f"{path}: a valid case", *lines(case, ranks), sep="\n")
    for warning in case.warnings():
        print(f"warning: {warning}")


def _every_row(path, changes, until, ranks, table):
    messages, told, every = [], [], rows(table)
    for number, row in enumerate(every, 1):
        try:
            told.append(f"row {number:<4} {brief(load(path, [*changes, *row], until), ranks)}; {', '.join(row)}")
        except InputError as error:
            messages += [f"{table}: row {number}: {message}" for message in error.messages]
    if messages:
        raise InputError(messages)
    print(f"{path} with {table}: {len(every)} valid cases, for --array=1-{len(every)}", *told, sep="\n")
