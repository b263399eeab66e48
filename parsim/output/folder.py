"""The output folder: made or opened again, locked, with room on its disk, free of what a killed job has left."""

import math
import shutil
from pathlib import Path

from parsim.errors import InputError, WriteError
from parsim.estimate import estimate
from parsim.output import checkpoint, lock
from parsim.output.frames import write_text
from parsim.output.reader import MARKS

_WATER_BYTES, _BODY_BYTES = 90, 2000  # in a frame: of a particle, of a body
_ROW_BYTES, _BODY_ROW_BYTES = 600, 900  # of all series, and of each body in them


class Folder:
    """One output folder in the hands of one job. Rank 0 acts; every rank raises what it meets.

    Attribute path. All methods but `release` raise InputError or WriteError.
    """

    def __init__(self, path, comm):
        self.path, self.comm = Path(path), comm
        self.lock = lock.Lock(self.path)

    def make(self, case, source, force):
        """A new folder for a case from the file `source`; `force`: in place of an earlier output."""
        self._together(self._make, case, Path(source), force)

    def reopen(self, case, account=None):
        """Go on in an existing folder, as it was at the checkpoint with this account; None: from the beginning."""
        self._together(self._reopen, case, account)

    def release(self):
        """Let other jobs have the folder."""
        if self.comm.rank == 0:
            self.lock.release()

    def _together(self, work, *arguments):
        def told():
            try:
                work(*arguments)
            except OSError as error:
                raise WriteError(self.path, error.strerror or error) from None

        self.comm.first(told)

    def _make(self, case, source, force):
        out = self.path
        if out.exists() and not out.is_dir():
            raise WriteError(out, "there is a file of that name")
        full = out.is_dir() and any(path.name != lock.NAME for path in out.iterdir())
        if full and not force:
            raise InputError(f"OUT = {out}: already there and not empty; choose another folder, go on in it with "
                             "`parsim resume`, or add --force to replace it")
        if full and not any((out / mark).exists() for mark in MARKS):
            raise InputError(f"OUT = {out}: --force replaces only an earlier output of parsim (there is neither "
                             f"{' nor '.join(MARKS)} in this folder)")
        _check_room(case, out)
        out.mkdir(parents=True, exist_ok=True)
        self.lock.take()
        self._empty()
        self._furnish(case)
        reference = source.with_name("reference.csv")
        if reference.is_file():
            write_text(out / reference.name, reference.read_text(encoding="utf-8"))

    def _reopen(self, case, account):
        self.lock.take()
        if account is None:
            self._empty(keep={"reference.csv"})
        self._furnish(case)
        for path in self._newer(account) if account else ():
            path.unlink()

    def _newer(self, account):
        """What was written after a checkpoint, or not to its end."""
        frames = {name for entries in account["frames"].values() for name, _ in entries}
        yield from [path for path in (self.path / "frames").iterdir() if f"frames/{path.name}" not in frames]
        yield from [path for path in checkpoint.listed(self.path) if checkpoint.step_of(path) > account["step_count"]]
        yield from [path for path in self.path.rglob(".*.part")]

    def _furnish(self, case):
        write_text(self.path / "case.toml", case.to_toml())  # first: it makes the folder one to go on with
        for name in ("series", "frames", checkpoint.FOLDER):
            (self.path / name).mkdir(exist_ok=True)

    def _empty(self, keep=()):
        for path in self.path.iterdir():
            if path.name == lock.NAME or path.name in keep:
                continue
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink()


def _check_room(case, out):
    """Refuse a run whose output will not fit on the disk."""
    place = next(path for path in (out, *out.absolute().parents) if path.is_dir())
    needed, free = room_for(case), shutil.disk_usage(place).free
    if needed > free:
        raise WriteError(out, f"the output will take about {needed / 1e9:.2g} GB and {free / 1e9:.2g} GB are free; "
                              "write fewer frames (output.frames), or elsewhere")


def room_for(case):
    """Bytes that the frames, series and checkpoints of a case will take on the disk, about."""
    cost, time = estimate(case), case.run.until - case.start
    frame = _WATER_BYTES * cost.water + _BODY_BYTES * len(case.bodies)
    rows = time / case.output.series * (_ROW_BYTES + _BODY_ROW_BYTES * len(case.bodies))
    milestones = time / case.output.milestones if case.output.milestones else 0.0
    kept = checkpoint.WATER_BYTES * cost.water * (3.0 + math.ceil(milestones))  # one is written before one is removed
    return math.ceil(time / case.output.frames + 2.0) * frame + rows + kept
