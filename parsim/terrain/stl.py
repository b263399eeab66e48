"""Surfaces of triangles (.stl), open or closed: heights only."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.errors import InputError
from parsim.terrain.triangles import Triangles

if TYPE_CHECKING:
    from pathlib import Path


def read(path: Path) -> Triangles:
    """The triangles of a file in its units. Raises InputError."""
    import trimesh  # takes long

    try:
        with path.open("rb") as file:
            surface: Any = trimesh.load(file, file_type="stl", process=False, force="mesh")
    except (ValueError, KeyError, IndexError, TypeError) as error:
        raise InputError(f"{path}: cannot be read as stl: {error}") from None
    points = np.array(surface.vertices, float)
    if not len(surface.faces) or not np.isfinite(points).all():
        raise InputError(f"{path}: holds no triangles, or what is no number")
    return Triangles(points, np.array(surface.faces, int))
