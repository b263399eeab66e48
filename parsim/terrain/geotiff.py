"""GeoTIFF rasters (.tif): with rasterio, which the extra `terrain` brings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.errors import InputError
from parsim.terrain.height_field import HeightField

if TYPE_CHECKING:
    from pathlib import Path


def read(path: Path) -> HeightField:
    """The heights of a file of one band, north up, in the units of its projection. Raises InputError."""
    try:
        import rasterio
    except ImportError:
        raise InputError(
            f'{path}: GeoTIFF needs rasterio: pip install "parsim[terrain]"; or make it an ESRI ASCII raster'
        ) from None
    try:
        with rasterio.open(path) as source:
            return _heights(path, source)
    except rasterio.errors.RasterioError as error:
        raise InputError(f"{path}: cannot be read as GeoTIFF: {error}") from None


def _heights(path, source):
    turn = source.transform
    if source.count != 1:
        raise InputError(f"{path}: has {source.count} bands; heights are one band")
    if source.crs is not None and source.crs.is_geographic:
        raise InputError(f"{path}: its coordinates are degrees, {source.crs}; project it to metres (gdalwarp -t_srs)")
    if turn.is_identity:
        raise InputError(f"{path}: says nowhere where it lies; is it a GeoTIFF?")
    if turn.b or turn.d or turn.a <= 0.0 or turn.e >= 0.0:
        raise InputError(f"{path}: is turned; must have north up (gdalwarp makes it so)")
    band = source.read(1, masked=True)
    values = band.filled(0).astype(float) * source.scales[0] + source.offsets[0]
    values[np.ma.getmaskarray(band) | ~np.isfinite(values)] = np.nan
    x = turn.c + turn.a * (np.arange(source.width) + 0.5)
    y = turn.f + turn.e * (np.arange(source.height) + 0.5)
    return HeightField(x, y[::-1], values[::-1].T, (0.5 * turn.a, -0.5 * turn.e))
