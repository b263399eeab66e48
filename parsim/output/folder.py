"""The output folder: made or opened again, locked, with room on its disk, free of what a killed job has left."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from parsim.case.estimate import disk, estimate
from parsim.errors import InputError, WriteError
from parsim.output import checkpoint, lock
from parsim.output.frames import replacing, write_text
from parsim.output.reader import MARK, is_output
from parsim.output.reader import open as open_run

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.domain.comm import Comm

# what a run and its report write, in the order in which it is removed: what a killed job leaves of it must not be taken
# for another run's
_OURS = (
    checkpoint.FOLDER,
    "case.toml",
    "frames",
    "series",
    "report",
    "water.vtkhdf.series",
    "bodies.vtkhdf.series",
    "reference.csv",
    "run.json",
)


class Folder:
    """One output folder in the hands of one job. Rank 0 acts; every rank raises what it meets.

    Attribute path. All methods but `release` raise InputError or WriteError.
    """

    def __init__(self, path: Path | str, comm: Comm) -> None:
        self.path, self.comm = Path(path), comm
        self.lock = lock.Lock(self.path)

    def make(self, case: Case, source: Path | str, force: bool) -> None:
        """A new folder for a case from the file `source`; `force`: in place of an earlier output."""
        self._together(self._make, case, Path(source), force)

    def take(self) -> None:
        """Lock an existing output folder, so that what is found in it stays as it is."""
        self._together(self._take)

    def reopen(self, case: Case, account: dict[str, Any] | None = None) -> None:
        """Go on in a folder taken before, as it was at the checkpoint with this account; None: from the beginning."""
        self._together(self._reopen, case, account)

    def release(self) -> None:
        """Let other jobs have the folder."""
        if self.comm.rank == 0:
            self.lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def _together(self, work, *arguments):
        def told():
            try:
                work(*arguments)
            except OSError as error:
                raise WriteError(error.filename or self.path, error.strerror or error) from None

        self.comm.first(told)

    def _make(self, case, source, force):
        out = self.path
        if out.exists() and not out.is_dir():
            raise WriteError(out, "there is a file of that name")
        nothing = {lock.NAME} if (out / "case.toml").exists() else {lock.NAME, MARK}
        full = out.is_dir() and any(path.name not in nothing and not _is_part(path) for path in out.iterdir())
        if full and not force:
            raise InputError(
                f"OUT = {out}: already there and not empty; choose another folder, go on in it with "
                "`parsim resume`, or add --force to replace it"
            )
        if full and not is_output(out):
            raise InputError(
                f"OUT = {out}: --force replaces only an earlier output of parsim (there is neither {MARK} "
                "nor a checkpoint in this folder)"
            )
        _check_room(case, out)
        out.mkdir(parents=True, exist_ok=True)
        self.lock.take()
        for name in _OURS[:-1]:
            _remove(out / name)
        self._furnish(case, {"case_name": source.stem})
        reference = source.with_name("reference.csv")
        if reference.is_file():
            with replacing(out / reference.name) as part:
                shutil.copyfile(reference, part)

    def _take(self):
        open_run(self.path)  # raises InputError where there is no output
        self.lock.take()

    def _reopen(self, case, account):
        info = open_run(self.path).info
        told = {name: info[name] for name in ("case_name", "kernel", "pieces") if name in info}
        if account is None:
            write_text(self.path / MARK, json.dumps({"status": "running", **told}) + "\n")
            for name in ("frames", "series"):
                _remove(self.path / name)
        else:
            self._warn_of_missing(account)
        self._furnish(case, told)
        for path in self._newer(account) if account else ():
            _remove(path)
        for part in filter(_is_part, self.path.rglob(".*")):
            _remove(part)

    def _newer(self, account):
        """What was written after a checkpoint."""
        frames = {name for entries in account["frames"].values() for name, _ in entries}
        yield from [path for path in (self.path / "frames").iterdir() if f"frames/{path.name}" not in frames]
        yield from [path for path in checkpoint.listed(self.path) if checkpoint.step_of(path) > account["step_count"]]

    def _warn_of_missing(self, account):
        from parsim.observe.observers import TABLES  # brings numba along, whose settings a run makes first

        names = [name for entries in account["frames"].values() for name, _ in entries]
        missing = [name for name in names if not (self.path / name).is_file()]
        missing += [f"series/{name}.csv" for name in TABLES if not (self.path / "series" / f"{name}.csv").is_file()]
        if missing:
            print(
                f"warning: {self.path}: {len(missing)} earlier outputs are missing, {missing[0]} first; they are not "
                "made again",
                file=sys.stderr,
                flush=True,
            )

    def _furnish(self, case, told):
        write_text(self.path / MARK, json.dumps({"status": "running", **told}) + "\n")
        write_text(self.path / "case.toml", case.to_toml())
        for name in ("series", "frames", checkpoint.FOLDER):
            (self.path / name).mkdir(exist_ok=True)


def _is_part(path):
    """Whether this is what a killed job has left of a file that it was writing."""
    return path.name.startswith(".") and path.name.endswith(".part")


def _remove(path):
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _check_room(case, out):
    """Refuse a run whose output will not fit on the disk."""
    place = next(path for path in (out, *out.absolute().parents) if path.is_dir())
    needed, free = sum(disk(case, estimate(case).water)), shutil.disk_usage(place).free
    if needed > free:
        raise WriteError(
            out,
            f"the output will take about {needed / 1e9:.2g} GB and {free / 1e9:.2g} GB are free; "
            "write fewer frames (output.frames), or elsewhere",
        )
