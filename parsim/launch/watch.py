"""A thread that ends a job which cannot end itself: a rank that hangs, a launcher that is gone.

Ranks stand in a ring; each tells the next one, now and then, how far it is. A rank that is not waiting for a message
and gets no further for `patience` seconds, or is silent for so long, is taken for hung by the next, which ends the job
and says which rank it was. Those that wait for it are not to blame, unless all wait for one another.
"""

from __future__ import annotations

import os
import sys
import threading
import time
import traceback
from typing import TYPE_CHECKING, Self

from parsim.launch import mpirun

if TYPE_CHECKING:
    from parsim.domain.comm import Comm

_LOOKS = 10  # in the patience
_DEADLOCK = 3.0  # times the patience, for all ranks waiting
_LONGEST = 5.0  # s between looks
_FRAMES = 6  # of the stack of a rank that hangs
_ORPHAN = 1.0  # s between looks at the launcher


class Watch:
    """Runs while it is used as a context manager, entered and left on all ranks together.

    `comm` tells of this rank: `calls`, messages and sums so far, and `waiting`, whether it is in one now.
    """

    def __init__(self, comm: Comm, patience: float) -> None:
        self._comm, self._patience = comm, patience
        self._parent = os.getppid() if mpirun.started() else None
        self._main = threading.get_ident()
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, name="watch", daemon=True)

    def __enter__(self) -> Self:
        self._ring = self._comm.ring()
        if self._comm.size > 1 and not self._ring and self._comm.rank == 0:
            print(
                "warning: this MPI library bears one thread only: a rank that hangs will not be noticed",
                file=sys.stderr,
                flush=True,
            )
        self._thread.start()
        return self

    def __exit__(self, kind, *_):
        self._end.set()
        self._thread.join()
        if kind is None and self._ring:
            self._ring.close()

    def _run(self):
        every = min(self._patience / _LOOKS, _LONGEST)
        sent = since = moved = time.monotonic()
        calls, heard, told = -1, None, False
        while not self._end.wait(min(every, _ORPHAN)):
            if self._parent not in (None, os.getppid()):
                self._leave("the launcher of this job is gone")
            now = time.monotonic()
            if not self._ring or now - sent < every:
                continue
            if now - sent > 3.0 * every + _ORPHAN:  # this process itself has slept: judge nobody by that
                since = moved = now
            sent = now
            self._ring.send(self._comm.calls, self._comm.waiting)
            news = self._ring.receive()
            if news is not None and (news[1] or news != heard):
                since, heard = now, news
            if now - since > self._patience:
                self._accuse(self._ring.left, heard)
            if self._comm.calls != calls:
                calls, moved, told = self._comm.calls, now, False
            elif now - moved > _DEADLOCK * self._patience:
                self._give_up()
            elif now - moved > 0.5 * self._patience and not (self._comm.waiting or told):
                self._confess()
                told = True

    def _accuse(self, left, heard):
        state = "is silent" if heard is None else "is stuck or silent"
        print(
            f"error: rank {left} of {self._comm.size} has made no progress for {self._patience:g} s (it "
            f"{state}); rank {self._comm.rank} ends the job",
            file=sys.stderr,
            flush=True,
        )
        self._comm.abort(1)

    def _confess(self):
        """Say where this rank is, while it still can."""
        stack = "".join(traceback.format_stack(sys._current_frames().get(self._main))[-_FRAMES:])
        print(
            f"rank {self._comm.rank} has made no progress for {0.5 * self._patience:g} s; it is at\n{stack}",
            file=sys.stderr,
            flush=True,
        )

    def _give_up(self):
        print(
            f"error: rank {self._comm.rank} has waited {_DEADLOCK * self._patience:g} s for a message, and so have "
            "the others: it ends the job",
            file=sys.stderr,
            flush=True,
        )
        self._comm.abort(1)

    def _leave(self, why):
        print(f"error: rank {self._comm.rank}: {why}", file=sys.stderr, flush=True)
        os._exit(1)
