"""`parsim new --from FILE`: the case of a reach, and what it needs to be told."""

import numpy as np
import pytest
from ground import channel, raster, reach

from parsim import terrain
from parsim.__main__ import main
from parsim.case.model import load
from parsim.commands.new_reach import Asked, _cut, roughness


def bank(x, y):
    """Heights of a plane that rises to the left."""
    return 4.0 + 0.3 * (y - 200.0) + 0.0 * x


def told(capsys, *words):
    """Exit code and what was printed."""
    code = main(["new", *map(str, words)])
    out = capsys.readouterr()
    return code, out.out + out.err


@pytest.mark.long
def test_a_reach_of_sections_is_a_case_that_passes_check(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    reach(tmp_path)
    words = [
        "river",
        "--from",
        "reach.g01",
        "--from-station",
        290,
        "--to-station",
        220,
        "--level",
        11,
        "--spacing",
        0.25,
    ]
    code, said = told(capsys, *words)
    assert code == 0, said
    assert said.splitlines() == [
        "a box of 70 x 16.75 x 3 m, spacing 0.25 m",
        "Manning's n 0.03 between the banks is a roughness ks of 0.1944 m: n = ks^(1/6) / (8.1 sqrt(g))",
        "wrote river/case.toml and river/reach.g01; next: parsim check river/case.toml",
    ]
    assert main(["check", "river/case.toml"]) == 0
    case = load("river/case.toml")
    (bed,) = case.bodies
    assert bed.shape.origin[0] == 10.0 and case.spacing == 0.25 and case.materials["bed"].roughness == 0.1944
    x, y = np.meshgrid(bed.shape.heights.x, bed.shape.heights.y, indexing="ij")
    level = case.water.fill[0].max[2]
    depth = 11.0 - (10.0 - 0.001 * (10.0 + x) + 2.0 * ((y + bed.shape.origin[1]) / 10.0) ** 2)
    assert np.abs(level - bed.shape.heights.z - depth).max() < 0.02
    assert level % 0.25 == 0.0 and bed.shape.heights.z.min() >= 4 * 0.25
    assert (bed.shape.heights.z[:, [0, -1]] > level).all(), "its banks are dry"
    assert case.water.friction.walls == () and case.water.friction.kind == "wall_law"
    assert code == 0 and main(["new", "river", "--from", "reach.g01", "--level", "11"]) == 2
    assert "river exists already and is not overwritten" in capsys.readouterr().err
    assert not list(tmp_path.glob(".*"))


@pytest.mark.long
def test_a_raster_is_cut_to_where_it_is_wet(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    raster(tmp_path, channel)
    code, said = told(
        capsys, "pool", "--from", "ground.asc", "--level", 4.1, "--from-station", 101, "--to-station", 103
    )
    assert code == 0, said
    case = load("pool/case.toml")
    assert case.spacing == 0.01 and case.water.friction is None
    assert case.box.size[0] == pytest.approx(2.0)
    assert case.box.size[1] == pytest.approx(2 * (1 / 3) ** 0.5 + 0.08, abs=0.02), "the water and four spacings of bank"
    assert case.water.fill[0].max[2] == pytest.approx(0.14)
    assert case.speed == pytest.approx(2 * (9.81 * 0.1) ** 0.5, abs=1e-3)


@pytest.mark.long
def test_a_file_in_feet_is_a_box_in_metres(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    reach(tmp_path)
    code, said = told(capsys, "river", "--from", "reach.g01", "--level", 11, "--scale", 0.3048, "--spacing", 0.1)
    assert code == 0, said
    assert "a box of 30.4 x " in said
    (bed,) = load("river/case.toml").bodies
    assert np.ptp(bed.shape.heights.z[:, len(bed.shape.heights.y) // 2]) == pytest.approx(
        0.1 * 0.3048 * 30.4 / 30.48, rel=1e-6
    )


def test_holes_in_the_box_are_told_by_their_place_in_the_file(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    raster(tmp_path, channel, holes=[(20, 10)])
    code, said = told(capsys, "pool", "--from", "ground.asc", "--level", 4.1, "--spacing", 0.1)
    assert code == 2 and "--from: no data at 4 of 924 places in the box, such as x = 101.95, y = 200.95" in said
    assert [path.name for path in tmp_path.iterdir()] == ["ground.asc"]


@pytest.mark.parametrize(("shape", "level", "held"), [(channel, 4.1, False), (channel, 4.4, True), (bank, 4.1, True)])
def test_water_that_reaches_the_end_of_the_ground_is_told(tmp_path, shape, level, held):
    source = raster(tmp_path, shape)
    box = _cut(terrain.read(source), [], (101.0, 103.0), Asked(level=level, spacing=0.1))
    assert box.held == held


def test_what_one_that_was_killed_has_left_is_in_no_ones_way(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".river.part").mkdir()
    raster(tmp_path, channel)
    code, said = told(capsys, "river", "--from", "ground.asc", "--level", 4.4, "--spacing", 0.2)
    assert code == 0 and "there a side of the box holds the water" in said, said


@pytest.mark.parametrize(("words", "said"), [
    ([], "--level: missing; the level of the water, a height in the file, whose ground reaches from 9.9 to 13, the "
     "banks from 11.9"),
    (["--level", 9.0], "--level 9: is not over the ground, which reaches from 9.9 to 13"),
    (["--level", 11, "--from-station", 310], "--from-station 310: must be from 300 to 200"),
    (["--level", 11, "--to-station", 100], "--to-station 100: must be from 300 to 200"),
    (["--level", 11, "--from-station", 220, "--to-station", 250], "--to-station 250: must be downstream of"),
    (["--level", 11, "--spacing", 200], "--spacing 200: the reach is 100 m long, its ground without holes 40 m wide"),
    (["--level", "nan"], "--level nan: must be a finite number"),
    (["--level", "inf"], "--level inf: must be a finite number"),
    (["--level", 11, "--spacing", 0.001], "--spacing 0.001: makes a bed of 100000 x 1"),
    (["--level", 11, "--river-reach", "Mode, Up"], 'has no reach "Mode, Up"; allowed: Made, Up; did you mean'),
])  # fmt: skip
def test_what_is_missing_or_wrong_is_told_and_nothing_written(tmp_path, capsys, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    reach(tmp_path)
    code, text = told(capsys, "river", "--from", "reach.g01", *words)
    assert code == 2 and said in text, text
    assert [path.name for path in tmp_path.iterdir()] == ["reach.g01"]


def test_files_that_are_not_there_and_options_of_examples_are_told(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert told(capsys, "river", "--from", "gone.g01")[1] == "error: gone.g01: no such file\n"
    code, text = told(capsys, "river", "--from", "still_water/2d", "--level", 1)
    assert code == 2 and "--from still_water/2d: stations, spacing, level, reach and scale belong to a file" in text


def test_roughness_is_that_of_manning():
    assert roughness(0.03) == pytest.approx(0.1944, abs=1e-4)
    assert roughness(0.03) ** (1 / 6) / (8.1 * 9.81**0.5) == pytest.approx(0.03)


def test_a_ditch_narrower_than_the_first_look_is_seen(tmp_path):
    """2,000 heights across, one of them a metre deeper."""
    y = np.arange(2000.0)
    z = np.where(y == 1003.0, 8.0, 10.0 + 0.01 * np.abs(y - 1003.0))
    rows = np.array([[x, v, h] for x in (0.0, 1.0, 2.0) for v, h in zip(y, z, strict=True)])
    np.savetxt(tmp_path / "ground.xyz", rows)
    surface = terrain.read(tmp_path / "ground.xyz")
    cut = _cut(surface, [], [0.0, 2.0], Asked(spacing=0.5, level=10.2))
    assert cut.counts[2] == round(2.2 / 0.5 + 0.5) + 4, "the water is as deep as the ditch"
