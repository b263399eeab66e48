"""What a picture shows, for any painter: tank, gate, blocks and water at one time, and the views on them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from parsim.output.reader import Run

BODY_COLOURS = ((0.930, 0.690, 0.270), (0.878, 0.482, 0.224), (0.710, 0.251, 0.184), (0.478, 0.180, 0.180))
BOX_FACES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
BOX_EDGES = np.array([[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]])


def box_corners(low: Sequence[float] | np.ndarray, high: Sequence[float] | np.ndarray) -> np.ndarray:
    """The eight corners (8, 3) of a box, x fastest; :data:`BOX_FACES` and :data:`BOX_EDGES` index them."""
    return np.array(
        [[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for k in (0, 1) for j in (0, 1) for i in (0, 1)],
        float,
    )


def body_colours(count: int) -> np.ndarray:
    """``count`` warm colours (count, 3), light to dark."""
    at = np.linspace(0, len(BODY_COLOURS) - 1, max(count, 1))
    stops = np.array(BODY_COLOURS)
    return np.stack([np.interp(at, np.arange(len(stops)), stops[:, i]) for i in range(3)], 1)[:count]


@dataclass(frozen=True)
class Scene:
    """One moment: lengths in m; ``gate`` and tank are pairs of opposite corners, bodies are quads with their owner."""

    time: float
    spacing: float
    tank: tuple
    water: np.ndarray
    points: np.ndarray
    quads: np.ndarray
    body: np.ndarray
    position: np.ndarray
    names: tuple
    gate: tuple | None

    @cached_property
    def colours(self) -> np.ndarray:
        """One colour (nb, 3) for each body."""
        return body_colours(len(self.position))


def gate_bottom(case: Mapping[str, Any], time: float) -> float | None:
    """Height (m) of the gate's lower edge at ``time`` (s), None without a gate: at rest, then up at its speed."""
    gate = case.get("gate")
    if not gate:
        return None
    start = gate.get("bottom", case["box"]["min"][2])
    return start + gate.get("speed", 0.4) * max(0.0, time - gate.get("opens", 0.0))


def load(run: Run, frame: int) -> Scene:
    """The :class:`Scene` of one frame of ``run``."""
    water, case = run.water(frame), run.case
    low, high = (np.array(case["box"][end], float) for end in ("min", "max"))
    bodies = run.bodies(run.nearest(water["time"], "bodies")) if len(run.times("bodies")) else None
    lift, gate = gate_bottom(case, water["time"]), None
    if lift is not None and lift < high[2]:
        gate = ((case["gate"]["min_x"], low[1], lift), (case["gate"]["max_x"], high[1], high[2]))
    nothing = np.zeros((0, 3))
    return Scene(
        time=water["time"],
        spacing=case["spacing"],
        tank=(low, high),
        water=water["position"],
        points=bodies["points"] if bodies else nothing,
        quads=bodies["quads"] if bodies else np.zeros((0, 4), int),
        body=bodies["body"] if bodies else np.zeros(0, int),
        position=bodies["position"] if bodies else nothing,
        names=tuple(run.body_names),
        gate=gate,
    )


@dataclass(frozen=True)
class View:
    """A parallel projection: ``right`` and ``up`` span the picture, ``away`` points from the eye into it."""

    name: str
    right: tuple
    up: tuple
    away: tuple

    def project(self, points: np.ndarray) -> tuple[np.ndarray, ...]:
        """Picture coordinates across and up, and the distance away, each (n,) in m."""
        points = np.asarray(points, float)
        return tuple(
            points[..., 0] * axis[0] + points[..., 1] * axis[1] + points[..., 2] * axis[2]
            for axis in (self.right, self.up, self.away)
        )

    def extent(self, scene: Scene, margin: float = 0.025) -> tuple[float, float, float, float]:
        """The picture's (left, right, bottom, top) in m: the whole tank and a margin, as a share of its length."""
        across, up, _ = self.project(box_corners(*scene.tank))
        rim = margin * (across.max() - across.min())
        return across.min() - rim, across.max() + rim, up.min() - rim, up.max() + rim


def _turned(name, azimuth, elevation):
    """A view from ``azimuth`` degrees left of the front and ``elevation`` degrees above the floor."""
    a, e = np.radians(azimuth), np.radians(elevation)
    right = (np.cos(a), -np.sin(a), 0.0)
    away = (np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), -np.sin(e))
    up = (np.sin(a) * np.sin(e), np.cos(a) * np.sin(e), np.cos(e))
    return View(name, right, up, away)


FRONT = View("front", (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
TOP = View("top", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0))
OBLIQUE = _turned("oblique", 24.0, 30.0)
VIEWS = {view.name: view for view in (FRONT, TOP, OBLIQUE)}
