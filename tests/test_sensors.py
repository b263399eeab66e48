"""Sensors on scenes whose answers are known."""

import math

import numpy as np
import pytest
from flows import GRAVITY, WOOD, simulation, tank

from parsim.case.model import parse
from parsim.errors import InputError
from parsim.observe.fluxes import Fluxes
from parsim.observe.forces import Forces
from parsim.observe.loads import Loads
from parsim.observe.probes import Probes
from parsim.observe.velocities import Velocities

DEPTH = 0.1
PROBE = {"kind": "pressure", "name": "a", "z": 0.05}
FLOAT = {"name": "raft", "shape": {"size": [0.08, 1.0, 0.04]}, "density": 500.0, "material": "wood",
         "position": [0.2, 0.5, "float"]}  # fmt: skip


def still(*sensors, **changes):
    """A tank of water at rest after a few steps, with sensors."""
    s = simulation(tank(0.4, 0.2, 0.01, fill=(0.4, DEPTH)), output={"sensors": sensors}, **changes)
    for _ in range(3):
        s.step()
    return s


@pytest.mark.parametrize("place", [(0.0, 0.02), (0.2, 0.0), (0.4, 0.08), (0.1, 0.05)])
def test_a_probe_reads_the_pressure_of_the_depth(place):
    x, z = place
    s = still({"kind": "pressure", "name": "a", "x": x, "z": z})
    ((name, told, *where, pressure),) = Probes(s.case).rows(s)
    assert (name, told) == ("a", "none") and where == [x, 0.5, z]
    assert pressure == pytest.approx(1000.0 * GRAVITY * (DEPTH - z), abs=0.01 * 1000.0 * GRAVITY * DEPTH)


def test_a_dry_probe_reads_nothing():
    s = still({"kind": "pressure", "name": "a", "x": 0.0, "z": 0.16})
    assert Probes(s.case).rows(s)[0][-1] == 0.0


def test_a_probe_moves_with_its_body():
    sensor = {"kind": "pressure", "name": "a", "x": 0.22, "z": 0.08, "body": "raft"}
    s = still(sensor, materials=WOOD, bodies=[FLOAT])
    probes = Probes(s.case)
    s.bodies.position[0] += (0.05, 0.0, 0.0)
    half = math.radians(30.0) / 2.0
    s.bodies.quaternion[0] = (math.cos(half), 0.0, -math.sin(half), 0.0)
    ((_, _, x, _, z, _),) = probes.rows(s)
    down = 0.08 - s.bodies.position[0, 2]
    turned = (
        0.02 * math.cos(2 * half) - down * math.sin(2 * half),
        0.02 * math.sin(2 * half) + down * math.cos(2 * half),
    )
    assert (x - s.bodies.position[0, 0], z - s.bodies.position[0, 2]) == pytest.approx(turned, abs=1e-3)


def test_walls_carry_the_water():
    sensors = [
        {"kind": "force", "name": "floor", "wall": "z_min"},
        {"kind": "force", "name": "side", "wall": "x_max"},
        {"kind": "force", "name": "half", "wall": "z_min", "min": [0.0, 0.0, 0.0], "max": [0.2, 0.0, 0.0]},
    ]
    s = still(*sensors)
    rows = {(name, kind): force for name, _, kind, *force in Forces(s.case).rows(s)}
    weight = 1000.0 * GRAVITY * DEPTH * 0.4
    assert rows["floor", "pressure"] == pytest.approx([0.0, 0.0, -weight], rel=0.01, abs=1e-9)
    assert rows["half", "pressure"][2] == pytest.approx(-0.5 * weight, rel=0.01)
    assert rows["side", "pressure"][0] == pytest.approx(0.5 * 1000.0 * GRAVITY * DEPTH**2, rel=0.03)
    assert rows["floor", "friction"] == [0.0, 0.0, 0.0]


def test_a_stream_is_seen_as_it_flows():
    """A plug of 0.5 m/s between periodic sides: discharge, momentum, its profile, and the friction of the bed."""
    sensors = [
        {"kind": "flux", "name": "through", "x": 0.0},
        {"kind": "velocity", "name": "line", "x": 0.0, "width": 0.1},
        {"kind": "force", "name": "bed", "wall": "z_min"},
    ]
    given = tank(0.4, 0.2, 0.01, fill=(0.4, DEPTH), periodic="x", friction={"kind": "wall_law", "roughness": 0.005})
    given["water"]["fill"][0]["velocity"] = [0.5, 0.0, 0.0]
    s = simulation(given, output={"sensors": sensors})
    s.step()
    ((_, _, discharge, area, speed, momentum),) = Fluxes(s.case).rows(s)
    assert area == pytest.approx(DEPTH, rel=0.01)
    assert discharge == pytest.approx(0.5 * area, rel=1e-3)
    assert speed == pytest.approx(0.5, rel=1e-3)
    assert momentum == pytest.approx(1000.0 * 0.25 * area, rel=2e-3)
    rows = Velocities(s.case).rows(s)
    assert [z for _, z, *_ in rows] == pytest.approx(np.arange(0.005, DEPTH, 0.01))
    assert {number for *_, number in rows} == {10}
    assert [u for _, _, u, *_ in rows] == pytest.approx([0.5] * 10, rel=5e-3)
    bed = next(force for _, _, kind, *force in Forces(s.case).rows(s) if kind == "friction")
    assert bed[0] == pytest.approx(s.solids.friction.stress[:, 0].sum(), rel=1e-4) and bed[0] > 0.1


def test_nothing_is_told_of_pressures_before_the_first_step():
    sensors = [
        {"kind": "force", "name": "floor", "wall": "z_min"},
        {"kind": "pressure", "name": "a", "x": 0.1, "z": 0.0},
    ]
    s = simulation(tank(0.4, 0.2, 0.01, fill=(0.4, DEPTH)), output={"sensors": sensors})
    rows = [*Forces(s.case).rows(s), *Probes(s.case).rows(s)]
    assert np.isnan([row[-1] for row in rows]).all()


def test_a_flux_near_an_open_side_counts_the_water_that_is_there():
    given = tank(0.4, 0.2, 0.01, fill=(0.4, DEPTH))
    given["water"]["fill"][0]["velocity"] = [0.5, 0.0, 0.0]
    s = simulation(
        given, output={"sensors": [{"kind": "flux", "name": n, "x": x} for n, x in (("a", 0.0), ("b", 0.39))]}
    )
    for _, _, discharge, area, *_ in Fluxes(s.case).rows(s):
        assert area == pytest.approx(DEPTH, rel=0.05) and discharge == pytest.approx(0.5 * area, rel=1e-6)


@pytest.mark.parametrize("x", [0.0, 0.1, 0.4])
def test_a_probe_looks_across_a_periodic_side(x):
    given = tank(0.4, 0.2, 0.01, fill=(0.4, DEPTH), periodic="x")
    s = simulation(given, gravity=[0.5, 0.0, -GRAVITY], output={"sensors": [PROBE | {"x": x}]})
    for _ in range(3):
        s.step()
    assert Probes(s.case).rows(s)[0][-1] == pytest.approx(1000.0 * GRAVITY * 0.05, rel=0.01)


def test_friction_is_part_of_what_the_water_does_to_a_body():
    given = tank(0.4, 0.2, 0.01, fill=(0.4, DEPTH), friction={"kind": "wall_law", "roughness": 0.002})
    s = simulation(given, materials=WOOD, bodies=[FLOAT | {"velocity": [0.3, 0.0, 0.0]}])
    s.step()
    rows = {kind: load for _, kind, *load in Loads(s.case).rows(s)}
    assert rows["water_friction"][0] < 0.0
    assert abs(rows["water_friction"][2]) < 1e-3 * rows["water"][2]


@pytest.mark.parametrize(("sensor", "text"), [
    ({"kind": "pressure", "x": 0.1, "z": 0.3}, "output.sensors.a.z = 0.3: outside the box; must be 0.0 to 0.2"),
    ({"kind": "pressure", "x": 0.1, "z": 0.1, "body": "rafd"}, 'body = "rafd": no such body; allowed: raft'),
    ({"kind": "force", "wall": "z_max"}, 'output.sensors.a.wall = "z_max": is no wall of this case'),
    ({"kind": "flux", "x": 1.0}, "output.sensors.a.x = 1.0: outside the box"),
    ({"kind": "force", "wall": "z_min", "min": [0.3, 0.0, 0.0], "max": [0.1, 1.0, 1.0]}, "there is nothing of the"),
    ({"kind": "flow", "x": 1.0}, "output.sensors.a.kind = 'flow': must be"),
])  # fmt: skip
def test_sensors_that_can_not_be_are_refused(sensor, text):
    given = tank(0.4, 0.2, 0.01, fill=(0.4, DEPTH)) | {"materials": WOOD, "bodies": [FLOAT]}
    with pytest.raises(InputError) as error:
        parse(given | {"output": {"sensors": [sensor | {"name": "a"}]}})
    assert text in str(error.value)


def test_between_inlet_and_outlet_only_what_is_in_the_box_counts():
    """Water and floor go on beyond an outlet, and the floor before an inlet."""
    given = tank(0.4, 0.2, 0.01, fill=(0.4, DEPTH), speed=2.0)
    given["box"]["faces"] = {
        "x_min": {"kind": "inlet", "discharge": 0.5 * DEPTH},
        "x_max": {"kind": "outlet", "level": DEPTH},
    }
    given["water"]["fill"][0]["velocity"] = [0.5, 0.0, 0.0]
    sections = [{"kind": "flux", "name": f"at_{k}", "x": x} for k, x in enumerate((0.0, 0.2, 0.375, 0.39, 0.4))]
    s = simulation(given, output={"sensors": [*sections, {"kind": "force", "name": "floor", "wall": "z_min"}]})
    for _, _, discharge, area, *_ in Fluxes(s.case).rows(s):
        assert area == pytest.approx(DEPTH, rel=0.03) and discharge == pytest.approx(0.5 * area, rel=1e-6)
    for _ in range(3):
        s.step()
    floor = next(force for _, _, kind, *force in Forces(s.case).rows(s) if kind == "pressure")
    assert floor[2] == pytest.approx(-1000.0 * GRAVITY * DEPTH * 0.4, rel=0.03)
