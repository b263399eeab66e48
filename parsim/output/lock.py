"""The lock of an output folder: two jobs never write one folder, and a killed one does not keep it for ever."""

import fcntl
import json
import os
import platform
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import TextIO

from parsim.errors import InputError, RunError, WriteError

NAME = "lock"
STALE = 300.0  # s without a sign of life after which the lock of another machine is void
BEAT = 30.0  # s between signs of life, at most
LOOK = 2.0  # s between looks for one


class Lock:
    """Held from `take` to `release` by one process, rank 0 of a job.

    The operating system frees the lock of a process that has ended. A file system may not tell the machines of a
    cluster from each other's locks; hence a job also gives signs of life, by the date of the file, and a lock that
    another machine has left is void only when it has given none for STALE seconds. Who finds one waits that long for a
    sign: a job that goes on where a lost machine has left off must not fail for being quick.
    """

    def __init__(self, folder: Path | str) -> None:
        self.path = Path(folder, NAME)
        self._file: TextIO | None = None
        self._text, self._beaten = "", 0.0

    def take(self) -> None:
        """Take the lock, once that of another machine has shown whether it lives.

        Raises InputError, which says who has it, or WriteError.
        """
        seen = None
        while self._file is None:
            try:
                file = open(self.path, "a+", encoding="utf-8")
            except OSError as error:
                raise WriteError(self.path, error.strerror or error) from None
            sign = _sign_of_life(file) if _locked(file) else 0.0
            if sign is None and _is_at(file, self.path):  # else its holder removed it just now
                self._file = file
            elif sign is not None:
                holder = _holder(file)
                file.close()
                if sign == 0.0 or seen not in (None, sign):
                    raise InputError(
                        f"OUT = {self.path.parent}: another job writes it ({holder}); wait for its end. "
                        f"If it is dead for certain, remove {self.path}"
                    )
                if seen is None:
                    print(
                        f"{self.path.parent}: locked by another job ({holder}); waiting up to {STALE:g} s for a sign "
                        "of life",
                        flush=True,
                    )
                seen = sign
                time.sleep(LOOK)
        self._note(self._file)

    def _note(self, file):
        """Write down who has the lock."""
        self._text = json.dumps(
            {
                "host": platform.node(),
                "process": os.getpid(),
                "job": os.environ.get("SLURM_JOB_ID") or os.environ.get("PBS_JOBID"),
                "since": datetime.now(UTC).isoformat(timespec="microseconds"),
            }
        )
        file.truncate(0)
        file.write(self._text)
        file.flush()

    @property
    def mine(self) -> bool:
        """Whether this process has the lock."""
        return self._file is not None

    def beat(self) -> None:
        """Give a sign of life, now and then. Raises RunError where another job has taken this one for dead."""
        now = time.monotonic()
        if not self._file or now - self._beaten < BEAT:
            return
        self._beaten = now
        self._file.seek(0)
        if self._file.read() != self._text or not _is_at(self._file, self.path):
            self._file.close()
            self._file = None
            raise RunError(
                f"another job has taken {self.path.parent} after {STALE:g} s without a sign of life of this "
                "one, which ends"
            )
        os.utime(self._file.fileno())

    def release(self) -> None:
        """Give the folder free."""
        if self._file:
            self.path.unlink(missing_ok=True)
            self._file.close()
            self._file = None


def held(folder: Path | str) -> bool:
    """Whether a job writes this folder now, as far as can be seen from here."""
    path = Path(folder, NAME)
    try:
        with open(path, "r+", encoding="utf-8") as file:
            return not _locked(file) or _sign_of_life(file) is not None
    except OSError:
        return path.exists()


def _locked(file):
    """Whether this process got the system's lock; True too where the file system has none."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def _sign_of_life(file):
    """When a job on another machine that may still live has given its last one, s; None where there is none such."""
    file.seek(0)
    try:
        host = json.loads(file.read())["host"]
    except (ValueError, KeyError, TypeError):
        return None
    beaten = os.fstat(file.fileno()).st_mtime
    return beaten if host != platform.node() and time.time() - beaten < STALE else None


def _is_at(file, path):
    try:
        return os.path.samestat(os.fstat(file.fileno()), os.stat(path))
    except FileNotFoundError:
        return False


def _holder(file):
    file.seek(0)
    try:
        told = json.loads(file.read())
        return ", ".join(f"{key} {value}" for key, value in told.items() if value is not None)
    except (ValueError, AttributeError):
        return "it does not say who"
