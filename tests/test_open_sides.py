"""An open side means one thing to water, bodies, contacts and counters.

Beyond it there is nothing, and what is wholly beyond it by more than the support is taken out and told of.
"""

import numpy as np
import pytest
from flows import WOOD, merged

import parsim
from parsim.case.model import parse
from parsim.domain.comm import Comm
from parsim.errors import RunError
from parsim.observe.observers import rows_now
from parsim.run.loop import run
from parsim.run.simulation import Simulation

FLOE = {
    "name": "floe",
    "shape": {"size": [0.08, 1.0, 0.04]},
    "density": 900.0,
    "velocity": [3.0, 0.0, 0.0],
    "position": [0.3, 0.5, 0.1],
    "material": "wood",
}
LEAVING = {
    "dimensions": 2, "spacing": 0.01, "run": {"until": 0.3}, "materials": WOOD, "bodies": [FLOE],
    "box": {"max": [0.4, 1.0, 0.2], "faces": {"x_max": "open"}},
    "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.4, 1.0, 0.1]}]},
}  # fmt: skip
DRY = merged(LEAVING, {"water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.1, 1.0, 0.02]}], "speed": 5.0}})


def counts(s):
    """The row of the counts, by name."""
    return {name: values[0] for name, values in rows_now(s.case, s)["counts"].items()}


def test_a_body_that_leaves_is_taken_out_and_told_of(tmp_path, capsys):
    case = parse(LEAVING)
    assert run(case, "leaving.toml", tmp_path / "out") == 0
    out = parsim.open(tmp_path / "out")
    lost, bodies, left = out.series("lost"), out.series("bodies"), out.series("counts")["bodies_left"]
    at = np.flatnonzero(lost["what"] == "body floe")
    assert at.size == 1 and lost["x"][at] - 0.04 > 0.4 + 0.03 and lost["u"][at] > 2.0 and lost["id"][at] == 0
    assert (lost["what"] == "water").sum() == out.series("counts")["lost"][-1] > 0
    assert left[0] == 0 and left[-1] == 1 and (np.diff(left) >= 0).all()
    gone = bodies["step"] >= lost["step"][at]
    assert np.isnan(bodies["x"][gone]).all() and np.isfinite(bodies["x"][~gone]).all()
    assert np.isfinite(out.series("energy")["total"]).all()
    assert len(out.bodies(0)["quads"]) == 6 and len(out.bodies(-1)["quads"]) == 0
    assert "body floe has left the box: taken out at t = " in capsys.readouterr().out


def test_a_body_may_be_asked_to_stop_the_run():
    s = Simulation(parse(merged(DRY, {"run": {"outside": "stop"}})), Comm())
    with pytest.raises(RunError, match="has left the box: body floe at .0.4[78]"):
        while s.time < 0.3:
            s.step()


def test_a_restart_knows_what_has_left():
    s = Simulation(parse(LEAVING), Comm())
    while not s.bodies.gone.any():
        s.step()
    while not s.rebuilds_next():
        s.step()
    again = Simulation(s.case, Comm(), s.snapshot())
    for _ in range(20):
        s.step()
        again.step()
    assert again.bodies.gone.all() and again.bodies.left[0] == s.bodies.left[0]
    for mine, theirs in ((s.fluid.x, again.fluid.x), (s.fluid.w, again.fluid.w)):
        np.testing.assert_array_equal(mine, theirs)


def test_the_floor_ends_at_an_open_side():
    """A block that slides over the edge tips and falls, with no energy made; on the floor it lay still."""
    slow = {"velocity": [1.0, 0.0, 0.0], "position": [0.34, 0.5, 0.0205], "density": 600.0}
    s = Simulation(parse(merged(DRY, {"bodies": [merged(FLOE, slow)]})), Comm())
    b, g = s.bodies, s.case.gravity
    start = b.kinetic_energy() + b.potential_energy(g)
    height, most = [], 0.0
    while not b.gone.any() and s.time < 1.0:
        height.append(b.position[0, 2])
        most = max(most, b.kinetic_energy() + b.potential_energy(g) + s.contacts.elastic_energy())
        s.step()
    assert b.gone.all() and min(height) < -0.03, "it fell beyond the edge"
    assert height[0] - 0.001 < height[int(0.02 / s.dt)] and most < 1.001 * start


def test_no_wall_stands_above_the_box():
    """A block thrown over the wall flies its parabola and leaves."""
    thrown = {"velocity": [2.0, 0.0, 1.5], "position": [0.2, 0.5, 0.17]}
    s = Simulation(parse(merged(DRY, {"bodies": [merged(FLOE, thrown)], "box": {"faces": {"x_max": "wall"}}})), Comm())
    while not s.bodies.gone.any() and s.time < 1.0:
        if s.bodies.position[0, 0] < 0.4:
            assert s.bodies.velocity[0, 0] == 2.0
            assert s.bodies.velocity[0, 2] == pytest.approx(1.5 - 9.81 * s.time, abs=1e-9)
        s.step()
    assert s.bodies.gone.all()


def test_water_beyond_an_open_side_is_in_no_wall():
    flowing = merged(
        LEAVING,
        {
            "bodies": [],
            "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.4, 1.0, 0.1], "velocity": [1.0, 0.0, 0.0]}]},
        },
    )
    s, fallen = Simulation(parse(flowing), Comm()), 0
    while s.time < 0.2:
        s.step()
        p, at = s.domain.particles, s.near.fluid
        fallen = max(fallen, ((p.x[at] > 0.4) & (p.z[at] < -0.0025)).sum())
    assert fallen > 0 and counts(s)["in_walls"] == 0 and counts(s)["lost"] > 0
