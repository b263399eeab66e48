"""Everything a run writes: the folder, the series, the frames, the progress, the account at the end."""

import json
import os
import platform
import shutil
import time as clock
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from parsim import __version__, variant
from parsim.errors import InputError, WriteError
from parsim.output.frames import WaterFrame, write_bodies, write_index, write_text
from parsim.output.measure import Measure
from parsim.output.progress import Progress
from parsim.output.series import Table

_FIELDS = {"id": ("i8", ()), "velocity": ("f8", (3,)), "pressure": ("f8", ()), "class": ("u1", ()),
           "density_ratio": ("f8", ())}
_BODY = ("position", "quaternion", "velocity", "spin", "water_load", "contact_load", "gravity_load")
TABLES = {
    "energy": ("kinetic_water potential_water elastic_water kinetic_bodies potential_bodies elastic_contacts "
               "work_gate dissipated_contacts total", "J"),
    "counts": ("fluid active all in_walls in_bodies in_gate lost surface volume", "-"),
    "bodies": ("body x y z q0 q1 q2 q3 u v w spin_x spin_y spin_z", "m, m/s, rad/s"),
    "loads": ("body kind fx fy fz tx ty tz", "N, N m"),
    "gauges": ("gauge x y level", "m"),
    "front": ("x", "m"),
}


class Recorder:
    """Called by the solver: `begin`, `watch` after every step, `finish`; as a context manager it tells of failure."""

    def __init__(self, case, source, out, force, comm):
        self.case, self.source, self.out, self.comm = case, Path(source), Path(out), comm
        self.main = comm.rank == 0
        self.began = clock.perf_counter()
        refusal = comm.share(self._prepare(force) if self.main else None)
        if refusal is not None:
            raise refusal
        self.frames = {"water": [], "bodies": []}
        self.info = {"status": "running", "parsim": __version__, "started": datetime.now(UTC).isoformat()}

    def _prepare(self, force):
        """Make the folder on rank 0; returns the error instead of raising it, for every rank must hear of it."""
        try:
            if self.out.exists() and not self.out.is_dir():
                return WriteError(self.out, "there is a file of that name")
            if self.out.is_dir() and any(self.out.iterdir()):
                if not force:
                    return InputError(f"OUT = {self.out}: already there and not empty; choose another folder or add "
                                      "--force to replace it")
                if not (self.out / "run.json").exists():
                    return InputError(f"OUT = {self.out}: --force replaces only an earlier output of parsim (there is "
                                      "no run.json in this folder)")
                shutil.rmtree(self.out)
            (self.out / "series").mkdir(parents=True, exist_ok=True)
            (self.out / "frames").mkdir(exist_ok=True)
            write_text(self.out / "case.toml", self.case.to_toml())
            reference = self.source.with_name("reference.csv")
            if reference.is_file():
                write_text(self.out / reference.name, reference.read_text(encoding="utf-8"))
        except OSError as error:
            return WriteError(self.out, error.strerror or error)
        except WriteError as error:
            return error
        return None

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if kind is not None and self.main:
            if getattr(self, "progress", None):
                self.progress.close("failed")
            self.info |= {"status": "failed", "error": f"{kind.__name__}: {error}"}
            self._write_info()

    def begin(self, simulation):
        """Open the tables, write the first rows and frame."""
        self.measure = Measure(self.case, simulation)
        self.next_frame, self.next_row = simulation.time, simulation.time
        if self.main:
            self._open_tables(simulation)
            self.progress = Progress(self.case.start, self.case.run.until)
            self.info |= self._versions(simulation)
            self.info["start_s"] = clock.perf_counter() - self.began
            self._write_info()
        self.watch(simulation)

    def _open_tables(self, simulation):
        self.tables = {}
        for name, (columns, units) in TABLES.items():
            columns = ["step", "time", *(["dt"] if name == "energy" else []), *columns.split()]
            self.tables[name] = Table(self.out / "series" / f"{name}.csv", columns,
                                      ["-", "s", *[units] * (len(columns) - 2)])

    def watch(self, simulation):
        """Look at the simulation after a step; write what is due."""
        if self.main:
            self.progress.step(simulation.step_count, simulation.time, simulation.dt, simulation.active)
        with simulation.timers("output"):
            if simulation.time >= self.next_row:
                self.next_row = _next(simulation.time, self.case.output.series)
                self._rows(simulation)
            if simulation.time >= self.next_frame:
                self.next_frame = _next(simulation.time, self.case.output.frames)
                self._frame(simulation)

    def _rows(self, simulation):
        rows = self.measure.rows(simulation)
        if not self.main:
            return
        for name, lines in rows.items():
            for line in lines:
                self.tables[name].row(simulation.step_count, simulation.time, *line)
            self.tables[name].flush()

    def _frame(self, simulation):
        number, step, time = len(self.frames["water"]), simulation.step_count, simulation.time
        p, at = simulation.domain.particles, simulation.near.fluid
        name = f"frames/water_{number:06d}.vtkhdf"
        self.frames["water"].append((name, time))
        arrays = [np.stack([p.x[at], p.y[at], p.z[at]], 1), p.id[at], np.stack([p.u[at], p.v[at], p.w[at]], 1),
                  p.p[at], p.surface[at], p.n[at] / simulation.scheme.lattice.number]
        self._stream(name, simulation.fluid_count, arrays, time, step)
        if self.main and len(simulation.bodies.mass):
            name = f"frames/bodies_{number:06d}.vtkhdf"
            self.frames["bodies"].append((name, time))
            fields = {field: getattr(simulation.bodies, field) for field in _BODY}
            write_bodies(self.out / name, *simulation.bodies.surface(), fields, time, step)
        if self.main:
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

    def finish(self, simulation):
        """Last frame and row if they are not written yet, then the account of the run."""
        if self.frames["water"][-1][1] < simulation.time:
            self._frame(simulation)
        self._account(simulation)

    def _account(self, simulation):
        wall = clock.perf_counter() - simulation.timers.start
        rows = self.measure.rows(simulation)
        if not self.main:
            return
        for table in self.tables.values():
            table.close()
        self.progress.close("done", simulation.step_count, simulation.time)
        counts = dict(zip(TABLES["counts"][0].split(), rows["counts"][0], strict=True))
        cores = self.info["ranks"] * self.info["threads"]
        self.info |= {
            "status": "done", "steps": simulation.step_count, "time": simulation.time, "wall_s": wall,
            "lost": counts["lost"], "leaks": {k: counts[k] for k in ("in_walls", "in_bodies", "in_gate")},
            "phases": dict(simulation.timers.seconds), "rebuilds": simulation.rebuilds,
            "uneven": dict(zip(("mean", "most"), simulation.uneven, strict=True)),
            "rate": {"active_particle_steps_per_s_per_core": self.progress.work / wall / cores,
                     "active_particle_steps": self.progress.work, "all": counts["all"]},
        }
        self._write_info()

    def _versions(self, simulation):
        import numba

        return {
            "case_name": self.source.stem, "ranks": self.comm.size, "threads": numba.get_num_threads(),
            "host": platform.node(), "warnings": list(self.case.warnings()),
            "kernel": variant.chosen(), "processor": os.environ.get("NUMBA_CPU_NAME", "host"),
            "versions": {"python": platform.python_version(), "mpi": self.comm.library,
                         **{name: version(name) for name in ("numpy", "numba", "h5py", "mpi4py")}},
            "particles": {"fluid": simulation.fluid_count, "active": simulation.active,
                          "wall": len(simulation.models.walls), "body": len(simulation.models.samples)},
        }

    def _write_info(self):
        write_text(self.out / "run.json", json.dumps(self.info, indent=1) + "\n")


def _next(time, every):
    """The next multiple of `every` after `time`, s."""
    due = (np.floor(time / every + 1e-9) + 1.0) * every
    return due if time >= 0 else min(due, 0.0)
