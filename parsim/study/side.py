"""Runs side by side on this machine: each a process `parsim run` or `parsim resume` of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import IO

from parsim.errors import WriteError
from parsim.launch import exits, stop
from parsim.launch.mpirun import SAME_SIGNAL, die_with_parent, heeding
from parsim.output.lock import Lock
from parsim.output.reader import is_output
from parsim.study.plan import Sample, Search, Wanted
from parsim.study.runs import RUNNING, TABLE, Runs

PARSIM = [sys.executable, "-P", "-m", "parsim"]
_LOOK = 0.1  # s between looks at the processes


@dataclass
class Hands:
    """How runs are made: so many at a time, each on so many ranks, until the walltime, s, of this process is over."""

    jobs: int = 1
    ranks: int = 1
    walltime: float | None = None
    _running: dict[int, tuple[subprocess.Popen[bytes], IO[bytes], int, Wanted]] = field(default_factory=dict)
    _stopping: bool = False
    _heard: float | None = None  # when the first signal came

    def work(
        self, plans: Sequence[Sample | Search], runs: Runs, lock: Lock, told: Callable[[int, Wanted], object]
    ) -> bool:
        """Make the runs that the plans want until they want no more; False: stopped before.

        `told`(number, run) is called at the end of each. Raises WriteError where a run cannot write, once the others
        have stopped.
        """
        with heeding(self._hear):
            try:
                self._stopping = stop.early()
                while True:
                    self._fill(plans, runs)
                    if not self._running:
                        return not self._stopping
                    for number in self._ended(lock):
                        self._take(number, runs, told)
            finally:
                self._end()

    def _ended(self, lock):
        """The numbers of the runs that end next."""
        while not (ended := [n for n, (process, *_) in self._running.items() if process.poll() is not None]):
            lock.beat()
            time.sleep(_LOOK)
        return ended

    def _fill(self, plans, runs):
        for plan in plans:
            for run in plan.wanted(runs.known):
                if self._stopping or len(self._running) >= self.jobs:
                    return
                (number,) = runs.enter([run])
                if number not in self._running and runs.seen(run).state != RUNNING:
                    self._start(number, run, runs)

    def _start(self, number, run, runs):
        folder = runs.folder(number)
        words = ["resume", folder, "--case", runs.case] if is_output(folder) else ["run", runs.case, "-o", folder]
        words += ["--table", runs.out / TABLE, "--row", number, *(["-n", self.ranks] if self.ranks > 1 else [])]
        if self.walltime is not None:
            left = max(round(self.walltime - stop.age()), 1)
            words += ["--walltime", f"{left // 60}:{left % 60:02d}"]
        log = runs.log(number)
        try:
            file = log.open("ab")
            began = file.seek(0, os.SEEK_END)
        except OSError as error:
            raise WriteError(log, error.strerror or error) from None
        process = subprocess.Popen(
            [*PARSIM, *map(str, words)],
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=file,
            process_group=0,  # a terminal would send SIGINT to the runs as well
            preexec_fn=_as_child,
        )
        self._running[number] = (process, file, began, run)
        if self._stopping:  # a signal came while it was started
            self._stop()

    def _take(self, number, runs, told):
        process, file, began, run = self._running.pop(number)
        file.close()
        code, log, why = process.returncode, runs.log(number), "ended before it wrote anything"
        if code == stop.STOPPED:
            self._stop()
        elif code in (exits.BAD_INPUT, exits.CANNOT_WRITE):
            said = log.read_bytes()[began:].decode(errors="replace").splitlines()
            errors = [line.removeprefix("error: ") for line in said if line.startswith("error: ")]
            if code == exits.CANNOT_WRITE:
                raise WriteError(runs.folder(number), errors[-1] if errors else f"see {log}")
            why = "refused: " + "; ".join(errors)
        runs.forget(number, "" if self._stopping else f"{why}; see {log}")
        told(number, run)

    def _hear(self, number, _):
        """A first signal has all runs leave a checkpoint, another one ends them at once."""
        now = time.monotonic()
        first = self._heard is None or now - self._heard <= SAME_SIGNAL or number == signal.SIGUSR1
        self._heard = self._heard or now
        self._stop(signal.SIGUSR1 if first else signal.SIGTERM)

    def _stop(self, number=signal.SIGUSR1):
        """Have all runs end, and start no more."""
        self._stopping = True
        for process, *_ in self._running.values():
            if process.poll() is None:
                process.send_signal(number)

    def _end(self):
        """Let what still runs come to its end in good order."""
        if self._running:
            self._stop()
        for process, file, *_ in self._running.values():
            process.wait()
            file.close()


def _as_child():
    die_with_parent(signal.SIGTERM)
