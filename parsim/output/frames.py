"""Frames as VTKHDF files that ParaView and VTK open: water as points, bodies as closed surfaces, and the time index.

Format: VTKHDF PolyData 2.3 (https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/). Every file is written
under a temporary name, flushed to the disk and renamed, so that a file that is there is complete. Positions are float64
and stored plainly: they hardly compress (a fifth smaller for twenty times the time); only the connectivity is packed.
"""

from __future__ import annotations

import errno
import json
import math
import os
import re
import shutil
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import h5py
import numpy as np

from parsim.errors import WriteError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from types import TracebackType

    from numpy.typing import ArrayLike, DTypeLike

VERSION = (2, 3)
TOPOLOGIES = ("Vertices", "Lines", "Polygons", "Strips")
PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True, "chunks": True}
PART = 65536
_OVERHEAD = 65536  # bytes of a file besides its points
HDF5_REASON = re.compile(r"error message = '([^']*)'")
NO_CELLS = np.zeros(0, np.int64), np.zeros(1, np.int64)


@contextmanager
def replacing(path: Path | str, size: float = 0) -> Iterator[Path]:
    """Give a temporary name beside ``path``; on success flush it to the disk and rename it, on failure remove it.

    A disk without room for ``size`` bytes is refused beforehand, for HDF5 does not bear one that fills up. Raises
    WriteError where the operating system (or HDF5) refuses to write; other exceptions pass through.
    """
    path = Path(path)
    part = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(exist_ok=True)  # not its parents: the output folder may have been moved away
        if shutil.disk_usage(path.parent).free < size:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        yield part
        _flush(part)
        os.replace(part, path)
        _flush(path.parent)
    except OSError as error:
        raise WriteError(path, _reason(error, part)) from error
    except RuntimeError as error:
        # HDF5 reports a full disk that it meets while closing a file as a RuntimeError
        if not HDF5_REASON.search(str(error)):
            raise
        raise WriteError(path, _reason(error, part)) from error
    finally:
        with suppress(OSError):
            part.unlink()


def _reason(error, part):
    """What the operating system said, also out of HDF5's long message, and of which file when it is another."""
    if found := HDF5_REASON.search(str(error)):
        return found.group(1)
    other = getattr(error, "filename", None)
    place = f" ({other})" if other and Path(other) != part else ""
    return f"{error.strerror or error}{place}"


def _flush(path):
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_text(path: Path | str, text: str) -> None:
    """Write ``text`` to ``path`` by way of a temporary name. Raises WriteError."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def specification(fields: Mapping[str, np.ndarray]) -> dict[str, tuple[np.dtype, tuple[int, ...]]]:
    """The (dtype, shape of one row) of each array in ``fields``: what :class:`WaterFrame` wants to know beforehand."""
    return {name: (values.dtype, values.shape[1:]) for name, values in fields.items()}


class WaterFrame:
    """A frame of ``total`` points written part after part, so that memory holds one part only.

    ``fields`` maps each name to (dtype, shape of one row), e.g. ``{"velocity": (float, (3,))}``. Use as a context
    manager; leaving it normally completes the file, leaving it by an exception removes it.
    Raises WriteError when the file cannot be written, ValueError when the parts do not add up to ``total``.
    """

    def __init__(
        self,
        path: Path | str,
        total: int,
        fields: Mapping[str, tuple[DTypeLike, tuple[int, ...]]],
        time: float,
        step: int,
    ) -> None:
        self.total, self.filled = int(total), 0
        row = 40 + sum(np.dtype(dtype).itemsize * math.prod(shape) for dtype, shape in fields.values())
        self._guard: Any = replacing(path, _OVERHEAD + row * self.total)  # None once it is left
        part = self._guard.__enter__()
        with self._cleaned():
            self._file = h5py.File(part, "w")
            vertices = np.arange(self.total), np.arange(self.total + 1)
            root = _root(self._file, self.total, time, step, Vertices=vertices)
            self._points = root.create_dataset("Points", (self.total, 3), np.float64)
            group = root.create_group("PointData")
            self._fields = {
                name: group.create_dataset(name, (self.total, *shape), dtype) for name, (dtype, shape) in fields.items()
            }

    def append(self, points: np.ndarray, fields: Mapping[str, np.ndarray]) -> None:
        """Add ``points`` (m, 3) in metres and the ``fields`` of the same m points."""
        rows = slice(self.filled, self.filled + len(points))
        with self._cleaned():
            if rows.stop > self.total or fields.keys() != self._fields.keys():
                raise ValueError(f"a part of {len(points)} points with {sorted(fields)} does not fit this frame")
            self._points[rows] = points
            for name, values in fields.items():
                self._fields[name][rows] = values
        self.filled = rows.stop

    def close(self) -> None:
        """Complete the file: flush it and give it its name."""
        with self._cleaned():
            if self.filled != self.total:
                raise ValueError(f"{self.filled} of {self.total} points were given")
            self._file.close()
        self._guard.__exit__(None, None, None)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        elif self._guard is not None:
            self._abandon(error)

    @contextmanager
    def _cleaned(self):
        try:
            yield
        except BaseException as error:
            self._abandon(error)
            raise

    def _abandon(self, error):
        guard, self._guard = self._guard, None
        try:
            if getattr(self, "_file", None):
                self._file.close()
        except (OSError, RuntimeError):
            pass  # the first error is the one to tell
        if guard is not None:
            guard.__exit__(type(error), error, error.__traceback__)


def write_water(path: Path | str, points: np.ndarray, fields: Mapping[str, np.ndarray], time: float, step: int) -> None:
    """Write one frame of water: ``points`` (n, 3) in m, ``fields`` name -> array (n,) or (n, k).

    Usual fields: id int64, velocity (n, 3) m/s, pressure Pa, class uint8 (0 internal, 1 near the surface, 2 surface,
    3 detached, 4 shut in between solids), density_ratio. Raises WriteError.
    """
    fields = {name: np.asarray(values) for name, values in fields.items()}
    with WaterFrame(path, len(points), specification(fields), time, step) as frame:
        for first in range(0, len(points), PART):
            rows = slice(first, first + PART)
            frame.append(points[rows], {name: values[rows] for name, values in fields.items()})


def write_bodies(
    path: Path | str,
    points: np.ndarray,
    quads: ArrayLike,
    body: ArrayLike,
    fields: Mapping[str, np.ndarray],
    time: float,
    step: int,
) -> None:
    """Write the closed surfaces of all bodies.

    ``points`` (m, 3) in m, ``quads`` (k, 4) indices into them, counter-clockwise seen from outside, ``body`` (k,) the
    body each face belongs to; ``fields`` name -> array (nb, ...) of poses, velocities and loads, kept as field data.
    Raises WriteError.
    """
    quads = np.asarray(quads, np.int64)
    with replacing(path) as part, h5py.File(part, "w") as file:
        faces = quads.ravel(), np.arange(len(quads) + 1) * 4
        root = _root(file, len(points), time, step, Polygons=faces)
        root["Points"] = np.asarray(points, np.float64)
        root.create_group("CellData")["body"] = np.asarray(body, np.int32)
        for name, values in fields.items():
            root["FieldData"][name] = np.asarray(values)


def _root(file, total, time, step, **cells):
    """The VTKHDF group with its attributes, field data and topologies; ``cells``: kind -> (connectivity, offsets)."""
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = np.array(VERSION, np.int64)
    root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", len(b"PolyData")))
    root["NumberOfPoints"] = np.array([total])
    root["FieldData/time"] = np.array([time], np.float64)
    root["FieldData/step"] = np.array([step], np.int64)
    for kind in TOPOLOGIES:
        _topology(root.create_group(kind), *cells.get(kind, NO_CELLS))
    return root


def _topology(group, connectivity, offsets):
    """One kind of cells: cell i has the points connectivity[offsets[i]:offsets[i+1]]."""
    options = PACKED if len(connectivity) > PART else {}
    group["NumberOfCells"] = np.array([len(offsets) - 1])
    group["NumberOfConnectivityIds"] = np.array([len(connectivity)])
    group.create_dataset("Connectivity", data=connectivity, **options)
    group.create_dataset("Offsets", data=offsets, **options)


def write_index(path: Path | str, entries: Iterable[tuple[str, float]]) -> None:
    """Write the ``.series`` index that ParaView opens: ``entries`` are (file name, time in s). Raises WriteError."""
    files = [{"name": name, "time": float(time)} for name, time in entries]
    write_text(path, json.dumps({"file-series-version": "1.0", "files": files}, indent=1) + "\n")


def read_index(path: Path | str) -> list[tuple[str, float]]:
    """The (file name, time in s) pairs of a ``.series`` index; none when there is no such file yet."""
    path = Path(path)
    if not path.exists():
        return []
    return [(entry["name"], entry["time"]) for entry in json.loads(path.read_text(encoding="utf-8"))["files"]]
