"""Points x y z in columns (.xyz, .txt, .csv): on a grid as they are, others with triangles between them by SciPy."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from parsim.errors import InputError
from parsim.terrain.height_field import HeightField, even
from parsim.terrain.triangles import Triangles

if TYPE_CHECKING:
    from pathlib import Path

_COMMA = re.compile(r"[-+]?\d+(,\d*)?")  # a number whose decimals stand behind a comma, or that a comma ends
_HEADS = (  # each with the axis that a name stands for
    {"x": 0, "y": 1, "z": 2},
    dict.fromkeys(("easting", "east", "e"), 0)
    | dict.fromkeys(("northing", "north", "n"), 1)
    | dict.fromkeys(("elevation", "elev", "height", "z"), 2),
)
_FULL = 0.5  # share of the nodes of a grid from which points are taken for one with holes


def read(path: Path) -> HeightField | Triangles:
    """The surface through the points of a file. Raises InputError.

    Lines before the first numbers are passed over, but that one which names x, y and z, or easting, northing and
    elevation, says in which columns they are.
    """
    rows, begun, columns = [], False, [0, 1, 2]
    for number, line in enumerate(path.read_text(encoding="utf-8-sig").split("\n"), 1):
        text, place = line.partition("#")[0].strip(), f"{path}: line {number}: {line.strip()[:60]}"
        parts, cells = text.replace(";", " ").split(), text.split(";" if ";" in text else ",")
        # an empty cell is a hole, where each holds one word
        whole = len(cells) > 2 and all(len(cell.replace(",", " ").split()) < 2 for cell in cells)
        words = [cell.strip() for cell in cells] if whole else " ".join(parts).replace(",", " ").split()
        if not any(words):
            continue
        try:
            rows.append([float(words[at] or "nan") for at in columns if at < len(words)])
        except ValueError:
            if begun:
                raise InputError(f"{place}: must be numbers x, y, z") from None
            columns = _columns(words) or columns
            continue
        begun = True
        if len(rows[-1]) < 3:
            raise InputError(f"{place}: must be three numbers x, y, z")
        if len(parts) > 2 and all(map(_COMMA.fullmatch, parts[:3])) and any("," in part[:-1] for part in parts[:3]):
            raise InputError(f"{place}: must have its decimals behind points, not commas")
    points = np.array(rows).reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) < 3:
        raise InputError(f"{path}: holds {len(points)} points; a surface needs three or more")
    return _grid(points) or _triangles(path, points)


def _columns(words):
    """The columns of x, y and z among named ones, None where one is missing or there twice."""
    for names in _HEADS:
        axes = [names.get(word.strip("\"'").lower()) for word in words]
        if all(axes.count(axis) == 1 for axis in range(3)):
            return [axes.index(axis) for axis in range(3)]
    return None


def _grid(points):
    """The grid that points are on, with holes where some are missing, or None."""
    (x, i), (y, j) = (np.unique(points[:, axis], return_inverse=True) for axis in (0, 1))
    if not (even(x) and even(y)) or len(points) < _FULL * len(x) * len(y):
        return None
    z = np.full((len(x), len(y)), np.nan)
    z[i, j] = points[:, 2]
    return HeightField(x, y, z)


def _triangles(path, points):
    try:
        from scipy.spatial import Delaunay, QhullError
    except ImportError:
        raise InputError(
            f'{path}: its points are on no grid; triangles between them need SciPy: pip install "parsim[terrain]"'
        ) from None
    plan = points[:, :2] - points[:, :2].mean(axis=0)
    try:
        return Triangles(points, Delaunay(plan).simplices)
    except QhullError:
        raise InputError(f"{path}: its points lie on one line; a surface needs others") from None
