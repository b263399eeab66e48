"""Checkpoints: the state of a run at a step that rebuilds its lists, each one HDF5 file that proves itself whole.

A file begins with a block of text: what it is, and the length and SHA-256 of all that follows, which are looked at
before HDF5 is. Every data set has a SHA-256 of its own besides. Water stands in the order of ids, so that a file does
not show how many ranks have written it. Data sets: `case` (TOML) and `account` (JSON: counters, and what the outputs
hold so far) as text, `water/` with the kept fields, `parts/` with what bodies and others keep, each under its name.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from parsim.errors import InputError
from parsim.output.frames import replacing
from parsim.particles.state import Particles, of_water, water_bytes

if TYPE_CHECKING:
    from parsim.domain.comm import Comm
    from parsim.particles.state import Field

FOLDER, SUFFIX, _PARTS = "checkpoints", ".h5", "parts"
_KIND = b"parsim checkpoint, format 6\n"
_OVERHEAD = 65536  # bytes of a file besides its water, bodies not counted
_BLOCK = 512  # bytes of the text; what HDF5 calls a user block
_PIECE = 1 << 22  # bytes hashed at a time


class Broken(Exception):
    """A checkpoint that is not what was written; the text says why."""


class Snapshot:
    """The state of a run on this rank: water (Particles), parts (by name dicts of arrays), account (dict)."""

    def __init__(self, water: Particles, parts: dict[str, dict[str, np.ndarray]], account: dict[str, Any]) -> None:
        self.water, self.parts, self.account = water, parts, account


def write(path: Path | str, case: str, snapshot: Snapshot, comm: Comm) -> None:
    """Write a snapshot; called on all ranks together, rank 0 writes. `case`: TOML text. Raises WriteError.

    At most one rank's water is in the memory of rank 0 beside its own.
    """
    water = _in_order(snapshot.water, comm)
    total, names = int(comm.sum_integers(np.array([len(water)]))[0]), of_water(water.fields)
    if comm.rank:
        for name in names:
            for _ in comm.stream(getattr(water, name)):
                pass
        return
    with replacing(path, _OVERHEAD + water_bytes(water.fields) * total) as part:
        with h5py.File(part, "w", userblock_size=_BLOCK) as file:
            _put(file, "case", _bytes(case))
            _put(file, "account", _bytes(json.dumps(snapshot.account)))
            for group, kept in snapshot.parts.items():
                for name, values in kept.items():
                    _put(file, f"{_PARTS}/{group}/{name}", values)
            for name in names:
                _put_parts(file, f"water/{name}", total, comm.stream(getattr(water, name)))
        _seal(part)


def _in_order(water, comm):
    """This rank's share of the water of all ranks, by ids: shares of ascending ids, each sorted."""
    water = water.take(np.argsort(water.id))
    if comm.size == 1:
        return water
    beyond = int(comm.max([float(water.id[-1]) if len(water) else 0.0])[0]) + 1
    ends = np.searchsorted(water.id, np.arange(comm.size + 1) * beyond // comm.size)
    ends[0], ends[-1] = 0, len(water)
    dealt = comm.deal([water.take(slice(*pair)).pack() for pair in itertools.pairwise(ends)])
    water = Particles.join([Particles.unpack(buffer, water.fields) for buffer in dealt])
    return water.take(np.argsort(water.id))


def _bytes(text):
    return np.frombuffer(text.encode(), np.uint8)


def _put(file, name, values):
    values = np.ascontiguousarray(values)
    _put_parts(file, name, len(values), [values])


def _put_parts(file, name, total, parts):
    """A data set of `total` rows that come in parts, and its checksum."""
    data: Any = None  # made with the first part
    digest, at = hashlib.sha256(), 0
    for part in parts:
        if data is None:
            data = file.create_dataset(name, (total, *part.shape[1:]), part.dtype)
        data[at : at + len(part)] = part
        digest.update(part)
        at += len(part)
    if at != total:
        raise ValueError(f"{name}: {at} of {total} rows were given")
    data.attrs["sha256"] = digest.hexdigest()


def _seal(path):
    """Write the text at the beginning of a finished file."""
    text = _KIND + b"bytes %d\nsha256 %s\n" % (path.stat().st_size, _digest(path).encode())
    with open(path, "r+b") as file:
        file.write(text.ljust(_BLOCK, b"\n"))


def _digest(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        file.seek(_BLOCK)
        while piece := file.read(_PIECE):
            digest.update(piece)
    return digest.hexdigest()


def verify(path: Path | str) -> None:
    """Raise Broken unless the file is what was written."""
    try:
        with open(path, "rb") as file:
            text = file.read(_BLOCK)
        size = os.path.getsize(path)
        kind, length, digest, *_ = text.split(b"\n")
        if kind + b"\n" != _KIND or len(text) < _BLOCK:
            raise Broken("does not begin as a checkpoint of this version of parsim does")
        if length != b"bytes %d" % size:
            raise Broken(f"has {size:,} bytes, which is not what its beginning says")
        if digest != b"sha256 " + _digest(path).encode():
            raise Broken("its checksum is wrong")
    except ValueError:
        raise Broken("is too short for a checkpoint") from None
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read: {error.strerror or error}; make it readable, or move it away to go "
            "on from the one before"
        ) from None


class Checkpoint:
    """A verified checkpoint, open for reading; attributes path, case (TOML text), account, parts.

    Raises Broken.
    """

    def __init__(self, path: Path | str, whole: bool = True) -> None:
        self.path = Path(path)
        if whole:
            verify(self.path)
        with h5py.File(self.path) as file:
            if whole:
                file.visititems(_check)
            self.case, account = (file[name][:].tobytes().decode() for name in ("case", "account"))
            self.account = json.loads(account)
            self.parts = {
                part: {name: data[()] for name, data in kept.items()} for part, kept in file.get(_PARTS, {}).items()
            }

    def snapshot(self, fields: tuple[Field, ...], rank: int, size: int) -> Snapshot:
        """The share of one of `size` ranks: every rank a run of water by ids, with such `fields`, and all parts."""
        with h5py.File(self.path) as file:
            group = file["water"]
            total = len(group["id"])
            rows = slice(total * rank // size, total * (rank + 1) // size)
            kept = {name: group[name][rows] for name in of_water(fields)}
        return Snapshot(Particles(kept["id"].size, fields, **kept), self.parts, self.account)


def _check(name, data):
    if not isinstance(data, h5py.Dataset):
        return
    digest, rows = hashlib.sha256(), max(1, _PIECE // max(1, data.dtype.itemsize * int(np.prod(data.shape[1:]))))
    for begin in range(0, len(data), rows):
        digest.update(np.ascontiguousarray(data[begin : begin + rows]).data)
    if data.attrs.get("sha256") != digest.hexdigest():
        raise Broken(f"the checksum of its data set {name} is wrong")


def listed(folder: Path | str) -> list[Path]:
    """Paths of the checkpoints in an output folder, the oldest first. Raises InputError where they cannot be seen."""
    try:
        names = os.listdir(Path(folder, FOLDER))
    except FileNotFoundError:
        return []
    except OSError as error:
        raise InputError(f"{Path(folder, FOLDER)}: cannot be read: {error.strerror or error}") from None
    paths = (Path(folder, FOLDER, name) for name in names if name.endswith(SUFFIX) and not name.startswith("."))
    return sorted((path for path in paths if path.is_file()), key=lambda path: (step_of(path), path.name))


def step_of(path: Path | str) -> int:
    """Step of a checkpoint, from its name; -1 when the name does not say."""
    number = Path(path).stem.rpartition("_")[2]
    return int(number) if number.isdecimal() else -1


def newest(folder: Path | str) -> tuple[Checkpoint | None, list[str]]:
    """The newest whole checkpoint of an output folder, or None, and a line for each broken one that is newer."""
    broken: list[str] = []
    for path in reversed(listed(folder)):
        try:
            return Checkpoint(path), broken
        except Broken as error:
            broken.append(f"{path}: {error}; it is left out")
    return None, broken
