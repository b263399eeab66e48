"""Draw scenes with pyvista; run as a program of its own, because without a working GL library VTK ends in a crash.

``python -m parsim.report.vtk_worker OUT JOBS.json`` with JOBS a list of {"frame", "view", "width", "fine",
"path"}, fine asking for smooth edges. Each picture is a PNG of RGBA that gets its name when complete, so that a crash
or a time limit leaves whole pictures.
"""

from __future__ import annotations

import json
import os
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista

import parsim
from parsim.report.raster import LIGHT
from parsim.report.scene import BOX_FACES, VIEWS, box_corners, load

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from parsim.report.scene import Scene, View

WATER, GATE = (0.20, 0.52, 0.82), (0.42, 0.44, 0.47)
EMPTY_CELLS = 3
PEELS = 3  # layers of translucent faces drawn in their right order
LONELY = 0.2  # filled share at the node of a particle with none or one beside it


def water_surface(points: np.ndarray, spacing: float) -> tuple[pyvista.PolyData, np.ndarray]:
    """The surface of the water as a smooth triangle mesh, and the drops (k, 3) that are too lonely to be part of it.

    Each particle's volume is shared among the eight nearest nodes of a grid of the particles' spacing; the surface is
    where the water fills half the space, found by marching cubes.
    """
    origin = points.min(0) - EMPTY_CELLS * spacing
    shape = tuple(np.ceil((points.max(0) - origin) / spacing).astype(int) + 1 + EMPTY_CELLS)
    cell, share = np.divmod((points - origin) / spacing, 1)
    filled = np.zeros(np.prod(shape))
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, share, 1 - share), axis=1)
        node = np.ravel_multi_index(tuple((cell + corner).astype(int).T), shape)
        filled += np.bincount(node, weight, len(filled))
    filled = filled.reshape(shape)
    for axis in range(3):
        wide = np.pad(filled, [(1, 1) if a == axis else (0, 0) for a in range(3)])
        wide = np.moveaxis(wide, axis, 0)
        filled = np.moveaxis((wide[:-2] + 2 * wide[1:-1] + wide[2:]) / 4, 0, axis)
    grid = pyvista.ImageData(dimensions=shape, spacing=(spacing,) * 3, origin=origin)
    grid.point_data["filled"] = filled.ravel(order="F")
    surface = grid.contour([0.5], "filled")
    nearest = tuple(np.rint((points - origin) / spacing).astype(int).T)
    drops = points[filled[nearest] < LONELY]
    return surface.smooth_taubin(n_iter=20, pass_band=0.1) if surface.n_cells else surface, drops


def _quads(points, quads):
    return pyvista.PolyData(points, np.hstack([np.full((len(quads), 1), 4), quads]).ravel())


def lit_plotter() -> pyvista.Plotter:
    """A plotter with its lamps, to serve all frames."""
    plotter = pyvista.Plotter(off_screen=True, lighting="none")
    plotter.add_light(pyvista.Light(position=LIGHT, intensity=0.8, light_type="scene light"))
    plotter.add_light(pyvista.Light(light_type="headlight", intensity=0.35))
    plotter.enable_depth_peeling(PEELS)
    plotter.suppress_rendering = True  # else every change draws the picture anew
    return plotter


def furnish(plotter: pyvista.Plotter, scene: Scene) -> None:
    """Put everything of one moment in the place of what was there."""
    plotter.clear_actors()
    for body, colour in enumerate(scene.colours):
        if not (scene.body == body).any():  # it has left the box
            continue
        block = _quads(scene.points, scene.quads[scene.body == body])
        plotter.add_mesh(block, color=colour, ambient=0.35, diffuse=0.75)
        plotter.add_mesh(block.extract_all_edges(), color="#3a1d10", line_width=3, lighting=False)
    if scene.gate:
        plotter.add_mesh(_quads(box_corners(*scene.gate), BOX_FACES), color=GATE, opacity=0.6, lighting=False)
    surface, drops = water_surface(scene.water, scene.spacing) if len(scene.water) else (pyvista.PolyData(), ())
    if surface.n_cells:
        plotter.add_mesh(
            surface,
            color=WATER,
            opacity=0.62,
            smooth_shading=True,
            ambient=0.25,
            diffuse=0.85,
            specular=0.35,
            specular_power=30,
        )
    if len(drops):
        ball = pyvista.Sphere(radius=scene.spacing / 2, theta_resolution=10, phi_resolution=10)
        plotter.add_mesh(pyvista.PolyData(drops).glyph(geom=ball, scale=False, orient=False), color=WATER, ambient=0.6)


def draw(plotter: pyvista.Plotter, scene: Scene, view: View, width: int, fine: bool, path: str) -> None:
    """Draw one picture of the extent the view gives the scene."""
    left, right, bottom, top = view.extent(scene)
    plotter.enable_anti_aliasing("ssaa") if fine else plotter.disable_anti_aliasing()
    plotter.window_size = (width, max(1, round(width * (top - bottom) / (right - left))))
    across, up = (left + right) / 2, (bottom + top) / 2
    corners = box_corners(*scene.tank)
    middle, far = np.mean(view.project(corners)[2]), 10 * np.ptp(corners, axis=0).max()  # what is behind it is not seen
    focus = across * np.array(view.right) + up * np.array(view.up) + middle * np.array(view.away)
    plotter.camera_position = [focus - far * np.array(view.away), focus, view.up]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = (top - bottom) / 2
    plotter.reset_camera_clipping_range()
    plotter.suppress_rendering = False
    plotter.render()
    plotter.screenshot(f"{path}.part.png", transparent_background=True)
    plotter.suppress_rendering = True
    os.replace(f"{path}.part.png", path)


def main(folder: Path | str, jobs: Sequence[dict[str, Any]]) -> None:
    """Draw the ``jobs``, those of one frame together."""
    run, plotter = parsim.open(folder), lit_plotter()
    for frame in dict.fromkeys(job["frame"] for job in jobs):
        scene = load(run, frame)
        furnish(plotter, scene)
        for job in (job for job in jobs if job["frame"] == frame):
            draw(plotter, scene, VIEWS[job["view"]], job["width"], job["fine"], job["path"])


if __name__ == "__main__":
    with open(sys.argv[2], encoding="utf-8") as file:
        main(sys.argv[1], json.load(file))
