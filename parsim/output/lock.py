"""The lock of an output folder: two jobs never write one folder, and a killed one does not keep it for ever."""

import fcntl
import json
import os
import platform
import time
from datetime import UTC, datetime
from pathlib import Path

from parsim.errors import InputError, WriteError

NAME = "lock"
STALE = 300.0  # s without a sign of life after which the lock of another machine is void
BEAT = 30.0  # s between signs of life, at most


class Lock:
    """Held from `take` to `release` by one process, rank 0 of a job.

    The operating system frees the lock of a process that has ended. A file system may not tell the machines of a
    cluster from each other's locks; hence a job also gives signs of life, by the date of the file, and a lock that
    another machine has left is void only when it has given none for STALE seconds.
    """

    def __init__(self, folder):
        self.path = Path(folder, NAME)
        self._file, self._beaten = None, 0.0

    def take(self):
        """Take the lock. Raises InputError, which says who has it, or WriteError."""
        while self._file is None:
            try:
                file = open(self.path, "a+", encoding="utf-8")
            except OSError as error:
                raise WriteError(self.path, error.strerror or error) from None
            if not _locked(file) or self._alive(file):
                text = _holder(file)
                file.close()
                raise InputError(f"OUT = {self.path.parent}: another job writes it ({text}); wait for its end. If it "
                                 f"is dead for certain, remove {self.path}")
            if _is_at(file, self.path):  # else its holder removed it just now
                self._file = file
        self._file.truncate(0)
        self._file.write(json.dumps({"host": platform.node(), "process": os.getpid(),
                                     "job": os.environ.get("SLURM_JOB_ID") or os.environ.get("PBS_JOBID"),
                                     "since": datetime.now(UTC).isoformat(timespec="seconds")}))
        self._file.flush()

    def beat(self):
        """Give a sign of life, now and then."""
        now = time.monotonic()
        if self._file and now - self._beaten > BEAT:
            self._beaten = now
            os.utime(self._file.fileno())

    def release(self):
        """Give the folder free."""
        if self._file:
            self.path.unlink(missing_ok=True)
            self._file.close()
            self._file = None

    def _alive(self, file):
        """Whether a job on another machine has given a sign of life lately."""
        file.seek(0)
        try:
            host = json.loads(file.read())["host"]
        except (ValueError, KeyError, TypeError):
            return False
        return host != platform.node() and time.time() - os.fstat(file.fileno()).st_mtime < STALE


def held(folder):
    """Whether a job writes this folder now, as far as can be seen from here."""
    path = Path(folder, NAME)
    try:
        with open(path, "r+", encoding="utf-8") as file:
            return not _locked(file) or Lock(folder)._alive(file)
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
