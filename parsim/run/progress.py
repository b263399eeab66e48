"""How far the run is: one line that renews itself on a terminal, now and then a line in a batch log.

The cursor is never hidden and no thread draws, so there is nothing to put right when a rank dies.
"""

import os
import sys
import time as clock
from collections import deque
from typing import Self, TextIO, cast

from rich.console import Console
from rich.control import Control
from rich.progress_bar import ProgressBar
from rich.segment import ControlType

from parsim.launch import mpirun

FIRST, LONGEST = 2.0, 60.0  # s between lines in a log: 2, 4, 8, ... 60
REFRESH = 0.2  # s between renewals on a terminal
BAR = 24  # columns
_RENEW = Control((ControlType.CARRIAGE_RETURN,), (ControlType.ERASE_IN_LINE, 2))


class _Outlet:
    """Standard output for a run, which does not end because nobody can read it: a closed terminal, a full disk."""

    def __init__(self, stream):
        self._stream = stream

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def write(self, text):
        """Write what can be written."""
        self._tried(self._stream.write, text)

    def flush(self):
        """Likewise."""
        self._tried(self._stream.flush)

    def _tried(self, act, *given):
        try:
            act(*given)
        except OSError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())  # what waits in the stream goes there as well
            os.close(nowhere)


class Progress:
    """Progress of one run from `start` to `until` (simulated s), for rank 0 alone.

    As a context manager it ends its line also when the run fails.
    """

    def __init__(self, start: float, until: float) -> None:
        self.start, self.until = start, until
        self.on_terminal = mpirun.terminal() > 0
        self.began = clock.perf_counter()
        self.every = REFRESH if self.on_terminal else FIRST
        self.due = self.began + self.every
        self.work = 0
        self.last = (0, start, 0.0)
        self.closed = False
        # rates: over some ten seconds on a terminal, since the line before in a log
        self.samples = deque([(self.began, start, 0)], maxlen=50 if self.on_terminal else 2)
        self.console = Console(file=cast(TextIO, _Outlet(sys.stdout)), force_terminal=self.on_terminal, highlight=False)

    def step(self, step: int, time: float, dt: float, active: int) -> None:
        """Count one step of `active` particles that ended at `time` (simulated s); print when something is due."""
        self.work += active
        self.last = (step, time, dt)
        now = clock.perf_counter()
        if now < self.due:
            return
        self.samples.append((now, time, self.work))
        self._show()
        if not self.on_terminal:
            self.every = min(2 * self.every, LONGEST)
        self.due = now + self.every

    def close(self, status: str, step: int | None = None, time: float | None = None) -> None:
        """End with one line: `status` ("done", "failed", ...), where the run stands, its mean speed.

        `step` and `time` (s) are the last ones, where the solver knows better than the last line did. Only the
        first call prints.
        """
        if self.closed:
            return
        self.closed = True
        wall = clock.perf_counter() - self.began
        step = self.last[0] if step is None else step
        time = self.last[1] if time is None else time
        if self.on_terminal:
            self.console.control(_RENEW)
        rate = quantity(self.work / wall)
        self.say(f"{status}: t = {time:.4g} s, {step} steps in {duration(wall)}, {rate} particle-steps/s")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        self.close("failed" if error else "ended")

    def say(self, line: str) -> None:
        """Print one line."""
        self.console.print(line, soft_wrap=True)
        self.console.file.flush()

    def _facts(self):
        (wall0, time0, work0), (wall1, time1, work1) = self.samples[0], self.samples[-1]
        step, time, dt = self.last
        speed = (time1 - time0) / (wall1 - wall0)
        started = len(self.samples) > 1 and self.samples[0][0] > self.began  # the first step is slower than any other
        left = duration((self.until - time) / speed) if speed > 0 and started else "?"
        rate = quantity((work1 - work0) / (wall1 - wall0))
        return [
            f"t = {time:.4f} of {self.until:g} s",
            f"{left} left",
            f"dt {1e3 * dt:.3g} ms",
            f"{rate} particle-steps/s",
            f"step {step}",
        ]

    def _show(self):
        if not self.on_terminal:
            self.say("  ".join(self._facts()))
            return
        share = (self.last[1] - self.start) / (self.until - self.start)
        # on a narrow terminal the last facts are left out
        facts, room = "", (mpirun.terminal() or 80) - BAR - 1
        for fact in self._facts():
            if len(facts) + 2 + len(fact) > room:
                break
            facts += "  " + fact
        self.console.control(_RENEW)
        self.console.print(ProgressBar(total=1.0, completed=share, width=BAR), end="")
        self.console.print(facts, end="\r", soft_wrap=True)
        self.console.file.flush()


def duration(seconds: float) -> str:
    """Seconds in words of two units at most: 4.2 s, 3 min 05 s, 2 h 07 min, 3 d 04 h."""
    if seconds < 60:
        return f"{seconds:.1f} s"
    units = (("min", "s", 60, 1), ("h", "min", 3600, 60), ("d", "h", 86400, 3600))
    unit, small, size, part = next((row for row in units[:2] if seconds < 60 * row[2]), units[2])
    whole, rest = divmod(int(seconds), size)
    return f"{whole} {unit} {rest // part:02d} {small}"


def quantity(number: float) -> str:
    """A number with three digits and a prefix: 950, 12.3 k, 1.24 M."""
    for prefix, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if number >= size:
            return f"{number / size:.3g} {prefix}"
    return f"{number:.3g}"
