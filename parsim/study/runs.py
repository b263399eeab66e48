"""The runs of a study in its folder: OUT/runs.csv numbers them, OUT/run-1, OUT/run-2, ... are their output folders."""

from __future__ import annotations

import csv
import io
import tomllib
from dataclasses import dataclass
from pathlib import Path

from parsim.case import runs_table
from parsim.case.load import load
from parsim.case.model import Case
from parsim.errors import InputError
from parsim.output.frames import write_text
from parsim.output.lock import held
from parsim.output.reader import Run, is_output
from parsim.run.resume import changed_keys
from parsim.study.plan import Ended, Wanted
from parsim.study.table import Study, cells

TABLE = "runs.csv"
DONE, FAILED, RUNNING, STOPPED, WAITING = "done", "failed", "running", "stopped", "waiting"
NO_OUTCOME = "no outcome"  # done, but nothing follows of it


@dataclass
class Seen:
    """A run as it was last looked at: its number, 0 for one without; state; outcome, and in words what went wrong."""

    number: int
    state: str
    outcome: float | bool | None = None
    note: str = ""


class Runs:
    """All runs that the study in the case file `case` has in the folder `out`.

    A run is known by its changes of the case, so that its number stays when the study asks for more. With `retry`
    those that have failed count as not ended. Raises InputError where the folder is no study's.
    """

    def __init__(self, case: Path, study: Study, out: Path, retry: bool = False) -> None:
        self.case, self.out, self._study, self._retry = case, out, study, retry
        self._numbers: dict[tuple[str, ...], int] = {}
        self._seen: dict[int, Seen] = {}
        self._given_up: dict[int, str] = {}  # and why
        if is_output(out):
            raise InputError(f"OUT = {out}: is the output folder of one run; give the study a folder of its own")
        if study.table is not None and Path(study.table) == (out / TABLE).resolve():
            raise InputError(f"OUT = {out}: its {TABLE} is study.table, and would be replaced; choose another folder")
        if (out / TABLE).is_file():
            rows = runs_table.rows(out / TABLE)
            self._numbers = {tuple(sorted(row)): number for number, row in enumerate(rows, 1)}
        elif out.exists() and (not out.is_dir() or any(path.name != "lock" for path in out.iterdir())):
            raise InputError(f"OUT = {out}: already there and not a study's, without {TABLE}; choose another folder")

    def __len__(self) -> int:
        return len(self._numbers)

    def folder(self, number: int) -> Path:
        """The output folder of a run."""
        return self.out / f"run-{number}"

    def log(self, number: int) -> Path:
        """What a run has printed."""
        return self.out / f"run-{number}.log"

    def enter(self, wanted: list[Wanted]) -> list[int]:
        """The number of each run; those that have none get the next ones, and a row of the table. Raises WriteError."""
        new = [run.changes for run in wanted if _key(run) not in self._numbers]
        for changes in new:
            self._numbers.setdefault(tuple(sorted(changes)), len(self._numbers) + 1)
        if new:
            write_text(self.out / TABLE, self._written())
        return [self._numbers[_key(run)] for run in wanted]

    def _written(self):
        keys, rows = cells(self._numbers)
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows([keys, *rows])
        return text.getvalue()

    def ended(self, run: Wanted) -> Ended | None:
        """How a run has ended; None: it has not."""
        seen = self.seen(run)
        return Ended(seen.outcome) if seen.state in (DONE, FAILED) else None

    def known(self, run: Wanted) -> Ended | None:
        """The same for this command: what it is not to start any more counts as ended, what it retries does not."""
        seen = self.seen(run)
        if seen.number in self._given_up:
            return Ended(seen.outcome)
        return None if seen.state == FAILED and self._retry else self.ended(run)

    def seen(self, run: Wanted) -> Seen:
        """State and outcome of a run; what has ended is looked at once. Raises InputError for a run of another case."""
        number = self._numbers.get(_key(run), 0)
        if number not in self._seen or self._seen[number].state not in (DONE, FAILED):
            self._seen[number] = self._look(number, run) if number else Seen(0, WAITING)
        return self._seen[number]

    def forget(self, number: int, given_up: str = "") -> None:
        """Look at a run again; `given_up`: why it is not to be started any more by this command."""
        self._seen.pop(number, None)
        if given_up:
            self._given_up[number] = given_up

    def _look(self, number, wanted):
        folder = self.folder(number)
        if not is_output(folder):
            if number in self._given_up:
                return Seen(number, FAILED, note=self._given_up[number])
            return Seen(number, WAITING)
        run, case = Run(folder), load(self.case, wanted.changes)
        self._check(run, case)
        info = run.info
        status = info.get("status")
        if status == "done" and info.get("time", 0.0) >= case.run.until:
            try:
                outcome = self._study.outcome.of(run)
            except InputError as error:
                return Seen(number, DONE, note="; ".join(error.messages))
            return Seen(number, DONE, outcome, "" if outcome is not None else "has no outcome")
        if status == "failed":
            return Seen(number, FAILED, note=str(info.get("error", "")))
        return Seen(number, RUNNING if held(folder) else STOPPED)

    def _check(self, run: Run, case: Case) -> None:
        try:
            there = run.case
        except InputError:
            there = {}
        changed = changed_keys(there, tomllib.loads(case.to_toml())) if there else []
        if changed:
            raise InputError(
                f"{run.folder}: is the run of another case, which differs in {', '.join(changed)}; give the study of "
                "a changed case a folder of its own"
            )


def _key(run):
    return tuple(sorted(run.changes))
