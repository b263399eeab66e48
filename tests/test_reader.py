"""The reader on the folder of a real run: every series, with its units and what its numbers mean."""

import math

import numpy as np
import pytest

import parsim
from parsim.__main__ import main
from parsim.observe.observers import TABLES
from parsim.output.reader import WORDS

# a gate, a body afloat, a gauge, and water that is thrown out over the top
CASE = """
dimensions = 2
spacing = 0.01
[box]
max = [0.4, 1.0, 0.2]
[water]
fill = [{min = [0.0, 0.0, 0.0], max = [0.2, 1.0, 0.1]},
        {min = [0.3, 0.0, 0.15], max = [0.35, 1.0, 0.2], velocity = [0.0, 0.0, 2.0]}]
[gate]
min_x = 0.2
max_x = 0.21
[materials.wood]
young = 1e8
poisson = 0.3
friction = 0.4
restitution = 0.5
[[bodies]]
name = "floe"
shape = {size = [0.08, 1.0, 0.04]}
density = 600.0
position = [0.1, 0.5, "float"]
material = "wood"
[run]
until = 0.05
[output]
frames = 0.02
series = 0.005
sensors = [
    {name = "middle", x = 0.03},
    {kind = "pressure", name = "foot", x = 0.0, z = 0.0},
    {kind = "force", name = "floor", wall = "z_min"},
    {kind = "flux", name = "through", x = 0.1},
    {kind = "velocity", name = "line", x = 0.1, width = 0.05},
    {kind = "load", name = "push", body = "floe"},
    {kind = "levels", name = "along", start = [0.0, 0.0], end = [0.2, 0.0], points = 5},
]
"""


OTHERS = {"channel", "openings", "ice", "solver"}  # series of other boxes and another scheme: see the tests of these


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("real")
    (folder / "case.toml").write_text(CASE)
    assert main(["run", str(folder / "case.toml"), "-o", str(folder / "out")]) == 0
    return parsim.open(folder / "out")


def test_every_series_is_written(run):
    assert run.series_names == sorted(TABLES)


@pytest.mark.parametrize("name", [name for name in TABLES if name not in OTHERS])
def test_every_column_has_rows_of_one_length_and_one_unit(run, name):
    series, units = run.series(name), run.units(name)
    assert list(series) == list(units) and len(series["step"]) > 3
    assert {len(values) for values in series.values()} == {len(series["step"])}
    texts = {column for column, values in series.items() if values.dtype.kind == "U"}
    assert texts <= WORDS and not (set(series) & WORDS) - texts
    assert all(units[column] == "-" for column in texts | {"step"}) and units["time"] == "s"


def test_units_are_those_of_the_numbers(run):
    assert run.units("energy")["dt"] == "s" and run.units("energy")["total"] == "J"
    bodies = run.units("bodies")
    assert [bodies[column] for column in ("body", "z", "q3", "w", "spin_y")] == ["-", "m", "-", "m/s", "rad/s"]
    assert run.units("loads")["fz"] == "N" and run.units("loads")["ty"] == "N m"
    assert run.units("lost")["id"] == "-" and run.units("lost")["w"] == "m/s"
    counts = run.units("counts")
    assert counts.pop("volume") == "m3" and counts.pop("time") == "s" and set(counts.values()) == {"-"}


def test_the_volume_is_what_the_density_makes_of_the_mass(run):
    counts, volume = run.series("counts"), 0.01**2
    for frame, time in enumerate(run.times()):
        expected = math.fsum(volume / run.water(frame)["density_ratio"])
        assert counts["volume"][counts["time"] == time][0] == pytest.approx(expected, rel=1e-12)
    assert np.unique(counts["volume"] / counts["fluid"]).size > 5, "no constant times the number of particles"
    assert counts["volume"] / counts["fluid"] == pytest.approx(volume, rel=0.02)


def test_what_is_lost_has_been_there(run):
    lost, counts = run.series("lost"), run.series("counts")
    assert len(lost["id"]) == counts["lost"][-1] > 0
    assert (lost["z"] > 0.2).all() and set(lost["id"]) <= set(run.water(0)["id"])
