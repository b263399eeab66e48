"""Ground from files: readers of heights, one file for each format, and the surfaces that they give."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.errors import InputError, nearest, suggestion
from parsim.terrain import ascii, geotiff, hecras, stl, xyz
from parsim.terrain.height_field import HeightField
from parsim.terrain.triangles import Triangles

if TYPE_CHECKING:
    from pathlib import Path

Surface = HeightField | Triangles
READERS = {"asc": ascii, "tif": geotiff, "tiff": geotiff, "xyz": xyz, "txt": xyz, "csv": xyz, "stl": stl}
FORMATS = (*READERS, "g01 to g99")


def read(path: Path, layout: str = "straight", reach: str | None = None) -> Surface:
    """The surface in a file, in its own coordinates and units; `layout`, `reach`: see `hecras`. Raises InputError."""
    kind = path.suffix[1:].lower()
    if not is_ground(path):
        raise InputError(
            f"{path}: no format of ground; allowed: {', '.join(FORMATS)}{suggestion(nearest(kind, READERS, 0.5))}"
        )
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        return hecras.surface(path, layout, reach) if sections_in(path) else READERS[kind].read(path)
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from None


def sections_in(path: Path) -> bool:
    """Whether a file is HEC-RAS geometry by its name: .g01 to .g99."""
    kind = path.suffix[1:].lower()
    return len(kind) == 3 and kind[0] == "g" and kind[1:].isdecimal()


def is_ground(path: Path) -> bool:
    """Whether a file holds ground by its name."""
    return sections_in(path) or path.suffix[1:].lower() in READERS
