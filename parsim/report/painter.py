"""Paint a scene with numpy alone, for machines without a GL library: depth buffers, smoothed water, layered colours.

The water is drawn in screen space (van der Laan, Green & Sainz 2009): particles are splatted as spheres into a depth
map, the map is smoothed where it is continuous, and its slope and thickness give shade and tint.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.report.raster import LIGHT, Canvas, faces, lay, reduced, resampled
from parsim.report.scene import BOX_FACES, box_corners

if TYPE_CHECKING:
    from parsim.report.scene import Scene, View

SHALLOW, DEEP = np.array([0.56, 0.80, 0.95], np.float32), np.array([0.07, 0.33, 0.60], np.float32)
GATE_COLOUR, GATE_OPACITY = np.array([[0.42, 0.44, 0.47]]), 0.6
ABSORPTION = 10.0  # 1/m, chosen so that a block behind half a tank of water is still seen
SURFACE_OPACITY = 0.50
CELLS_PER_SPACING = 3
FAR = 1e9


def paint(
    scene: Scene, view: View, width: int = 1200, oversampling: int = 2
) -> tuple[np.ndarray, tuple[float, float, float, float]]:
    """The picture as RGBA (rows, width, 4) in 0..1 and its extent (left, right, bottom, top) in m."""
    extent = view.extent(scene)
    pitch = (extent[1] - extent[0]) / (width * oversampling)
    rows = oversampling * max(1, round((extent[3] - extent[2]) / pitch / oversampling))
    box = (extent[0], extent[1], extent[3] - rows * pitch, extent[3])
    canvas = Canvas(box, (rows, width * oversampling), pen=1.3 * oversampling * pitch)
    solid, colour = faces(canvas, view, scene.points, scene.quads, scene.colours[scene.body])
    picture = np.zeros((*canvas.shape, 4), np.float32)
    lay(picture, np.isfinite(solid), colour[np.isfinite(solid)], 1.0)
    gate, colour = _gate(canvas, view, scene)
    water = _water(canvas, view, scene, solid)
    behind, before = (gate < solid) & (gate > water[0]), (gate < solid) & (gate <= water[0])
    lay(picture, behind, colour[behind], GATE_OPACITY)
    lay(picture, *water[1:])
    lay(picture, before, colour[before], GATE_OPACITY)
    return reduced(picture, oversampling), box


def _gate(canvas, view, scene):
    corners = box_corners(*scene.gate) if scene.gate else np.zeros((0, 3))
    quads = BOX_FACES if scene.gate else BOX_FACES[:0]
    return faces(canvas, view, corners, quads, np.repeat(GATE_COLOUR, len(quads), 0))


def _water(canvas, view, scene, solid):
    """Depth of the water in front of the ``solid`` depth (inf elsewhere), where it is, its colour and opacity there."""
    pitch, extent = scene.spacing / CELLS_PER_SPACING, canvas.extent
    rows, across = (int(np.ceil((extent[i + 1] - extent[i]) / pitch)) + 1 for i in (2, 0))
    coarse = Canvas((extent[0], extent[0] + across * pitch, extent[3] - rows * pitch, extent[3]), (rows, across))
    front, thickness = _splatted(coarse, view, scene)
    covered = np.isfinite(front)
    front = _smoothed(np.where(covered, front, FAR).astype(np.float32), 2 * scene.spacing)
    layers = [np.where(covered, front, 0), covered, thickness, *_shaded(front, covered, view, pitch)]
    front, cover, thickness, bright, shine = (
        resampled(coarse, canvas, np.asarray(layer, np.float32)) for layer in layers
    )
    depth = np.where(cover > 0.5, front / np.maximum(cover, 0.5), np.inf)
    where = depth < solid
    seen = np.minimum(thickness[where], solid[where] - depth[where])
    clear = np.exp(-ABSORPTION * seen)
    colour = (DEEP + (SHALLOW - DEEP) * clear[:, None]) * bright[where][:, None] + shine[where][:, None]
    return np.where(where, depth, np.inf), where, np.minimum(colour, 1), 1 - (1 - SURFACE_OPACITY) * clear


def _splatted(canvas, view, scene):
    """Nearest depth of the particles drawn as spheres, and thickness (m) of the water along the line of sight."""
    across, up, away = view.project(scene.water)
    row, column = canvas.pixel(across, up)
    flat = row * canvas.shape[1] + column
    nearest = np.full(canvas.shape[0] * canvas.shape[1], np.inf)
    np.minimum.at(nearest, flat, away)
    count = np.bincount(flat, minlength=len(nearest)).reshape(canvas.shape)
    thickness = count * scene.spacing**3 / canvas.pitch**2
    for _ in range(3):
        thickness = _box(thickness, CELLS_PER_SPACING)
    nearest, radius = nearest.reshape(canvas.shape), 0.85 * CELLS_PER_SPACING
    front, reach = np.full(canvas.shape, np.inf), int(radius)
    padded = np.pad(nearest, reach, constant_values=np.inf)
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            if i * i + j * j <= radius * radius:
                bulge = np.sqrt(radius * radius - i * i - j * j) * canvas.pitch
                window = padded[reach + i :, reach + j :][: canvas.shape[0], : canvas.shape[1]]
                front = np.minimum(front, window - bulge)
    return front, thickness


def _box(values, reach):
    """Mean over 2 reach + 1 pixels both ways, by running sums."""
    for axis in (0, 1):
        wide = [(reach + 1, reach) if a == axis else (0, 0) for a in (0, 1)]
        total = np.cumsum(np.pad(values, wide), axis=axis)
        size = 2 * reach + 1
        total = np.moveaxis(total, axis, 0)
        values = np.moveaxis((total[size:] - total[:-size]) / size, 0, axis)
    return values


def _smoothed(depth, jump, rounds=16):
    """Average each depth with its four neighbours, leaving out those farther than ``jump`` (m)."""
    for _ in range(rounds):
        padded = np.pad(depth, 1, mode="edge")
        total, weight = np.zeros_like(depth), np.ones_like(depth)
        for i, j in ((0, 1), (2, 1), (1, 0), (1, 2)):
            beside = padded[i : i + depth.shape[0], j : j + depth.shape[1]]
            difference = beside - depth
            near = np.abs(difference) < jump
            total += difference * near
            weight += near
        depth = depth + total / weight
    return depth


def _shaded(depth, covered, view, pitch):
    """Brightness and shine of the water from the slope of its depth map."""
    slope_up, slope_across = np.gradient(depth, pitch)
    steep = np.hypot(slope_up, slope_across) > 8
    slope_up, slope_across = np.where(steep, 0, -slope_up), np.where(steep, 0, slope_across)
    length = np.sqrt(1 + slope_up**2 + slope_across**2)
    axes = np.array([view.right, view.up, view.away])
    normal = (slope_across[..., None] * axes[0] + slope_up[..., None] * axes[1] - axes[2]) / length[..., None]
    lit = normal @ LIGHT
    half = LIGHT - axes[2]
    shine = np.clip(normal @ (half / np.linalg.norm(half)), 0, 1) ** 40
    return covered * (0.55 + 0.50 * np.clip(lit, 0, 1)), covered * 0.22 * shine
