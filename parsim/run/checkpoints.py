"""When checkpoints are written, which of them are kept, and when a run must stop for the sake of one."""

from __future__ import annotations

import shutil
import time as clock
from typing import TYPE_CHECKING

import numpy as np

from parsim.errors import WriteError
from parsim.launch.stop import REASONS
from parsim.output import checkpoint
from parsim.output.series import next_multiple
from parsim.particles.state import water_bytes

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.launch.stop import Stop
    from parsim.run.recorder import Recorder
    from parsim.run.simulation import Simulation

KEPT = 2  # checkpoints, besides the milestones
_RESERVE = 2.0  # s before the walltime, besides what a checkpoint has taken
_SPEED = 50e6  # bytes/s at which the first checkpoint is expected to be written


class Keeper:
    """Asked by the solver before every step that rebuilds, on all ranks together; `finish` at the end of the run."""

    def __init__(self, case: Case, recorder: Recorder, stop: Stop, simulation: Simulation) -> None:
        self.case, self.recorder, self.stop, self.comm = case, recorder, stop, simulation.comm
        self.folder, self.timers, self.last = recorder.out / checkpoint.FOLDER, simulation.timers, None
        self.bytes = simulation.fluid_count * water_bytes(case.water.scheme.fields)
        self._cost, self._pace = self.bytes / _SPEED, 0.0
        self._looked = self._saved = clock.perf_counter()
        self._milestone = self._next_milestone(simulation.time)

    def look(self, simulation: Simulation) -> str:
        """Write a checkpoint if one is due; returns why the run must stop now, "" to go on. Raises WriteError."""
        now = clock.perf_counter()
        self._pace, self._looked = max(0.9 * self._pace, now - self._looked), now
        reason = self.stop.reason(_RESERVE + 3.0 * self._pace + 2.0 * self._cost)
        regular = now - self._saved > 60.0 * self.case.output.checkpoints
        milestone = simulation.time >= self._milestone
        reason, regular, room = self.comm.max([reason, self.recorder.main and regular, self._crowded()])
        if reason or regular or milestone or room:
            self._write(self._snapshot(simulation), milestone)
        elif self.case.run.until - simulation.time < 2.0 * simulation.dt * self.case.run.rebuild_at_most:
            self.last = self._snapshot(simulation)
        if room:
            text = (
                f"the disk is nearly full; stopped with a checkpoint. Make room for {2 * self.bytes / 1e6:.1f} MB "
                f"and more, then: parsim resume {self.recorder.out}"
            )
            raise WriteError(self.recorder.out, text, shared=True)
        return REASONS[int(reason)]

    def finish(self) -> None:
        """Write the state at the last rebuild, from which the run can be prolonged."""
        if self.last is not None:
            self._write(self.last, False)

    def _next_milestone(self, time):
        every = self.case.output.milestones
        return next_multiple(time, every) if every else np.inf

    def _snapshot(self, simulation):
        snapshot = simulation.snapshot()
        snapshot.account |= self.recorder.account(simulation)
        return snapshot

    def _write(self, snapshot, milestone):
        begin = clock.perf_counter()
        name = f"{'milestone' if milestone else 'checkpoint'}_{snapshot.account['step_count']:09d}{checkpoint.SUFFIX}"
        if milestone:
            self._milestone = self._next_milestone(snapshot.account["time"])
        with self.timers("checkpoints"):
            self.recorder.secure()
            checkpoint.write(self.folder / name, self.case.to_toml(), snapshot, self.comm)
        if self.recorder.main:
            self.bytes = (self.folder / name).stat().st_size
            self._prune()
        self.last, self._saved = None, clock.perf_counter()
        self._cost = self._saved - begin
        self._looked = self._saved  # a checkpoint is no part of the pace of rebuilds

    def _prune(self):
        regular = [path for path in checkpoint.listed(self.folder.parent) if path.name.startswith("checkpoint")]
        for path in regular[:-KEPT]:
            path.unlink(missing_ok=True)

    def _crowded(self):
        """Whether the disk has no room for two more checkpoints; rank 0 looks."""
        return self.recorder.main and shutil.disk_usage(self.recorder.out).free < 2 * self.bytes
