"""Wall time by phase of the step."""

import time
from collections.abc import Iterator
from contextlib import contextmanager


class Timers:
    """Seconds spent in each named phase since the start, in order of first use.

    A phase inside another one, such as a wait for a message in a sweep, is taken out of that one.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.start = time.perf_counter()
        self._inner = 0.0  # seconds of the phases that have ended inside the present one

    @contextmanager
    def __call__(self, phase: str) -> Iterator[None]:
        """Count the time of the block to `phase`."""
        outer, self._inner = self._inner, 0.0
        begin = time.perf_counter()
        try:
            yield
        finally:
            spent = time.perf_counter() - begin
            self.seconds[phase] = self.seconds.get(phase, 0.0) + spent - self._inner
            self._inner = outer + spent
