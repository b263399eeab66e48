"""What is measured of a finished run for its bars: functions of the run and of what `_bars.toml` gives them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.case.model import parse
from parsim.report.measures import mean_profile

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


def tilt(run: Run, body: str, after: float) -> float:
    """Mean turn of a body about y after a time, s, degrees, without its sign."""
    track = _track(run, body)
    late = track["time"] > after
    return float(abs(np.degrees(2.0 * np.arctan2(track["q2"], track["q0"]))[late].mean()))


def height_over(run: Run, body: str, after: float, level: float) -> float:
    """Mean height of the centre of a body over a level, m, after a time, s."""
    track = _track(run, body)
    return float(track["z"][track["time"] > after].mean() - level)


def drift(run: Run, body: str, after: float) -> float:
    """Largest distance, m, in x and z, of a body from where it was at the start, after a time, s."""
    track = _track(run, body)
    late = track["time"] >= after
    return float(np.hypot(track["x"] - track["x"][0], track["z"] - track["z"][0])[late].max())


def mean_of(run: Run, series: str, column: str, after: float, rows: dict[str, str] | None = None) -> float:
    """Mean of a column of a series after a time, s, of the rows where other columns are as told."""
    read = run.series(series)
    here = read["time"] >= after
    for name, value in (rows or {}).items():
        here &= read[name] == value
    return float(read[column][here].mean())


def off_log_law(run: Run, line: str, after: float, shear: float, roughness: float, depth: float) -> float:
    """Largest distance, over the mean, of the velocity on a line from u*/0.41 ln(30 z / ks) for 0.1 < z/H < 0.9."""
    z, u = mean_profile(run.series("velocities"), line, after)
    here = (z > 0.1 * depth) & (z < 0.9 * depth)
    exact = shear / 0.41 * np.log(30.0 * z[here] / roughness)
    mean = shear / 0.41 * (math.log(30.0 * depth / roughness) - 1.0)
    return float(np.abs(u[here] - exact).max() / mean)


def off_parabola(run: Run, line: str, after: float, mean: float, height: float) -> float:
    """Root of the mean squared distance, over the mean, of the velocity on a line from 6 U (z/H)(1 - z/H)."""
    z, u = mean_profile(run.series("velocities"), line, after)
    return float(np.sqrt(np.mean((u / mean - 6.0 * z / height * (1.0 - z / height)) ** 2)))


MEASURES = {
    function.__name__: function
    for function in (
        apex, last_speed, mean_place, run_out, pile_height, floor_force, carried, tilt, height_over, drift, mean_of,
        off_log_law, off_parabola,
    )
}  # fmt: skip
