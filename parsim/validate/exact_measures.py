"""What is measured of a finished run against a solution that depends on time and place, for its bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.validate.series_measures import chosen, track

if TYPE_CHECKING:
    from parsim.output.reader import Run

_MODES = 400  # of series whose terms fall like 1 / n^2, or faster


def sway(
    times: np.ndarray, x: float, length: float, depth: float, gravity: float, motion: dict[str, float]
) -> np.ndarray:
    """Height, m, of the surface above rest at x, m, from one wall of a tank that sways by A sin(2 pi t / T + phase).

    Linear theory, at rest in the tank at t = 0: Faltinsen, O. M. (1978), J. Ship Res. 22(3):193-202; the formula is in
    `cases/sloshing/_sway.toml`. `motion`: amplitude, m, period, s, phase, degrees.
    """
    omega, phase = 2.0 * math.pi / motion["period"], math.radians(motion["phase"])
    n = np.arange(1, _MODES, 2)[:, None]
    k = n * math.pi / length
    steep = np.tanh(k * depth)
    own = np.sqrt(gravity * k * steep)
    forced = -4.0 * steep / (n * math.pi) * motion["amplitude"] * omega**2
    swing = np.sin(omega * times + phase) - math.sin(phase) * np.cos(own * times)
    swing -= omega / own * math.cos(phase) * np.sin(own * times)
    return (forced / (own**2 - omega**2) * swing * np.cos(k * x)).sum(axis=0)


def couette(z: np.ndarray, time: np.ndarray, height: float, viscosity: float) -> np.ndarray:
    """Velocity, over that of the upper of two plates, that begins to move at t = 0, at heights z, m, and times, s.

    Schlichting, Boundary-Layer Theory, ch. 5: the steady line, and a series of what is left of the start.
    """
    n = np.arange(1, _MODES)[:, None]
    fading = np.exp(-((n * math.pi / height) ** 2) * viscosity * time)
    return z / height + (2.0 * (-1.0) ** n / (n * math.pi) * fading * np.sin(n * math.pi * z / height)).sum(axis=0)


def off_sway(run: Run, gauge: str) -> float:
    """Root of the mean square of what a gauge is off linear theory in a tank that sways, over that of the theory."""
    case = run.case
    (place,) = (each["x"] for each in case["output"]["sensors"] if each["name"] == gauge)
    (fill,) = case["water"]["fill"]
    low, length = case["box"]["min"], case["box"]["max"][0] - case["box"]["min"][0]
    times, level = track(run, "gauges", "level", {"gauge": gauge})
    depth = fill["max"][2] - low[2]
    exact = sway(times, place - low[0], length, depth, -case["gravity"][2], case["motion"])
    return float(np.sqrt(np.mean((level - fill["max"][2] - exact) ** 2) / np.mean(exact**2)))


def off_couette(run: Run, line: str, after: float, before: float) -> float:
    """Root of the mean square of what the velocity on a line is off `couette` in a time, s, over the plate's."""
    case = run.case
    speed = case["box"]["faces"]["z_max"]["velocity"][0]
    (times, z), (_, u) = (chosen(run, "velocities", column, {"line": line}, after) for column in ("z", "u"))
    here = times <= before
    height, low = case["box"]["max"][2] - case["box"]["min"][2], case["box"]["min"][2]
    exact = couette(z[here] - low, times[here], height, case["water"]["viscosity"])
    return float(np.sqrt(np.mean((u[here] / speed - exact) ** 2)))
