"""Wall time by phase of the step."""

import time
from contextlib import contextmanager


class Timers:
    """Seconds spent in each named phase since the start, in order of first use."""

    def __init__(self):
        self.seconds = {}
        self.start = time.perf_counter()

    @contextmanager
    def __call__(self, phase):
        """Count the time of the block to `phase`."""
        begin = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[phase] = self.seconds.get(phase, 0.0) + time.perf_counter() - begin
