"""Everything a run writes: the folder, the series, the frames, the progress, the account at the end."""

from __future__ import annotations

import json
import os
import platform
import shlex
import time as clock
from contextlib import suppress
from datetime import UTC, datetime
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from parsim import __version__
from parsim.errors import WriteError
from parsim.machine import variant
from parsim.observe.lost import Lost
from parsim.observe.observer import Follower
from parsim.observe.observers import OBSERVERS, TABLES
from parsim.output.frames import WaterFrame, write_bodies, write_index, write_text
from parsim.output.reader import MARK
from parsim.output.series import Table, next_multiple
from parsim.run.progress import Progress

if TYPE_CHECKING:
    from types import TracebackType

    from parsim.case.model import Case
    from parsim.output.folder import Folder
    from parsim.run.simulation import Simulation

_FIELDS = {
    "id": ("i8", ()),
    "velocity": ("f8", (3,)),
    "pressure": ("f8", ()),
    "class": ("u1", ()),
    "density_ratio": ("f8", ()),
}
_BODY = ("position", "quaternion", "velocity", "spin", "water_load", "contact_load", "gravity_load")


class Recorder:
    """Called by the solver: `begin`, `watch` after every step, at last `finish` or `stopped`.

    As a context manager it tells of failure. `account`: that of the checkpoint from which the run goes on.
    """

    def __init__(self, case: Case, folder: Folder, name: str = "", account: dict[str, Any] | None = None) -> None:
        self.case, self.folder, self.out, self.name = case, folder, folder.path, name
        self.comm, self.main = folder.comm, folder.comm.rank == 0
        self.began = clock.perf_counter()
        self.resumed = account
        frames = account["frames"] if account else {"water": [], "bodies": []}
        self.frames = {kind: [tuple(entry) for entry in entries] for kind, entries in frames.items()}
        started = datetime.now(UTC).isoformat(timespec="seconds")
        self.info = {"status": "running", "parsim": __version__, "started": started, "pieces": self._earlier()}

    def _earlier(self):
        """The pieces of the run that came before this one."""
        if not self.main or not self.resumed:
            return []
        try:
            pieces = json.loads((self.out / MARK).read_text(encoding="utf-8"))["pieces"]
        except (OSError, ValueError, KeyError):
            return []
        return [{"ended": "killed"} | piece for piece in pieces]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None and self.main:
            if getattr(self, "progress", None):
                self.progress.close("failed")
            if self.folder.lock.mine:
                with suppress(WriteError):  # of a full disk the error in flight tells already
                    self._end("failed", error=f"{kind.__name__}: {error}")

    def begin(self, simulation: Simulation) -> None:
        """Open the tables; write the first rows and frame, unless the run goes on."""
        self.observers, self.lost = [observer(self.case) for observer in OBSERVERS], Lost(self.case)
        self.followers = {each.name: each for each in self.observers if isinstance(each, Follower)}
        self.next_frame, self.next_row = simulation.time, simulation.time
        self.particles = {
            "fluid": simulation.fluid_count,
            "active": simulation.active,
            "wall": len(simulation.solids.walls),
            "body": len(simulation.solids.samples),
        }
        if self.resumed:
            self.particles = self.resumed["particles"]
            self.next_frame, self.next_row = self.resumed["next_frame"], self.resumed["next_row"]
            for name, kept in self.resumed["followers"].items():
                self.followers[name].restore(kept)
        if self.main:
            self._open_tables()
            self._write_indices()
            self.progress = Progress(simulation.time, self.case.run.until)
            self.info |= self._versions(simulation)
            self.info["start_s"] = clock.perf_counter() - self.began
            self.info["pieces"].append(
                {key: self.info[key] for key in ("started", "host", "ranks", "threads")}
                | {"from_step": simulation.step_count}
            )
            self._write_info()
        if not self.resumed:
            self.watch(simulation)

    def _open_tables(self):
        step = self.resumed["step_count"] if self.resumed else None
        self.tables = {
            name: Table(self.out / "series" / f"{name}.csv", units, resume=step) for name, units in TABLES.items()
        }

    def account(self, simulation: Simulation) -> dict[str, Any]:
        """What a restart must know of the outputs as they are now."""
        if self.main:
            self._tell_gone(simulation)
        frames = {kind: list(entries) for kind, entries in self.frames.items()}
        return {
            "frames": frames,
            "next_frame": self.next_frame,
            "next_row": self.next_row,
            "followers": {name: follower.kept() for name, follower in self.followers.items()},
            "name": self.name,
            "particles": self.particles,
            "kernel": variant.chosen(),
            "versions": variant.versions(),
        }

    def secure(self) -> None:
        """See all rows on the disk: a checkpoint relies on them."""
        if self.main:
            for table in self.tables.values():
                table.secure()

    def watch(self, simulation: Simulation) -> None:
        """Look at the simulation after a step; write what is due."""
        if self.main:
            self.folder.lock.beat()
            self.progress.step(simulation.step_count, simulation.time, simulation.dt, simulation.active)
        with simulation.timers("output"):
            for follower in self.followers.values():
                follower.see(simulation)
            if simulation.time >= self.next_row:
                self.next_row = next_multiple(simulation.time, self.case.output.series)
                self._rows(simulation)
            if simulation.time >= self.next_frame:
                self.next_frame = next_multiple(simulation.time, self.case.output.frames)
                self._frame(simulation)

    def _rows(self, simulation):
        rows = self._seen(simulation)
        if not self.main:
            return
        self._tell_gone(simulation)
        for name, lines in rows.items():
            for line in lines:
                self.tables[name].row(simulation.step_count, simulation.time, *line)
            self.tables[name].flush()

    def _seen(self, simulation):
        """Rows of every series but that of what is lost: {name: rows}."""
        return {observer.name: observer.rows(simulation) for observer in self.observers}

    def _tell_gone(self, simulation):
        for row in self.lost.rows(simulation):
            self.tables[Lost.name].row(*row)
            _, time, what, *_ = row
            if what != "water":
                self.progress.say(f"{what} has left the box: taken out at t = {time:.6g} s")
        self.tables[Lost.name].flush()
        simulation.gone.clear()

    def fault(self, simulation: Simulation) -> None:
        """The frame of a run that goes wrong in this step."""
        self._frame(simulation)

    def _frame(self, simulation):
        number, step, time = len(self.frames["water"]), simulation.step_count, simulation.time
        p, at = simulation.domain.particles, simulation.near.fluid
        name = f"frames/water_{number:06d}.vtkhdf"
        self.frames["water"].append((name, time))
        arrays = [
            np.stack([p.x[at], p.y[at], p.z[at]], 1),
            p.id[at],
            np.stack([p.u[at], p.v[at], p.w[at]], 1),
            p.p[at],
            p.surface[at],
            simulation.scheme.compression(p, at),
        ]
        self._stream(name, simulation.fluid_count, arrays, time, step)
        if self.main and len(simulation.bodies.mass):
            name = f"frames/bodies_{number:06d}.vtkhdf"
            self.frames["bodies"].append((name, time))
            fields = {field: simulation.bodies.shown(field) for field in _BODY}
            shift = simulation.solids.samples.home(*simulation.bodies.position.T)
            fields["position"] = fields["position"] + shift  # where it is seen in the box
            points, quads, body = simulation.bodies.surface(shift)
            write_bodies(self.out / name, points, quads, body, fields, time, step)
        if self.main:
            self._write_indices()

    def _write_indices(self):
        for kind, entries in self.frames.items():
            if entries:
                write_index(self.out / f"{kind}.vtkhdf.series", entries)

    def _stream(self, name, total, arrays, time, step):
        """Write the water frame through rank 0, one rank's particles after another's: bounded memory."""
        blocks = zip(*(self.comm.stream(array) for array in arrays), strict=True)
        if not self.main:
            for _ in blocks:
                pass
            return
        with WaterFrame(self.out / name, total, _FIELDS, time, step) as frame:
            for points, *values in blocks:
                frame.append(points, dict(zip(_FIELDS, values, strict=True)))

    def finish(self, simulation: Simulation) -> None:
        """Last frame if it is not written yet, then the account of the run; rows are at their times only."""
        if self.frames["water"][-1][1] < simulation.time:
            self._frame(simulation)
        self._close("done", simulation)

    def stopped(self, simulation: Simulation, reason: str) -> None:
        """End a run that has been stopped, with a checkpoint, before its end."""
        go_on = f"parsim resume {shlex.quote(str(self.out))}"
        self._close(f"stopped ({reason})", simulation, reason=reason, go_on=go_on)
        if self.main:
            self.progress.say(f"to go on: {go_on}")

    def _close(self, words, simulation, **facts):
        wall = clock.perf_counter() - simulation.timers.start
        rows = self._seen(simulation)
        if not self.main:
            return
        self._tell_gone(simulation)
        for table in self.tables.values():
            table.close()
        self.progress.close(words, simulation.step_count, simulation.time)
        counts = dict(zip(list(TABLES["counts"])[2:], rows["counts"][0], strict=True))
        cores = self.info["ranks"] * self.info["threads"]
        self._end(
            words.split()[0],
            **facts,
            steps=simulation.step_count,
            time=simulation.time,
            wall_s=wall,
            lost=counts["lost"],
            largest_overlap=simulation.contacts.overlap,
            residual=simulation.contacts.residual,
            warnings=[*self.case.warnings(), *simulation.contacts.doubts()],
            leaks={k: counts[k] for k in ("in_walls", "in_bodies", "in_gate")},
            phases=dict(simulation.timers.seconds),
            rebuilds=simulation.rebuilds,
            uneven=dict(zip(("mean", "most"), simulation.uneven, strict=True)),
            rate={
                "active_particle_steps_per_s_per_core": self.progress.work / wall / cores,
                "active_particle_steps": self.progress.work,
                "all": counts["all"],
            },
        )

    def _end(self, status, **facts):
        """Note how the run has ended."""
        self.info |= {"status": status, **facts}
        if self.info["pieces"] and "ended" not in self.info["pieces"][-1]:
            self.info["pieces"][-1] |= {"ended": facts.get("reason", status)} | {
                key: facts[key] for key in ("steps", "time", "wall_s") if key in facts
            }
        self._write_info()

    def _versions(self, simulation):
        import numba

        return {
            "case_name": self.name,
            "ranks": self.comm.size,
            "threads": numba.get_num_threads(),
            "host": platform.node(),
            "warnings": list(self.case.warnings()),
            "kernel": variant.chosen(),
            "processor": os.environ.get("NUMBA_CPU_NAME", "host"),
            "versions": {
                "python": platform.python_version(),
                "mpi": self.comm.library,
                **{name: version(name) for name in ("numpy", "numba", "h5py", "mpi4py")},
            },
            "particles": self.particles,
        }

    def _write_info(self):
        write_text(self.out / MARK, json.dumps(self.info, indent=1) + "\n")
