"""Physics against exact and published numbers, at the resolution of the cases: minutes each, `pytest -m validate -s`.

Every test prints what it measured beside what it is held to.
"""

from pathlib import Path

import numpy as np
import pytest

import parsim
from parsim.__main__ import main
from parsim.case.model import load
from parsim.domain.comm import Comm
from parsim.particles.state import WALL
from parsim.run.simulation import Simulation

CASES = Path(__file__).parent.parent / "cases"
pytestmark = pytest.mark.validate


def told(**figures):
    """Print measured figures on one line."""
    print("\n  " + ", ".join(f"{name.replace('_', ' ')} {value:.5g}" for name, value in figures.items()))


def floor_samples(s):
    """The wall particles just below the floor, and the one in its middle: indices."""
    p, at, box = s.domain.particles, s.near.boundary, s.case.box
    below = (p.kind[at] == WALL) & (p.z[at] < 0) & (p.z[at] > -s.case.spacing)
    floor = at[below & (p.x[at] > 0) & (p.x[at] < box.max[0]) & (p.y[at] > 0) & (p.y[at] < box.max[1])]
    middle = np.hypot(p.x[floor] - box.max[0] / 2, p.y[floor] - box.max[1] / 2)
    return floor, floor[np.argmin(middle)]


@pytest.mark.parametrize(("name", "until"), [("2d", 20.0), ("3d", 5.0)])
def test_still_water(name, until):
    """In 2D eddies that last move the water, by 7e-6 of its potential energy: that misses the bar by seven times."""
    case = load(CASES / "still_water" / f"{name}.toml")
    s = Simulation(case, Comm())
    depth, l0 = case.depth, case.spacing
    times, bottom, pressure, level, moving = [], [], [], [], []
    while s.time < until:
        s.step()
        p = s.domain.particles
        if s.step_count == 1 or s.since == 1:
            floor, sensor = floor_samples(s)
        if s.time < 0.0:
            continue
        times.append(s.time)
        bottom.append(p.p[floor].mean() / (9810.0 * (depth + l0 / 2)))
        pressure.append(p.p[sensor] / (9810.0 * (depth + l0 / 2)))
        level.append(2.0 * p.z[s.near.fluid].mean() / depth)
        speeds = [component[s.near.fluid] for component in p.velocity]
        moving.append(sum(float((speed**2).mean()) for speed in speeds) / (9.81 * depth))
    times, bottom, pressure, level = map(np.array, (times, bottom, pressure, level))
    window = max(int(0.2 * np.sqrt(depth / 9.81) / np.diff(times).mean()), 1)
    mean = np.convolve(pressure, np.ones(window) / window, "same")
    inner = slice(window, -window)
    noise = np.sqrt(np.mean((pressure - mean)[inner] ** 2))
    averages = [part.mean() for part in np.array_split(bottom, 10)]
    told(
        bottom_pressure_least=min(averages),
        bottom_pressure_most=max(averages),
        sensor_mean=pressure.mean(),
        noise=noise,
        level_at_start=level[0],
        level_at_end=level[-1],
        level_drift=np.abs(level - level[0]).max(),
        level_off=np.abs(level - 1).max(),
        kinetic_over_potential=max(moving),
    )
    assert max(abs(a - 1) for a in averages) < 0.005
    assert noise < 0.001
    assert np.abs(level - 1).max() < 0.001
    assert max(moving) < 1e-6


def test_half_dense_square_turns_to_45_degrees(tmp_path):
    run = finished("floating_square/half.toml", tmp_path)
    bodies = run.series("bodies")
    late = bodies["time"] > 2.0
    tilt = np.degrees(2 * np.arctan2(bodies["q2"], bodies["q0"]))[late]
    height = bodies["z"][late].mean() - 0.5  # Archimedes: the centre lies in the water plane
    told(tilt=tilt.mean(), tilt_spread=tilt.std(), centre_above_water_in_spacings=height / 0.005)
    assert abs(abs(tilt.mean()) - 45) < 0.5
    assert abs(height) < 0.1 * 0.005


def test_neutral_square_stays_where_it_is(tmp_path):
    run = finished("floating_square/neutral.toml", tmp_path)
    bodies = run.series("bodies")
    free = bodies["time"] >= 0.0
    drift = np.hypot(bodies["x"][free] - 0.25, bodies["z"][free] - 0.25) / 0.005
    told(largest_drift_in_spacings=drift.max(), final_drift_in_spacings=drift[-1])
    assert drift.max() < 0.2


def test_block_floats_at_its_draught(tmp_path):
    run = finished("floating_block/block.toml", tmp_path)
    bodies = run.series("bodies")
    late = bodies["time"] > 1.5
    draught = 0.06 - (bodies["z"][late].mean() - 0.0195 / 2)  # the fill's level counts the displaced water
    told(draught_mm=draught * 1e3, exact_mm=16.932)
    assert abs(draught - 0.016932) < 0.1 * 0.005


def finished(case, folder, *changes):
    """The output of a case, run here on one rank."""
    assert main(["run", str(CASES / case), "-o", str(folder / "out"), *changes]) == 0
    return parsim.open(folder / "out")
