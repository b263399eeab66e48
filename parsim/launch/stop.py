"""Reasons to end a run before its end, in good order: signals, and the walltime of the job."""

import os
import signal
import time
from pathlib import Path
from typing import Any, Self

from parsim.errors import InputError
from parsim.launch import mpirun

STOPPED = 75  # exit code: a checkpoint is written, submit again
REASONS = ("", "walltime", *(number.name for number in mpirun.SIGNALS))  # numbered: ranks agree on the largest
_UNITS = (1.0, 60.0, 3600.0, 86400.0)


_early: list[int] = []  # signals that came before anything could be done about them


def listen() -> None:
    """Note SIGUSR1 from now on, which would end a process that does not yet listen to it; hear SIGTERM (`launch`)."""
    signal.signal(signal.SIGUSR1, lambda number, _: _early.append(number))
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGTERM])


def early() -> bool:
    """Whether a signal has been noted since `listen`."""
    return bool(_early)


class Stop:
    """Listens while it is used as a context manager.

    A second signal ends the process at once, but for SIGUSR1. `walltime`, s, is that of the whole job, counted from the
    start of this process.
    """

    def __init__(self, walltime: float | None = None) -> None:
        self.walltime = walltime
        self._number = _early[0] if _early else None
        self._first = None if self._number is None else time.monotonic()
        self._heeding = mpirun.heeding(self._hear)

    def __enter__(self) -> Self:
        self._heeding.__enter__()
        return self

    def __exit__(self, *told: Any) -> None:
        self._heeding.__exit__(*told)

    def reason(self, margin: float) -> int:
        """Number in REASONS of why this process should stop, 0 to go on; `margin`, s, is what stopping takes."""
        if self._number is not None:
            return REASONS.index(signal.Signals(self._number).name)
        return int(self.walltime is not None and age() + margin > self.walltime)

    def _hear(self, number, _):
        now = time.monotonic()
        if self._first is None:
            self._first, self._number = now, number
        elif number != signal.SIGUSR1 and now - self._first > mpirun.SAME_SIGNAL:
            os._exit(128 + number)


def age() -> float:
    """Seconds since this process was started."""
    ticks = int(Path("/proc/self/stat").read_text().rpartition(")")[2].split()[19])
    return float(Path("/proc/uptime").read_text().split()[0]) - ticks / os.sysconf("SC_CLK_TCK")


def seconds(text: str) -> float:
    """Seconds of a walltime as schedulers write it: minutes, M:S, H:M:S or D-H:M:S. Raises InputError."""
    days, dash, rest = str(text).rpartition("-")
    parts = rest.split(":")
    numbers = [days, *parts] if dash else parts
    whole = all(number.isdecimal() and len(number) < 10 for number in numbers)
    if not whole or len(parts) > 3 or (dash and len(parts) != 3):
        raise InputError(
            f"walltime = {text}: must be minutes, or minutes:seconds, hours:minutes:seconds or "
            "days-hours:minutes:seconds, such as 12:00:00"
        )
    if len(numbers) == 1:
        numbers.append("0")
    return float(sum(int(number) * unit for number, unit in zip(reversed(numbers), _UNITS, strict=False)))
