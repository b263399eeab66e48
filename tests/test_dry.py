"""Bodies without water: what a case needs, what moves them, the same bits on any ranks and after a restart."""

import numpy as np
import pytest
from contact_cases import boxes, budget, go
from contact_cases import case as contact_case

import parsim
from parsim.__main__ import main
from parsim.case.model import parse
from parsim.case.scales import gravity_at
from parsim.domain.comm import Comm
from parsim.errors import InputError
from parsim.run.simulation import Simulation
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.shapes import SphereShape

SLOPE = """
title = "Two balls and a box on a slope"
dimensions = 3
gravity = [2.0, 0.0, -9.6]
[box]
max = [0.6, 0.2, 0.4]
faces = {x_max = "open"}
[materials.wood]
young = 1e8
poisson = 0.3
friction = 0.4
restitution = 0.5
[run]
until = 0.12
"""
BODY = '[[bodies]]\nname = "{}"\nshape = {}\ndensity = 700.0\nposition = {}\nmaterial = "wood"\n'
BODIES = "".join(
    BODY.format(*words)
    for words in (
        ("one", '{kind = "sphere", diameter = 0.05}', [0.1, 0.1, 0.06]),
        ("two", '{kind = "sphere", diameter = 0.03}', [0.1, 0.105, 0.11]),
        ("box", "{size = [0.06, 0.06, 0.02]}", [0.15, 0.1, 0.012]),
    )
)
WOOD = {"wood": {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}}


def lone(**change):
    """A box in a box without water, as a dict."""
    body = {"name": "a", "shape": {"size": [0.1, 0.1, 0.04]}, "density": 500.0, "material": "wood"}
    case = {
        "dimensions": 3,
        "box": {"max": [1.0, 1.0, 1.0]},
        "materials": WOOD,
        "bodies": [body | {"position": [0.5, 0.5, 0.5]}],
        "run": {"until": 1.0},
    }
    return case | change


def test_a_case_without_water_needs_nothing_of_it():
    case = parse(lone())
    assert case.water.scheme.kind == "none" and case.spacing == pytest.approx(0.02)
    assert parse(lone(spacing=0.3)).spacing == 0.3, "nothing has to divide the box"
    assert case.warnings() == [] and case.sound_speed == np.inf
    wet = parse(lone(spacing=0.02, water={"speed": 1.0}))
    assert wet.water.scheme.kind == "wcmps", "who gives the speed of water may want some"


def test_a_body_falls_as_it_should():
    s = Simulation(parse(lone()), Comm())
    while s.time < 0.2:
        s.step()
    assert s.bodies.velocity[0, 2] == pytest.approx(-9.81 * s.time, rel=1e-12)
    assert s.bodies.position[0, 2] == pytest.approx(0.5 - 0.5 * 9.81 * s.time**2, rel=1e-9)


def test_a_body_passes_a_periodic_side():
    faces = {f"{a}_{s}": "periodic" for a in "xy" for s in ("min", "max")}
    body = lone()["bodies"][0] | {"position": [0.9, 0.5, 0.02], "velocity": [2.0, 0.0, 0.0]}
    s = Simulation(parse(lone(box={"max": [1.0, 1.0, 1.0], "faces": faces}, bodies=[body])), Comm(True))
    while s.time < 0.1:
        s.step()
    assert s.bodies.position[0, 0] > 1.0 and s.bodies.velocity[0, 0] < 2.0, "and rubs on the floor beyond"


@pytest.mark.long
def test_the_same_bits_on_two_ranks_and_after_a_restart(tmp_path, mpirun, capsys):
    case = tmp_path / "slope.toml"
    case.write_text(SLOPE + BODIES)
    assert main(["run", str(case), "-o", str(tmp_path / "one")]) == 0
    assert parsim.open(tmp_path / "one").series("energy")["dissipated_contacts"][-1] > 0.0
    done = mpirun(2, ["run", case, "-o", tmp_path / "two", "--until", "0.06"])
    assert done.returncode == 0, done.stderr
    assert main(["resume", str(tmp_path / "two"), "--until", "0.12"]) == 0
    assert main(["compare", str(tmp_path / "one"), str(tmp_path / "two")]) == 0, capsys.readouterr().out


def test_gravity_may_grow_from_nothing():
    """A ball falls g t^3 / (6 ramp) meanwhile; the account of energy has the work that this takes."""
    shape = SphereShape(kind="sphere", diameter=0.1)
    ball = Bodies([shape], [1.0], [(0.5, 0.5, 0.9)])
    contacts = Contacts(ball, contact_case(ramp=0.4, restitution=0.5))
    go(ball, contacts, 1e-3, 300)
    assert ball.position[0, 2] == pytest.approx(0.9 - 9.81 * 0.3**3 / (6 * 0.4), rel=1e-5)
    potential = ball.potential_energy(gravity_at(contact_case(ramp=0.4), 0.3))
    assert ball.kinetic_energy() + potential - contacts.driven_work == pytest.approx(0.0, abs=1e-4)
    go(ball, contacts, 1e-3, 3000, time=0.3)
    assert ball.kinetic_energy() < 1e-6
    assert budget(ball, contacts) == pytest.approx(0.0, abs=0.03)


def test_water_has_its_weight_from_the_start():
    with pytest.raises(InputError, match="gravity_ramp = 0.5: water has its weight from the start; see run.settle"):
        fill = {"min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.5]}
        parse(lone(spacing=0.02, water={"fill": [fill]}, gravity_ramp=0.5))


@pytest.mark.parametrize(("young", "doubtful"), [(1e5, True), (1e9, False)])
def test_bodies_that_overlap_too_much_are_told(young, doubtful):
    block = Bodies(boxes((0.05, 0.05, 0.05)), [1.0], [(0.5, 0.5, 0.06)], velocity=[(0.0, 0.0, -2.0)])
    contacts = Contacts(block, contact_case(young=young))
    go(block, contacts, 1e-4, 200)
    assert (contacts.overlap > 0.01) == doubtful
    told = list(contacts.doubts())
    assert bool(told) == doubtful and (not told or "of the least width of one" in told[0])
