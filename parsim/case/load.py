"""A case as a command line has it: a file, a row of a table, changes, another end."""

from parsim.case import model
from parsim.case import runs_table as tables
from parsim.errors import InputError


def load(path, changes=(), until=None, table=None, row=None):
    """The case in a file, changed by a row of a table (CSV), then by "key=value" texts, then to another end, s.

    Raises InputError.
    """
    if (table is None) != (row is None):
        raise InputError("--table TABLE and --row N belong together")
    end = [] if until is None else [f"run.until={until!r}"]
    cells = tables.row(table, row) if table else []
    try:
        return model.load(path, [*cells, *(changes or ()), *end])
    except InputError as error:
        place = f"{table}: row {row}: " if table else ""
        raise InputError([place + message for message in error.messages]) from None
