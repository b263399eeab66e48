"""A canvas of pixels with depth: filling flat faces, laying translucent colours, resampling."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from parsim.report.scene import View

LIGHT = np.array([-0.35, -0.55, 0.75]) / np.linalg.norm([-0.35, -0.55, 0.75])


class Canvas:
    """A picture of ``extent`` (left, right, bottom, top) in m, ``shape`` (rows, columns), row 0 on top.

    ``pen`` is the width in m of the dark lines along the edges of faces.
    """

    def __init__(self, extent: tuple[float, float, float, float], shape: tuple[int, int], pen: float = 0.0) -> None:
        self.extent, self.shape, self.pen = extent, shape, pen
        self.pitch = (extent[1] - extent[0]) / shape[1]
        self.across = extent[0] + (np.arange(shape[1], dtype=np.float32) + np.float32(0.5)) * self.pitch
        self.up = extent[3] - (np.arange(shape[0], dtype=np.float32) + np.float32(0.5)) * self.pitch

    def pixel(self, across: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Row and column (n,) of the pixels that points of the picture fall on."""
        row = ((self.extent[3] - up) / self.pitch).astype(np.int64)
        column = ((across - self.extent[0]) / self.pitch).astype(np.int64)
        return np.clip(row, 0, self.shape[0] - 1), np.clip(column, 0, self.shape[1] - 1)


def lay(picture: np.ndarray, where: np.ndarray, colour: np.ndarray, opacity: np.ndarray | float) -> None:
    """Lay ``colour`` (k, 3) of ``opacity`` (k,), or one for all, over the k pixels ``where`` of premultiplied RGBA."""
    cover = np.broadcast_to(np.asarray(opacity, np.float32), len(colour))[:, None]
    below = picture[where]
    picture[where] = np.hstack([colour * cover, cover]) + below * (1 - cover)


def reduced(picture: np.ndarray, factor: int) -> np.ndarray:
    """Average ``factor`` x ``factor`` pixels and divide the colour by its opacity."""
    total: Any = sum(picture[i::factor, j::factor] for i in range(factor) for j in range(factor)) / factor**2
    total[..., :3] /= np.maximum(total[..., 3:], 1e-6)
    return np.clip(total, 0, 1)


def faces(
    canvas: Canvas, view: View, points: np.ndarray, quads: np.ndarray, colours: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Depth (inf where there is nothing) and colour of opaque faces with dark edges."""
    depth, colour = np.full(canvas.shape, np.inf, np.float32), np.zeros((*canvas.shape, 3), np.float32)
    across, up, away = view.project(points)
    for quad, base in zip(quads, colours, strict=True):
        normal = np.cross(points[quad[1]] - points[quad[0]], points[quad[2]] - points[quad[0]])
        normal = normal / max(np.linalg.norm(normal), 1e-300)
        facing = np.dot(normal, view.away)
        if abs(facing) > 1e-6:  # a face seen edge-on covers nothing
            shade = base * (0.62 + 0.45 * max(0.0, float(np.dot(normal, LIGHT) * -np.sign(facing))))
            _fill(canvas, depth, colour, np.stack([across[quad], up[quad], away[quad]]), np.minimum(shade, 1))
    return depth, colour


def _fill(canvas, depth, colour, corners, shade):
    """Fill one convex face, given the picture coordinates and depth (3, m) of its corners."""
    across, up, away = corners
    high, first = canvas.pixel(across.min(), up.max())
    low, last = canvas.pixel(across.max(), up.min())
    window = slice(high, low + 1), slice(first, last + 1)
    x, y = np.meshgrid(canvas.across[window[1]], canvas.up[window[0]])
    # inside a convex polygon all distances to its edges have one sign
    to_edge = np.full(x.shape, np.inf)
    area = np.sum(across * np.roll(up, -1) - np.roll(across, -1) * up)
    for i in range(len(across)):
        j = (i + 1) % len(across)
        side = across[j] - across[i], up[j] - up[i]
        length = max(np.hypot(*side), 1e-300)
        distance = np.sign(area) * (side[0] * (y - up[i]) - side[1] * (x - across[i])) / length
        to_edge = np.minimum(to_edge, distance)
    plane = np.linalg.lstsq(np.stack([across, up, np.ones_like(up)], 1), away, rcond=None)[0]
    here = plane[0] * x + plane[1] * y + plane[2]
    drawn = (to_edge >= 0) & (here < depth[window])
    dark = np.where(to_edge < 1.3 * canvas.pen, 0.35, 1.0)
    depth[window] = np.where(drawn, here, depth[window])
    colour[window] = np.where(drawn[..., None], shade * dark[..., None], colour[window])


def resampled(source: Canvas, target: Canvas, values: np.ndarray) -> np.ndarray:
    """Bilinear values of one canvas at the pixels of another."""
    row = np.clip((source.up[0] - target.up) / source.pitch, 0, source.shape[0] - 1.001)
    column = np.clip((target.across - source.across[0]) / source.pitch, 0, source.shape[1] - 1.001)
    i, j = row.astype(int), column.astype(int)
    down, right = (row - i).astype(np.float32)[:, None], (column - j).astype(np.float32)
    lines = values[i] * (1 - down) + values[i + 1] * down
    return lines[:, j] * (1 - right) + lines[:, j + 1] * right
