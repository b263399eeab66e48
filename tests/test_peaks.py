"""What acts on bodies between rows: nothing is lost, over rows, checkpoints and restarts."""

import json
import shutil
import tomllib

import numpy as np
import pytest

import parsim
from parsim.__main__ import main
from parsim.case.model import parse
from parsim.errors import InputError
from parsim.observe.peaks import Peaks
from parsim.river import piers

# a ball of 2 kg that meets a pier of 0.4 m at 1 m/s, 0.15 m over its foot, and comes back
CASE = """
dimensions = 3
gravity = [0.0, 0.0, 0.0]
box = {max = [1.0, 0.4, 0.4]}
run = {until = 0.3}
[output]
series = 0.05
milestones = 0.1
sensors = [{kind = "load", name = "all"}, {kind = "load", name = "ball", body = "ball"}]
[contacts]
law = {kind = "spring", stiffness = 2e5}
[materials.ice]
young = 1e8
poisson = 0.3
friction = 0.0
restitution = 0.5
[[bodies]]
name = "pier"
shape = {size = [0.1, 0.1, 0.4]}
density = 2000.0
position = [0.7, 0.2, 0.2]
material = "ice"
fixed = true
[[bodies]]
name = "ball"
shape = {kind = "sphere", diameter = 0.1}
mass = 2.0
position = [0.47, 0.2, 0.15]
velocity = [1.0, 0.0, 0.0]
material = "ice"
"""


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("peaks")
    (folder / "case.toml").write_text(CASE)
    assert main(["run", str(folder / "case.toml"), "-o", str(folder / "out")]) == 0
    return folder / "out"


def of(run, body, kind="contact"):
    series = run.series("peaks")
    return {name: values[(series["body"] == body) & (series["kind"] == kind)] for name, values in series.items()}


def test_a_hit_gives_its_impulse_and_its_peak(out):
    """Impulse m v (1 + e); the peak of a spring is that of a half wave at least, and falls in no row of the loads."""
    run = parsim.open(out)
    pier = of(run, "pier")
    speed = run.series("bodies")["u"][-1]
    assert speed == pytest.approx(-0.5, rel=0.02)
    assert pier["fx_impulse"].sum() == pytest.approx(2.0 * (1.0 - speed), rel=1e-9)
    assert pier["fx_impulse"] == pytest.approx(pier["fx_mean"] * pier["span"], rel=1e-12)
    assert pier["span"].sum() == pytest.approx(pier["time"][-1], rel=1e-12)
    loads = run.series("loads")
    written = loads["fx"][(loads["body"] == "pier") & (loads["kind"] == "contact")]
    most = pier["fx_max"].max()
    assert most > 0.5 * 1.0 * np.sqrt(2e5 * 2.0) and written.max() < 0.5 * most
    assert piers.percentiles(piers.Peaks(*(pier[n] for n in (
        "time", "span", "fx_impulse", "fx_min", "fx_max"))), (0.0,))[0, 0] == most  # fmt: skip


def test_moments_are_about_the_foot(out):
    pier = of(parsim.open(out), "pier")
    assert pier["my_max"] == pytest.approx(0.15 * pier["fx_max"], rel=1e-9, abs=1e-9)
    assert pier["my_impulse"].sum() == pytest.approx(0.15 * pier["fx_impulse"].sum(), rel=1e-9)


def test_a_sensor_takes_the_fixed_bodies_or_the_one_it_names(out):
    run = parsim.open(out)
    series = run.series("peaks")
    seen = set(zip(series["sensor"].tolist(), series["body"].tolist(), series["kind"].tolist(), strict=True))
    assert seen == {(*who, kind) for who in (("all", "pier"), ("ball", "ball")) for kind in ("water", "contact")}
    assert of(run, "ball")["fx_impulse"].sum() == pytest.approx(-of(run, "pier")["fx_impulse"].sum(), rel=1e-9)
    assert run.units("peaks")["my_impulse"] == "N m s" and run.units("peaks")["fx_max"] == "N"


def test_a_restart_between_two_rows_loses_nothing(out, tmp_path, capsys):
    """From a checkpoint that lies between two rows, with sums and extremes of the steps before it."""
    shutil.copytree(out, tmp_path / "again")
    places = sorted((tmp_path / "again" / "checkpoints").glob("*.h5"))
    kept = next(path for path in places if path.name.startswith("milestone"))
    for path in places:
        if path != kept:
            path.unlink()
    assert main(["resume", str(tmp_path / "again"), "--until", "0.31"]) == 0
    first = tmp_path / "straight"
    case = tmp_path / "case.toml"
    case.write_text(CASE.replace("until = 0.3", "until = 0.31"))
    assert main(["run", str(case), "-o", str(first)]) == 0
    assert main(["compare", str(first), str(tmp_path / "again")]) == 0, capsys.readouterr().out


class Drawn:
    """A simulation whose bodies are pushed at random."""

    def __init__(self, bodies):
        self.dice, self.bodies, self.step_count, self.dt = np.random.default_rng(7), self, 0, 0.0
        self.names, self.made = [body.name for body in bodies], []

    def step(self):
        self.step_count, self.dt = self.step_count + 1, self.dice.uniform(0.001, 0.002)
        self.load = {kind: self.dice.normal(5.0, 20.0, (len(self.names), 6)) for kind in ("water", "contact")}
        self.made.append((self.dt, self.load))

    def shown(self, name):
        return self.load[name.removesuffix("_load")].copy()


def test_rows_are_of_all_steps_and_what_is_kept_goes_on():
    """Two observers, one of which is put away as JSON and taken up after every step, tell the same, and the truth."""
    case = parse(tomllib.loads(CASE))
    one, other, s = Peaks(case), Peaks(case), Drawn(case.bodies)
    one.see(s)
    assert one.rows(s) == [], "before the first step there is nothing to tell"
    for _ in range(3):
        s.made.clear()
        for _ in range(5):
            s.step()
            one.see(s)
            other.see(s)
            kept, other = json.loads(json.dumps(other.kept())), Peaks(case)
            other.restore(kept)
        rows = one.rows(s)
        assert rows == other.rows(s) and one.rows(s) == []
        assert [row[:3] for row in rows] == [[*who, kind] for who in (("all", "pier"), ("ball", "ball"))
                                             for kind in ("water", "contact")]  # fmt: skip
        dt = np.array([dt for dt, _ in s.made])
        water = np.array([load["water"][0] for _, load in s.made])
        water[:, 3] -= 0.2 * water[:, 1]  # the foot of the pier is 0.2 m under its centre
        water[:, 4] += 0.2 * water[:, 0]
        mean, least, largest, impulse = np.array(rows[0][4:]).reshape(4, 6)
        assert rows[0][3] == pytest.approx(dt.sum(), rel=1e-12)
        assert impulse == pytest.approx(dt @ water, rel=1e-12) and mean == pytest.approx(impulse / dt.sum(), rel=1e-12)
        assert (least == water.min(axis=0)).all() and (largest == water.max(axis=0)).all()


def test_a_sensor_without_a_body_is_refused():
    data = tomllib.loads(CASE)
    data["output"]["sensors"] = [{"kind": "load", "name": "a", "body": "pire"}]
    with pytest.raises(InputError, match='output.sensors.a.body = "pire": no such body; .*did you mean pier?'):
        parse(data)
    data["output"]["sensors"] = [{"kind": "load", "name": "a"}]
    data["bodies"][0]["fixed"] = False
    with pytest.raises(InputError, match="output.sensors.a: there is no fixed body whose loads it could tell; name"):
        parse(data)
