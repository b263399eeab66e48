"""ESRI ASCII rasters (.asc): six lines of names and numbers, then rows of heights from north to south."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.errors import InputError
from parsim.terrain.height_field import HeightField

if TYPE_CHECKING:
    from pathlib import Path

_NEEDED, _COUNTS, _NODATA = ("ncols", "nrows", "cellsize"), ("ncols", "nrows"), "nodata_value"


def read(path: Path) -> HeightField:
    """The heights of a file in its units. Raises InputError."""
    lines = path.read_text(encoding="utf-8-sig").split("\n")
    head, count = {}, 0
    for count, line in enumerate(lines):  # noqa: B007
        words = line.split()
        if len(words) != 2 or not words[0][:1].isalpha() or words[0].lower() == "nan":
            break
        head[words[0].lower()] = _number(path, *words)
    missing = [key for key in _NEEDED if key not in head]
    places = [key for a in "xy" for key in (f"{a}llcorner", f"{a}llcenter") if key in head][:2]
    missing += [f"{a}llcorner or {a}llcenter" for a in "xy" if not any(key[0] == a for key in places)]
    if missing:
        raise InputError(f"{path}: its head lacks {', '.join(missing)}; is it an ESRI ASCII raster?")
    columns, rows, size = int(head["ncols"]), int(head["nrows"]), head["cellsize"]
    if min(columns, rows) < 1 or not size > 0.0:
        raise InputError(f"{path}: ncols = {columns}, nrows = {rows}, cellsize = {size:g}: must be greater than 0")
    try:
        values = np.array(" ".join(lines[count:]).split(), float)
    except ValueError as error:
        raise InputError(f"{path}: a height is no number: {error}") from None
    if values.size != columns * rows:
        raise InputError(
            f"{path}: holds {values.size} heights; ncols = {columns}, nrows = {rows} need {columns * rows}"
        )
    nodata = np.isclose(values, head.get(_NODATA, -9999.0), rtol=1e-6, atol=0.0)  # rows may give it with fewer digits
    values[nodata | ~np.isfinite(values)] = np.nan
    x, y = (
        head[key] + size * (np.arange(number) + (0.5 if key.endswith("corner") else 0.0))
        for key, number in zip(places, (columns, rows), strict=True)
    )
    return HeightField(x, y, values.reshape(rows, columns)[::-1].T, (0.5 * size, 0.5 * size))


def _number(path, key, word):
    try:
        value = float(word)
    except ValueError:
        raise InputError(f"{path}: {key} {word}: must be a number") from None
    if not (math.isfinite(value) or key.lower() == _NODATA):
        raise InputError(f"{path}: {key} {word}: must be finite")
    if key.lower() in _COUNTS and not value.is_integer():
        raise InputError(f"{path}: {key} {word}: must be a whole number")
    return value
