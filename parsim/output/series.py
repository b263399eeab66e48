"""Series as CSV tables: one comment line with the units, one line of names, then rows with exact numbers."""

import csv
import io
import itertools
import math
import os
from collections.abc import Mapping
from pathlib import Path

from parsim.errors import WriteError
from parsim.output.frames import write_text


class Table:
    """A CSV file that grows row by row; rows wait in memory until :meth:`flush`.

    Floats are written in the shortest form that reads back to the same bits. ``units`` is the unit of each column by
    name, in the columns' order, "step" first.
    With ``resume`` (a step) an existing file is continued: its rows after that step are dropped first, so that a
    resumed run leaves the file that an uninterrupted one would. All methods raise WriteError.
    """

    def __init__(self, path: Path | str, units: Mapping[str, str], resume: int | None = None) -> None:
        self.path, self.columns = Path(path), list(units)
        self._waiting = io.StringIO()
        self._writer = csv.writer(self._waiting, lineterminator="\n")
        kept = _rows_until(self.path, resume) if resume is not None else []
        titles = ["# units: " + ", ".join(units.values()), ",".join(units)]
        write_text(self.path, "\n".join([*titles, *kept]) + "\n")
        self._file = self._guarded(lambda: open(self.path, "a", encoding="utf-8"))

    def row(self, *values: object) -> None:
        """Add one row, values in the order of the columns."""
        if len(values) != len(self.columns):
            raise ValueError(f"{self.path.name}: {len(values)} values for {len(self.columns)} columns")
        self._writer.writerow(values)

    def flush(self) -> None:
        """Write the waiting rows."""
        self._guarded(lambda: (self._file.write(self._waiting.getvalue()), self._file.flush()))
        self._waiting.seek(0)
        self._waiting.truncate()

    def secure(self) -> None:
        """Write the waiting rows and see them on the disk."""
        self.flush()
        self._guarded(lambda: os.fsync(self._file.fileno()))

    def close(self) -> None:
        """Write the waiting rows and close the file."""
        self.flush()
        self._guarded(self._file.close)

    def _guarded(self, action):
        try:
            return action()
        except OSError as error:
            raise WriteError(self.path, error.strerror or error) from error


def next_multiple(time: float, every: float) -> float:
    """The next multiple of `every` after `time`, s; t = 0 is never passed over."""
    due = (math.floor(time / every + 1e-9) + 1.0) * every
    return due if time >= 0 else min(due, 0.0)


def _rows_until(path, step):
    """The complete rows of an earlier table up to and with ``step``."""
    if not path.exists():
        return []
    lines = path.read_text(encoding="utf-8", errors="replace").split("\n")[2:-1]
    numbers = (line.partition(",")[0] for line in lines)
    # a machine that lost its power may have left anything after the rows that a checkpoint has seen on the disk
    kept = itertools.takewhile(lambda number: number.isdecimal() and int(number) <= step, numbers)
    return lines[: len(list(kept))]
