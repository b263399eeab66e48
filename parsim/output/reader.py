"""The public reader of an output folder: frames, series and case as numpy arrays, read when asked for."""

from __future__ import annotations

import csv
import json
import operator
import tomllib
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from parsim.errors import InputError, nearest, suggestion
from parsim.output.frames import read_index

MARK = "run.json"  # the first file that a run writes
KINDS = ("water", "bodies")  # of frames
WORDS = {"body", "filter", "gauge", "kind", "line", "patch", "probe", "section", "sensor", "what"}  # columns of text

MENDED = "`parsim resume`, of a run that is done with a later --until, writes it anew from the newest checkpoint on"


def open(folder: Path | str) -> Run:
    """Open the output folder of a run and return a :class:`Run`.

    Raises InputError when the folder is not one, naming the nearest that is.
    """
    folder = Path(folder)
    if not is_output(folder):
        raise InputError(_refusal(folder))
    return Run(folder)


def is_output(folder: Path) -> bool:
    """Whether a run has written the folder."""
    return (folder / MARK).is_file() or any(folder.glob("checkpoints/*.h5"))


def _refusal(folder):
    """Why a folder is no output, and which one was perhaps meant: one that holds it, one in it, one named like it."""
    missing = "is a file" if folder.is_file() else "there is no such folder"
    reason = f"holds neither {MARK} nor a checkpoint" if folder.is_dir() else missing
    beside = {path.parent.name: path.parent for path in folder.parent.glob(f"*/{MARK}")}
    related = [place for place in folder.parents if (place / MARK).is_file()]
    related += sorted(path.parent for path in folder.glob(f"*/{MARK}"))
    meant = related[0] if related else beside.get(nearest(folder.name, beside))
    return f"OUT = {folder}: not an output folder of parsim ({reason}){suggestion(meant)}"


class Run:
    """One output folder, opened for reading. Nothing is read before it is asked for; SI units throughout.

    >>> run = parsim.open("runs/ice")
    >>> water = run.water(-1)                       # the last frame
    >>> water["position"].shape, water["time"]
    >>> energy = run.series("energy")
    >>> energy["time"], energy["total"]
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)

    def __repr__(self) -> str:
        frames = ", ".join(f"{self._held(kind)} of {kind}" for kind in KINDS)
        status, series = self.info.get("status", "status unknown"), ", ".join(self.series_names) or "none"
        return f"<parsim run in {self.folder}: {status}; frames: {frames}; series: {series}>"

    @cached_property
    def case(self) -> dict[str, Any]:
        """The completed case (case.toml) as a dict; empty when the run was stopped before writing it.

        Raises InputError where it is damaged."""
        path = self.folder / "case.toml"
        try:
            return tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: cannot be read as the case of a run ({error}); {MENDED}") from None

    @cached_property
    def info(self) -> dict[str, Any]:
        """What the run says of itself (run.json): status, versions, ranks, steps, phases, rates, warnings.

        Empty where that cannot be read."""
        try:
            info = json.loads((self.folder / MARK).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return info if isinstance(info, dict) else {}

    @cached_property
    def body_names(self) -> list[str]:
        """Names of the bodies in the order of every array over bodies."""
        return [body["name"] for body in self.case.get("bodies", [])]

    @cached_property
    def series_names(self) -> list[str]:
        """Names of the series there are, e.g. ["bodies", "counts", "energy"]."""
        return sorted(path.stem for path in (self.folder / "series").glob("*.csv"))

    def times(self, kind: str = "water") -> np.ndarray:
        """Times (frames,) in s of the frames of ``kind``, "water" or "bodies". Raises InputError for another kind."""
        return np.array([time for _, time in self._frames(kind)], float)

    def nearest(self, time: float, kind: str = "water") -> int:
        """Index of the frame nearest to ``time`` (s). Raises InputError when there is no frame, or no such kind."""
        times = self.times(kind)
        if not isinstance(time, int | float | np.number):
            raise InputError(f"time = {time!r}: must be a number, s; OUT = {self.folder} has {self._held(kind)}")
        if not len(times):
            raise InputError(f"OUT = {self.folder}: holds no frames of {kind}")
        return int(np.argmin(np.abs(times - time)))

    def water(self, frame: int) -> dict[str, Any]:
        """One frame of water, as a dict; -1 is the last. Raises InputError for a frame there is not.

        time (s), step; position (n, 3) m, id (n,), velocity (n, 3) m/s, pressure (n,) Pa, class (n,) with 0 internal,
        1 near the surface, 2 surface, 3 detached, 4 shut in between solids, density_ratio (n,) of the number density to
        its reference.
        """
        with self._frame("water", frame) as file:
            root = file["VTKHDF"]
            return {**_common(root), "position": root["Points"][:], **_arrays(root["PointData"])}

    def bodies(self, frame: int) -> dict[str, Any]:
        """One frame of bodies, as a dict; -1 is the last. Raises InputError for a frame there is not.

        time (s), step; points (m, 3) m and quads (k, 4) of the surfaces, body (k,) of each face; per body position
        (nb, 3) m, quaternion (nb, 4) as w, x, y, z, velocity (nb, 3) m/s, spin (nb, 3) rad/s, and the loads (nb, 6),
        forces in N and torques in N m.
        """
        with self._frame("bodies", frame) as file:
            root = file["VTKHDF"]
            quads = root["Polygons/Connectivity"][:].reshape(-1, 4)
            return {**_common(root), "points": root["Points"][:], "quads": quads, **_arrays(root["CellData"])}

    def series(self, name: str) -> dict[str, np.ndarray]:
        """One series as a dict of columns (rows,): int64, float64 or text. Units are in :meth:`units`.

        A last row that a stopped run left unfinished is not read. Raises InputError for a name there is not, and for a
        table that is damaged.
        """
        titles, rows = self._table(name)[1:]
        columns = zip(*rows, strict=True) if rows else [()] * len(titles)
        return {title: _typed(title, values) for title, values in zip(titles, columns, strict=True)}

    def units(self, name: str) -> dict[str, str]:
        """The unit of each column of a series, as a dict of texts. Raises InputError for a name there is not."""
        units, titles, _ = self._table(name)
        return dict(zip(titles, units, strict=True))

    def _frame(self, kind, frame):
        entries = self._frames(kind)
        try:
            path = self.folder / entries[operator.index(frame)][0]
        except (TypeError, IndexError):
            raise InputError(
                f"frame = {frame!r}: must be the number of a frame, 0 the first and -1 the last; "
                f"OUT = {self.folder} has {self._held(kind)} of {kind}"
            ) from None
        try:
            return h5py.File(path, "r")
        except OSError as error:
            raise InputError(f"{path}: cannot be read as a frame ({error})") from error

    def _frames(self, kind):
        """File and time of each frame of a kind."""
        if kind not in KINDS:
            raise InputError(
                f"kind = {kind!r}: no such frames; must be {' or '.join(map(repr, KINDS))}"
                + suggestion(nearest(str(kind), KINDS))
            )
        path = self.folder / f"{kind}.vtkhdf.series"
        try:
            return read_index(path)
        except (OSError, ValueError, LookupError, TypeError):
            raise InputError(f"{path}: cannot be read as an index of frames; {MENDED}") from None

    def _held(self, kind):
        """How many frames of a kind there are and of what times, in words."""
        times = self.times(kind)
        return f"{len(times)} ({times[0]:g} to {times[-1]:g} s)" if len(times) else "none"

    def _table(self, name):
        path = self.folder / "series" / f"{name}.csv"
        if not path.is_file():
            there = ", ".join(self.series_names) or "none"
            raise InputError(
                f"series = {name!r}: not in {path.parent}; there are: {there}"
                + suggestion(nearest(str(name), self.series_names))
            )
        # what follows the last line end is a row that was being written
        lines = path.read_text(encoding="utf-8", errors="replace").split("\n")[:-1]
        if len(lines) < 2:
            raise InputError(f"{path}: has no line of units and names of columns; {MENDED}")
        units = lines[0].removeprefix("# units: ").split(", ")
        titles, *rows = csv.reader(lines[1:])
        for number, row in enumerate(rows, 3):
            if len(row) != len(titles):
                raise InputError(f"{path}: line {number} has {len(row)} values for {len(titles)} columns; {MENDED}")
        return units, titles, rows


def _common(root):
    """The field data: time and step as numbers, the rest as arrays."""
    fields = _arrays(root["FieldData"])
    return fields | {"time": float(fields["time"][0]), "step": int(fields["step"][0])}


def _arrays(group):
    return {name: values[:] for name, values in group.items()}


def _typed(title, texts):
    for kind in (np.int64, np.float64) if title not in WORDS else ():  # "inf" may be the name of a gauge
        try:
            return np.array(texts, dtype=kind) if len(texts) else np.zeros(0)
        except ValueError:
            continue
    return np.array(texts, dtype=str)
