"""A command again, as the ranks of an MPI job."""

import sys
from collections.abc import Iterable
from pathlib import Path

from parsim.case.model import Case
from parsim.errors import InputError
from parsim.launch import mpirun, stop


def changed(changes: Iterable[str] | None, table: Path | None, row: int | None) -> list[object]:
    """The options that say how a case is changed, for the ranks."""
    words: list[object] = [word for change in changes or () for word in ("--set", change)]
    return words + (["--table", table, "--row", row] if table else [])


def launched(
    ranks: int, words: list[object], until: float | None, kernel: str | None, limit: float | None, case: Case | None
) -> int:
    """Exit code of `parsim` with these words as so many ranks; `limit`, s: the walltime. Raises InputError.

    A `case` that is known is refused before they start, where it has no room for them.
    """
    if case is not None:
        from parsim.domain.grid import check_ranks  # brings numba along, whose settings a run makes first

        check_ranks(case, ranks)
    if mpirun.world()[1] > 1:
        raise InputError(f"-n {ranks}: {mpirun.world()[1]} processes of this command are running already; leave -n out")
    words += ["--until", repr(until)] if until is not None else []
    words += ["--kernel", kernel] if kernel is not None else []
    if limit is not None:  # that of the ranks began when this process did
        left = max(round(limit - stop.age()), 1)
        words += ["--walltime", f"{left // 60}:{left % 60:02d}"]
    return mpirun.mpirun(ranks, [sys.executable, "-P", "-m", "parsim", *map(str, words)], stop.early)
