"""Pictures of many frames, by pyvista where it works, else by our own painter, and what is written over them."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.figure import Figure
from matplotlib.image import imread

from parsim.report.measures import MANY
from parsim.report.painter import paint
from parsim.report.scene import BOX_EDGES, FRONT, OBLIQUE, TOP, VIEWS, box_corners, load

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from matplotlib.axes import Axes

    from parsim.output.reader import Run
    from parsim.report.scene import Scene, View

START_LIMIT, PICTURE_LIMIT = 60.0, 10.0  # s; a software renderer takes 0.3 s a picture
INK, FAINT = "#1f2933", "#9aa5b1"
OUTLINE = [effects.withStroke(linewidth=2.5, foreground="white")]


@dataclass(frozen=True)
class Quality:
    """Columns of a picture, and how many times finer our own painter works."""

    width: int
    oversampling: int


SNAPSHOT, ANIMATION = Quality(1000, 2), Quality(720, 1)


class Gallery:
    """Raw pictures of a run: ``wanted`` maps (frame, view name) to a quality; ``method`` says who draws them."""

    def __init__(self, run: Run, wanted: Mapping[tuple[int, str], Quality], vtk: bool = True) -> None:
        self.run, self.wanted = run, wanted
        self.images = _by_vtk(run, wanted) if vtk and wanted else {}
        drawers = ["pyvista"] * bool(self.images) + ["our own painter"] * (len(self.images) < len(wanted))
        self.method = " and ".join(drawers) or "matplotlib"

    def picture(self, scene: Scene, frame: int, view: View) -> tuple[np.ndarray, tuple[float, float, float, float]]:
        """The picture of one frame, RGBA (rows, columns, 4) in 0..1, painted now when VTK has not; its extent in m."""
        image = self.images.get((frame, view.name))
        if image is not None:
            return image, view.extent(scene)
        quality = self.wanted[frame, view.name]
        return paint(scene, view, quality.width, quality.oversampling)


def _by_vtk(run, wanted):
    """What VTK can draw; nothing where it is missing, crashes (no GL library) or takes too long."""
    if importlib.util.find_spec("pyvista") is None:
        return {}
    with tempfile.TemporaryDirectory() as folder:
        paths = {key: str(Path(folder) / f"{key[0]}_{key[1]}.png") for key in wanted}
        jobs = [
            {
                "frame": frame,
                "view": view,
                "width": quality.width,
                "fine": quality.oversampling > 1,
                "path": paths[frame, view],
            }
            for (frame, view), quality in wanted.items()
        ]
        (Path(folder) / "jobs.json").write_text(json.dumps(jobs))
        command = [sys.executable, "-m", "parsim.report.vtk_worker", str(run.folder), f"{folder}/jobs.json"]
        try:
            limit = START_LIMIT + PICTURE_LIMIT * len(wanted)
            subprocess.run(command, capture_output=True, timeout=limit, check=False, env=_environment())
        except subprocess.TimeoutExpired:
            pass  # what is missing is painted
        return {key: imread(path) for key, path in paths.items() if Path(path).exists()}


def _environment():
    """The environment of VTK: without a screen it shall not look for X11, whose libraries it would crash without."""
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        return {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow", **os.environ}
    return None


def show(axes: Axes, gallery: Gallery, scene: Scene, frame: int, view: View, labels: bool = True) -> None:
    """Put one picture with tank, names and gate on ``axes``, whose units are then metres of the picture."""
    image, extent = gallery.picture(scene, frame, view)
    corners = view.project(box_corners(*scene.tank))
    _edges(axes, corners, hidden=True)
    axes.imshow(image, extent=extent, interpolation="antialiased", zorder=2)
    _edges(axes, corners, hidden=False)
    if labels and len(scene.names) < MANY:
        _names(axes, scene, view)
    axes.set_xlim(extent[:2])
    axes.set_ylim(extent[2:])
    axes.set_aspect("equal")
    if view is OBLIQUE:
        axes.set_axis_off()
        _ruler(axes, scene, view)
    else:
        axes.set_ylabel("z (m)" if view is FRONT else "y (m)")
        axes.tick_params(colors=INK, labelsize=8)
        axes.locator_params(axis="y", nbins=4)
        axes.spines[:].set_visible(False)


def _edges(axes, corners, hidden):
    """The tank's edges, those behind the picture or those before it: an edge at the farthest corner is behind."""
    across, up, away = corners
    farthest = np.argmax(np.round(away, 9))
    for edge in BOX_EDGES:
        if (farthest in edge) == hidden:
            axes.plot(across[edge], up[edge], color=FAINT, linewidth=0.8, zorder=1 if hidden else 3)


def _names(axes, scene, view):
    """Names of the bodies: on them from above, in a row over the water from the front."""
    there = np.unique(scene.body)  # what has left the box has no surface
    across, up, _ = view.project(scene.position if view is FRONT else _tops(scene, there))
    stacked: list[float] = []
    for body in there[np.argsort(across[there], kind="stable")]:
        place, level = up[body], 0
        if view is FRONT:
            reach = 0.04 * (scene.tank[1][0] - scene.tank[0][0])
            level = sum(abs(across[body] - other) < reach for other in stacked[-4:])
            stacked.append(across[body])
            place = up[body] + reach * (0.85 + 0.75 * level)
        axes.text(
            across[body],
            place,
            scene.names[body],
            ha="center",
            va="center",
            fontsize=9,
            fontweight="bold",
            color=INK,
            path_effects=OUTLINE,
            zorder=4,
        )


def _tops(scene, there):
    """A point in the middle of the upper side (nb, 3) of each body that is `there`."""
    centres, tops = scene.points[scene.quads].mean(1), scene.position.copy()
    for body in there:
        faces = centres[scene.body == body]
        tops[body] = faces[np.argmax(faces[:, 2])]
    return tops


def _ruler(axes, scene, view):
    """Lengths along the tank's lower front edge."""
    low, high = scene.tank
    length = high[0] - low[0]
    power = int(np.floor(np.log10(length / 2)))
    step, digits, off = 10.0**power, max(-power, 0), 0.0035 * length
    marks = np.arange(np.ceil(low[0] / step), np.floor(high[0] / step) + 1) * step
    across, up, _ = view.project(np.stack([marks, np.full(len(marks), low[1]), np.full(len(marks), low[2])], 1))
    for x, y, mark in zip(across, up, marks, strict=True):
        axes.text(x + off, y - off, f"{mark:.{digits}f} m", fontsize=7, color=INK, ha="left", va="top", zorder=4)


def snapshot(gallery: Gallery, frame: int, labels: bool = True) -> Figure:
    """A figure of one frame: oblique view above, front and top view below."""
    scene = load(gallery.run, frame)
    sizes = [view.extent(scene) for view in (OBLIQUE, FRONT, TOP)]
    heights = [(e[3] - e[2]) / (e[1] - e[0]) for e in sizes]
    figure = Figure(figsize=(9, 9 * sum(heights) + 0.8), layout="constrained")
    for axes, view in zip(figure.subplots(3, 1, height_ratios=heights), (OBLIQUE, FRONT, TOP), strict=True):
        show(axes, gallery, scene, frame, view, labels)
    figure.axes[-1].set_xlabel("x (m)")
    return figure


def wanted(run: Run, snapshots: Iterable[int], animated: Iterable[int]) -> dict[tuple[int, str], Quality]:
    """What a gallery needs for snapshots of some frames and an animation of others; nothing in two dimensions."""
    if run.case.get("dimensions") != 3:
        return {}
    needed = {(frame, view): SNAPSHOT for frame in snapshots for view in VIEWS}
    return needed | {key: ANIMATION for frame in animated if (key := (frame, OBLIQUE.name)) not in needed}
