"""What is measured of the bodies of a finished run for its bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.case.model import parse

if TYPE_CHECKING:
    from parsim.output.reader import Run


def _track(run: Run, body: str) -> dict[str, np.ndarray]:
    """Columns of the series of bodies for one of them."""
    series = run.series("bodies")
    mine = series["body"] == body
    return {name: column[mine] for name, column in series.items()}


def _gravity(run: Run) -> float:
    return math.hypot(*run.case.get("gravity", (0.0, 0.0, -9.81)))


def apex(run: Run, body: str, number: int) -> float:
    """Height, m, of the lowest point of a body that does not turn, above the floor at its apex of that number."""
    track, case = _track(run, body), parse(run.case)
    shape = next(b.shape for b in case.bodies if b.name == body)
    tops = np.flatnonzero((track["w"][:-1] > 0.0) & (track["w"][1:] <= 0.0))
    if len(tops) < number:
        return math.nan
    at = tops[number - 1]
    height = track["z"][at] + track["w"][at] ** 2 / (2.0 * _gravity(run))
    return float(height - shape.reach((0.0, 0.0, -1.0)) - case.box.min[2])


def last_speed(run: Run) -> float:
    """Largest speed of any body at the end, m/s."""
    series = run.series("bodies")
    end = series["time"] == series["time"].max()
    return float(np.sqrt(sum(series[name][end] ** 2 for name in "uvw")).max())


def mean_place(run: Run, axis: str, time: float, over: float = 1.0) -> float:
    """Mean over all bodies of where they are along an axis at a time, s, over a length, m."""
    series = run.series("bodies")
    times = np.unique(series["time"])
    rows = series[axis].reshape(times.size, -1)
    return float(np.mean([np.interp(time, times, rows[:, b]) for b in range(rows.shape[1])]) / over)


def run_out(run: Run, middle: float) -> float:
    """How far bodies reach from a middle along x at the end, m, the mean of both sides."""
    place, reach = _last(run)
    return float(0.5 * ((place[:, 0] + reach).max() - middle + middle - (place[:, 0] - reach).min()))


def pile_height(run: Run, middle: float, width: float) -> float:
    """Height of the highest body at the end within half a `width`, m, of a middle along x, above the floor."""
    place, reach = _last(run)
    near = np.abs(place[:, 0] - middle) < 0.5 * width
    return float((place[near, 2] + reach[near]).max() - run.case["box"].get("min", (0.0, 0.0, 0.0))[2])


def _last(run: Run) -> tuple[np.ndarray, np.ndarray]:
    series = run.series("bodies")
    end = series["time"] == series["time"].max()
    place = np.stack([series[name][end] for name in "xyz"], axis=1)
    case = parse(run.case)
    return place, np.array([b.shape.radius(case.dimensions == 2) for b in case.bodies])


def floor_force(run: Run, after: float) -> float:
    """Mean upward force of walls and floor on all bodies after a time, s, over their weight."""
    series = run.series("loads")
    late = series["time"] >= after
    force = {kind: series["fz"][late & (series["kind"] == kind)].sum() for kind in ("contact", "gravity")}
    return float(-force["contact"] / force["gravity"])


def carried(run: Run, body: str, after: float) -> float:
    """Mean over all bodies on it, and itself: what holds the body from below over its own weight, after a time, s."""
    series = run.series("loads")
    names = [b["name"] for b in run.case["bodies"]]
    above = names[names.index(body) :]
    late = (series["time"] >= after) & np.isin(series["body"], above)
    own = (series["time"] >= after) & (series["body"] == body)
    contact = series["fz"][late & (series["kind"] == "contact")].sum()
    return float(-contact / series["fz"][own & (series["kind"] == "gravity")].sum())


def tilt(run: Run, body: str, after: float, same_after: float = 360.0) -> float:
    """Mean turn of a body about y after a time, s, degrees, without its sign.

    `same_after`: by how much it must be turned to look the same; 90 for a square, whose turn is 45 then at most.
    """
    track = _track(run, body)
    turn = np.degrees(2.0 * np.arctan2(track["q2"], track["q0"]))[track["time"] > after] % same_after
    return float(np.minimum(turn, same_after - turn).mean())


def rests(run: Run, body: str, after: float) -> float:
    """Mean of what floor and walls hold a sunk body with after a time, s, over its weight less that of its water."""
    series, case = run.series("loads"), parse(run.case)
    mine = (series["time"] >= after) & (series["body"] == body) & (series["kind"] == "contact")
    volume = next(b.shape.volume for b in case.bodies if b.name == body)
    mass = next(case.mass_of(b) for b in case.bodies if b.name == body)
    return float(series["fz"][mine].mean() / (_gravity(run) * (mass - case.water.density * volume)))


def height_over(run: Run, body: str, after: float, level: float) -> float:
    """Mean height of the centre of a body over a level, m, after a time, s."""
    track = _track(run, body)
    return float(track["z"][track["time"] > after].mean() - level)


def drift(run: Run, body: str, after: float) -> float:
    """Largest distance, m, in x and z, of a body from where it was at the start, after a time, s."""
    track = _track(run, body)
    late = track["time"] >= after
    return float(np.hypot(track["x"] - track["x"][0], track["z"] - track["z"][0])[late].max())
