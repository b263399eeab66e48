"""What is told does not hang on where a place is named: images, datums, parts of walls, what has left."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from flows import GRAVITY, WOOD, merged, simulation, tank

from parsim.case.estimate import disk
from parsim.case.model import parse
from parsim.geometry.faces import images
from parsim.observe.counts import Counts
from parsim.observe.energy import Energy
from parsim.observe.fluxes import Fluxes
from parsim.observe.forces import Forces
from parsim.observe.gauges import Gauges
from parsim.observe.levels import Levels
from parsim.observe.observers import TABLES
from parsim.observe.peaks import Peaks
from parsim.output.compare import Ledger, _compare_fields

LONG = 0.4


def ring(**changes):
    """A box that repeats along x, half of it full to 0.1 m."""
    return simulation(tank(LONG, 0.2, 0.02, fill=(0.2, 0.1), periodic="x"), **changes)


def test_images_are_those_within_reach():
    case = parse(tank(LONG, 0.2, 0.02, periodic="x"))
    found, of = images(case, np.array([[0.05, 0.0], [0.81, 0.0], [0.2, 0.0]]), np.array([0.1, 0.02, 0.1]))
    assert of.tolist() == [0, 1, 2, 0, 1]
    assert found[:, 0] == pytest.approx([0.05, 0.01, 0.2, 0.45, 0.41])
    case = parse(tank(LONG, 0.2, 0.02))
    found, of = images(case, np.array([[-1.0, 0.0]]), np.array([9.0]))
    assert found.tolist() == [[-1.0, 0.0]] and of.tolist() == [0]


def test_levels_are_the_same_at_both_names_of_a_periodic_side():
    gauges = [{"name": name, "x": x} for name, x in (("a", 0.0), ("b", LONG))]
    line = {"kind": "levels", "name": "l", "start": [0.0, 0.0], "end": [LONG, 0.0], "points": 5}
    s = ring(output={"sensors": [*gauges, line]})
    s.step()
    one, other = (row[-1] for row in Gauges(s.case).rows(s))
    assert one == other == pytest.approx(0.1, abs=0.01)
    first, *_, last = (row[-2:] for row in Levels(s.case).rows(s))
    assert first == last == pytest.approx([0.1, 0.1], abs=0.02)


@pytest.mark.parametrize("x", [0.2, 0.2 + LONG, 0.2 - 3.0 * LONG])
def test_water_in_a_body_is_seen_however_often_that_went_round(x):
    body = {"name": "a", "shape": {"size": [0.08, 1.0, 0.08]}, "density": 500.0, "material": "wood",
            "position": [0.2, 0.5, 0.16]}  # fmt: skip
    s = ring(materials=WOOD, bodies=[body])
    p, i = s.domain.particles, s.near.fluid[0]
    column = list(TABLES["counts"])[2:].index("in_bodies")
    for inside in (0.2, 0.23):
        p.x[i], p.z[i] = inside, 0.16
        s.bodies.position[0, 0] = x
        assert Counts(s.case).rows(s)[0][column] == 1
        s.bodies.position[0, 0] = x + 0.2  # across the side
        assert Counts(s.case).rows(s)[0][column] == 0
        p.x[i] = (inside + 0.2) % LONG
        assert Counts(s.case).rows(s)[0][column] == 1
        p.x[i], p.z[i] = inside, 0.05


@pytest.mark.parametrize("datum", [0.0, -0.4, 250.0])
def test_energy_is_told_from_the_floor_of_the_box(datum):
    given = tank(LONG, 0.2, 0.02, fill=(0.2, 0.1))
    given["box"] |= {"min": [0.0, 0.0, datum], "max": [LONG, 1.0, datum + 0.2]}
    given["water"]["fill"] = [{"min": [0.0, 0.0, datum], "max": [0.2, 1.0, datum + 0.1]}]
    body = {"name": "a", "shape": {"size": [0.08, 1.0, 0.08]}, "density": 500.0, "material": "wood",
            "position": [0.3, 0.5, datum + 0.1]}  # fmt: skip
    s = simulation(given, materials=WOOD, bodies=[body])
    row = dict(zip(list(TABLES["energy"])[2:], Energy(s.case).rows(s)[0], strict=True))
    assert row["potential_water"] == pytest.approx(0.2 * 0.1 * 1000.0 * GRAVITY * 0.05, rel=1e-6)
    assert row["potential_bodies"] == pytest.approx(s.bodies.mass[0] * GRAVITY * 0.1, rel=1e-6)


def test_a_slope_does_work_along_an_axis_that_repeats():
    """Half full of water that flows down it; and a body above."""
    body = {"name": "a", "shape": {"size": [0.08, 1.0, 0.08]}, "density": 500.0, "material": "wood",
            "position": [0.2, 0.5, 0.25]}  # fmt: skip
    given = tank(LONG, 0.4, 0.02, fill=(LONG, 0.1), periodic="x")
    s = simulation(given, materials=WOOD, bodies=[body], gravity=[1.0, 0.0, -GRAVITY])
    watched, columns = Energy(s.case), list(TABLES["energy"])[2:]
    total, work = columns.index("total"), columns.index("work_driven")
    (before,) = watched.rows(s)
    while s.time < 0.1:
        s.step()
    (after,) = watched.rows(s)
    mass = s.near.fluid.size * s.scheme.mass + s.bodies.mass[0]
    assert after[work] == pytest.approx(0.5 * mass * 0.1**2, rel=0.02)
    assert after[total] - before[total] - after[work] == pytest.approx(0.0, abs=0.02 * after[work])


def test_a_flux_at_an_open_side_is_that_beside_it():
    given = tank(0.6, 0.3, 0.02, fill=(0.6, 0.2))
    given["box"]["faces"] = {"x_max": "open"}
    given["water"] |= {"speed": 3.0, "fill": [given["water"]["fill"][0] | {"velocity": [1.0, 0.0, 0.0]}]}
    sensors = [{"kind": "flux", "name": name, "x": x} for name, x in (("a", 0.6), ("b", 0.56), ("c", 0.5))]
    s = simulation(given, gravity=[0.0, 0.0, 0.0], output={"sensors": sensors})
    while s.time < 0.12:
        s.step()
    found = [row[2] for row in Fluxes(s.case).rows(s)]
    assert found == pytest.approx([found[2]] * 3, rel=0.05)


@pytest.mark.parametrize("ends", [(0.101, 0.109), (0.105, 0.195), (0.1, 0.2), (0.0, LONG)])
def test_a_patch_carries_what_stands_on_it(ends):
    patch = {"kind": "force", "name": "a", "wall": "z_min", "min": [ends[0], 0.0, 0.0], "max": [ends[1], 1.0, 0.2]}
    s = simulation(tank(LONG, 0.2, 0.02, fill=(LONG, 0.1)), output={"sensors": [patch]})
    for _ in range(3):
        s.step()
    (_, _, _, *force), _ = Forces(s.case).rows(s)
    assert force == pytest.approx([0.0, 0.0, -1000.0 * GRAVITY * 0.1 * (ends[1] - ends[0])], rel=0.01, abs=1e-9)


def test_what_acted_before_a_body_left_is_told():
    body = {"name": "a", "shape": {"size": [0.08, 1.0, 0.08]}, "density": 500.0, "material": "wood",
            "position": [0.3, 0.5, 0.15]}  # fmt: skip
    load = {"kind": "load", "name": "l", "body": "a"}
    case = parse(merged(tank(LONG, 0.2, 0.02), {"materials": WOOD, "bodies": [body], "output": {"sensors": [load]}}))
    watched, loads = Peaks(case), [np.full((1, 6), 5.0), np.full((1, 6), np.nan)]
    seen = SimpleNamespace(dt=0.1, step_count=1, bodies=SimpleNamespace(names=["a"]))
    for each in loads:
        seen.bodies.shown = lambda _, each=each: each
        watched.see(seen)
    row = watched.rows(seen)[0]
    assert row[4] == pytest.approx(2.5) and row[10] == row[16] == 5.0 and row[22] == pytest.approx(0.5)
    watched.see(seen)
    assert np.isnan(watched.rows(seen)[0][4:]).all() and json.dumps(watched.kept())


def test_frames_without_particles_differ_by_a_name():
    ledger = Ledger()
    one, other = ({"id": np.zeros(0, int), "step": 3, "time": time} for time in (0.1, 0.2))
    _compare_fields(ledger, "frames of water", one, other)
    assert ledger.first().item == "the frame itself"


def test_sensors_that_mislead_are_doubted_and_long_lines_take_room():
    line = {"kind": "velocity", "name": "v", "x": 0.1, "width": 0.01}
    flux = {"kind": "flux", "name": "f", "x": 0.03}
    given = tank(LONG, 0.2, 0.02, fill=(LONG, 0.1))
    plain = parse(given)
    given["box"]["faces"] = {"x_min": {"kind": "inlet", "discharge": 0.01}, "x_max": {"kind": "outlet", "level": 0.1}}
    doubts = parse(merged(given, {"output": {"sensors": [line, flux]}})).warnings()
    assert any("output.sensors.v.width = 0.01: less than the spacing, 0.02 m" in text for text in doubts)
    assert any("output.sensors.f.x = 0.03: 0.03 m from the inlet" in text for text in doubts)
    levels = {"kind": "levels", "name": "l", "start": [0.0, 0.0], "end": [LONG, 0.0], "points": 10000}
    many = parse(merged(tank(LONG, 0.2, 0.02, fill=(LONG, 0.1)), {"output": {"sensors": [levels]}}))
    assert disk(many, 100)[1] > 1000 * disk(plain, 100)[1]
