"""A channel that repeats and holds its discharge, and quantities that change with time."""

import numpy as np
import pytest
from flows import simulation, tank

from parsim.case.course import at_time
from parsim.case.model import load, parse
from parsim.errors import InputError


def channel(discharge=0.04, velocity=0.2, gravity=None, **more):
    """A frictionless channel that repeats, 0.1 m deep."""
    given = tank(0.4, 0.2, 0.01, fill=(0.4, 0.1), periodic="x", speed=2.0)
    given["water"]["fill"][0]["velocity"] = [velocity, 0.0, 0.0]
    given["channel"] = {"discharge": discharge, **more}
    return given | ({"gravity": gravity} if gravity else {})


def test_the_discharge_comes_to_what_is_asked_and_the_force_to_nothing():
    s = simulation(channel(relaxation=0.1))
    while s.time < 1.2:
        s.step()
    pull = s.solids.pull
    assert pull.discharge == pytest.approx(0.04, rel=0.01)
    assert abs(pull.drive) < 0.02 * 0.2 / 0.1, "there is no friction"


@pytest.mark.long
def test_a_slope_that_drives_is_held_back():
    """Tilted gravity alone would make it faster without end: the force holds against it."""
    s = simulation(channel(velocity=0.4, gravity=[0.1, 0.0, -9.81], relaxation=0.1))
    drives = []
    while s.time < 1.5:
        s.step()
        drives.append(s.solids.pull.drive)
    assert s.solids.pull.discharge == pytest.approx(0.04, rel=0.01)
    assert np.mean(drives[len(drives) // 2 :]) == pytest.approx(-0.1, rel=0.05)


def test_work_of_the_force_is_what_the_water_gains():
    s = simulation(channel(relaxation=0.2))
    mass = s.near.fluid.size * s.scheme.mass
    while s.time < 0.1:
        s.step()
    speed = s.solids.pull.discharge / 0.1
    assert s.solids.pull.work == pytest.approx(0.5 * mass * (speed**2 - 0.2**2), rel=0.03)


def test_the_time_of_relaxation_is_that_of_five_depths():
    assert parse(channel()).channel.relaxation == pytest.approx(5.0 * 0.1 / 0.4)


def test_a_course_is_straight_between_its_rows(tmp_path):
    assert at_time(0.3, 7.0) == 0.3
    rows = ((1.0, 2.0), (3.0, 6.0))
    assert [at_time(rows, t) for t in (0.0, 2.0, 9.0)] == [2.0, 4.0, 6.0]


def test_a_hydrograph_is_read_from_a_file_beside_the_case(tmp_path):
    (tmp_path / "q.csv").write_text("# flood\ntime, discharge\n0, 0.02\n\n5.0, 0.04\n")
    (tmp_path / "case.toml").write_text(
        parse(channel()).to_toml().replace("discharge = 0.04", 'discharge = {file = "q.csv"}')
    )
    case = load(tmp_path / "case.toml")
    assert case.channel.discharge == ((0.0, 0.02), (5.0, 0.04))
    (tmp_path / "whole.toml").write_text(case.to_toml())
    assert load(tmp_path / "whole.toml") == case, "the completed case needs the file no more"


@pytest.mark.parametrize(("name", "text", "said"), [
    ("q.csv", None, "cannot be read: No such file"),
    ("q.txt", "0,1\n1,2\n", "must be a CSV file of two columns"),
    ("q.csv", "time,q\n0,1\n", "has 1 rows of numbers; must be two or more"),
    ("q.csv", "0,1\n1,x\n", "row 2, 1,x: must be two numbers"),
    ("q.csv", "0,1,2\n1,2,3\n2,3,4\n", "row 1, 0,1,2: must be two numbers"),
    ("q.csv", "0,1,\n1,2\n2,3\n", "row 1, 0,1,: must be two numbers"),
])  # fmt: skip
def test_a_wrong_hydrograph_is_told(tmp_path, name, text, said):
    if text is not None:
        (tmp_path / name).write_text(text)
    case = parse(channel()).to_toml().replace("discharge = 0.04", f'discharge = {{file = "{name}"}}')
    (tmp_path / "case.toml").write_text(case)
    with pytest.raises(InputError, match="channel.discharge.file = .*" + said):
        load(tmp_path / "case.toml")


def _walled(given):
    given["box"]["faces"] = {}
    return given


def _dry(given):
    given["water"] = {}
    return given


@pytest.mark.parametrize(("given", "said"), [
    (_walled(channel()), 'x_min and x_max = "wall" and "wall": must be periodic'),
    (_dry(channel()), "channel.discharge: there is no water"),
    (channel(0.5), "is 5 m/s, more than the largest expected speed, 2 m/s"),
    (channel(0.0), "channel.discharge = 0.0: there is nothing to hold"),
    (channel([[0.0, 0.1], [0.0, 0.2]]), "channel.discharge: time 0 after 0 s"),
])  # fmt: skip
def test_a_wrong_channel_is_told(given, said):
    with pytest.raises(InputError) as error:
        parse(given)
    assert said in str(error.value)
