"""No contact creates energy, whatever touches whatever, however it moves."""

import numpy as np
import pytest
from contact_cases import FLAT, GRAVITY, Plate, blocks, boxes, budget, case, go

from parsim.geometry.rotation import from_angles, turn_of, turned
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.separation import direction
from parsim.solid.shapes import BoxShape, SphereShape

DRAWS, STEPS = 2000, 10
KEPT = ("position", "quaternion", "velocity", "spin")


class Moving(Plate):
    """A gate whose lower edge moves at a steady speed."""

    def __init__(self, start, speed):
        self._start, self._speed = start, speed

    def bottom(self, time):
        return self._start + self._speed * time

    def velocity(self, time):
        return self._speed


def heap(random):
    """Up to four boxes that fly at the lower edge of a gate, many all but upright: (bodies, contacts, loads, step)."""
    count, planar = random.integers(1, 5), random.random() < 0.2
    half, away = random.uniform(0.01, 0.03, (count, 3)), random.uniform(-0.08, 0.08, (count, 3))
    axes = (0.0, 1.0, 0.0) if planar else (1.0, 1.0, 1.0)
    turn = [
        turned(
            turn_of(*random.normal(0.0, 10.0 ** random.uniform(-5.0, 0.5), 3) * axes),
            from_angles(random.choice([0.0, 45.0, 90.0], 3) * axes),
        )
        for _ in range(count)
    ]
    bodies = Bodies(
        boxes(*half),
        900.0 * 8.0 * half.prod(axis=1),
        (0.5, 0.5, 0.1) + away,
        quaternion=turn,
        velocity=random.normal(0.0, 0.5, (count, 3)) - 30.0 * away,
        planar=planar,
        spin=random.normal(0.0, 10.0, (count, 3)),
        fixed=random.random(count) < 0.1,
    )
    given = case(
        restitution=random.uniform(0.05, 1.0),
        friction=random.choice([0.0, 0.4, 1.0]),
        young=10.0 ** random.uniform(5.0, 8.0),
        steps=random.choice([5, 20]),
    )
    given.dimensions = 2 if planar else 3
    gate = [Moving(random.uniform(0.05, 0.15), random.normal(0.0, 0.5))] if random.random() < 0.7 else []
    loads = np.zeros((count, 6))
    loads[~bodies.fixed, :3] = random.normal(0.0, 0.5, (np.count_nonzero(~bodies.fixed), 3))
    contacts = Contacts(bodies, given, gate)
    return bodies, contacts, loads, min(contacts.limit(), 1e-2) * random.uniform(0.3, 1.0)


def test_no_contact_creates_energy():
    """0.1 % is what was asked for; only free rotation makes any, 1e-7 in a step."""
    touched = 0
    for seed in range(DRAWS):
        bodies, contacts, loads, dt = heap(np.random.default_rng(seed))
        given, allowed = budget(bodies, contacts), 1e-6 * bodies.kinetic_energy() + 1e-12
        for step in range(STEPS):
            before = bodies.position.copy()
            contacts.step(bodies, loads, step * dt, dt)
            given += (loads[:, :3] * (bodies.position - before)).sum()
            held = bodies.kinetic_energy() + bodies.potential_energy(GRAVITY) + contacts.elastic_energy()
            assert held <= given + contacts.driven_work + allowed, (seed, step)
        touched += contacts.overlap > 0.0
    assert touched > DRAWS / 3


def test_a_restart_amid_contacts_has_the_same_bits():
    pressed = 0
    for seed in range(100):
        bodies, contacts, loads, dt = heap(np.random.default_rng(seed))
        other, resumed, _, _ = heap(np.random.default_rng(seed))
        for step in range(2 * STEPS):
            contacts.step(bodies, loads, step * dt, dt)
            if step == STEPS:
                other.restore(bodies.kept())
                resumed.restore(contacts.kept())
                pressed += contacts.kept()["stored"].any()
            elif step > STEPS:
                resumed.step(other, loads, step * dt, dt)
        for one, two in ((bodies, other), (contacts, resumed)):
            assert {k: v.tobytes() for k, v in one.kept().items()} == {k: v.tobytes() for k, v in two.kept().items()}
    assert pressed > 20


def test_normals_turn_at_most_twenty_times_as_fast_as_the_boxes():
    """Those of nearly parallel edges would turn without bound, and depths with them, within a step."""
    random, turn, crossing = np.random.default_rng(4), 1e-4, 0
    for _ in range(300):
        tilt = np.array(turn_of(*random.normal(0.0, 10.0 ** random.uniform(-4.0, -0.5), 3)))
        small = turn_of(*(turn * v for v in (0.6, 0.0, 0.8)))
        normals = []
        for pose in (tilt, np.array(turned(small, tilt))):
            bodies = blocks([(0.5, 0.5, 0.5), (0.5, 0.5, 0.51)], quaternion=[pose, FLAT])
            contacts = Contacts(bodies, case(walls=()))
            contacts._prepare(bodies, bodies.fixed, 0.0, 0.0)
            normals.append(np.array([direction(contacts._table, 0, 1, feature) for feature in range(6, 15)]))
        both = normals[0].any(axis=1) & normals[1].any(axis=1)
        crossing += np.count_nonzero(both[[0, 4, 8]])
        assert np.linalg.norm(normals[1] - normals[0], axis=1)[both].max() < 1.01 * turn / 0.05
    assert 20 < crossing < 600, "some edges cross, some are all but parallel"


@pytest.mark.parametrize("yaw", [0.0, 0.01, 1.0, 3.0, 5.0])
def test_an_elastic_block_leaves_the_edge_of_a_gate_no_faster_than_it_came(yaw):
    bodies = blocks([(0.5, 0.5, 0.4)], quaternion=[from_angles((0.0, 60.0, yaw))], velocity=[(0.0, 0.0, 0.5)])
    top = bodies.surface()[0][np.argmax(bodies.surface()[0][:, 2])]
    bodies.position[0] += 0.5025 - top[0], 0.0, 0.5 - 1e-4 - top[2]
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), friction=0.0, restitution=1.0), [Moving(0.5, 0.0)])
    came = bodies.kinetic_energy()
    go(bodies, contacts, 1e-4, 150)
    assert contacts.count == 0 and abs(bodies.spin[0, 1]) > 1.0, "it has been hit"
    assert 0.95 * came < bodies.kinetic_energy() < (1.0 + 1e-6) * came


@pytest.mark.parametrize("shape", [BoxShape(size=(0.05, 0.05, 0.02)), SphereShape(kind="sphere", diameter=0.05)])
@pytest.mark.parametrize("count", [2, 3, 6])
@pytest.mark.parametrize("deep", [1e-6, 1e-4, 2e-3])
def test_a_row_of_bodies_deep_in_each_other_comes_no_closer(shape, count, deep):
    """Far too large on both sides of a body, forces hold each other up, and to limit each by its tank takes rounds."""
    speed, place = np.zeros((count, 3)), np.full((count, 3), 0.5)
    place[:, 0] = 0.3 + (0.05 - deep) * np.arange(count)
    speed[:, 0] = 0.05 * np.linspace(1.0, -1.0, count)
    bodies = Bodies([shape] * count, [0.03] * count, place, velocity=speed)
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), walls=(), young=3e9, restitution=0.5), [])
    came, steps = bodies.kinetic_energy(), 100
    go(bodies, contacts, 2e-4, steps)
    apart = np.diff(bodies.position[:, 0]).min()
    assert apart > 0.05 - deep - 3e-5, "they would have come 1 mm closer"
    assert bodies.kinetic_energy() < (1.0 + 1e-6) * came


@pytest.mark.parametrize("speed", [0.0, 0.05])
@pytest.mark.parametrize("shape", [BoxShape(size=(0.05, 0.05, 0.05)), SphereShape(kind="sphere", diameter=0.05)])
def test_what_begins_deep_in_the_floor_lies_there_at_rest(shape, speed):
    """Nothing has been put into its springs: the floor bears its weight, and stops it without giving speed back."""
    bodies = Bodies([shape], [0.03], [(0.5, 0.5, 0.0225)], velocity=[(0.0, 0.0, -speed)])
    contacts = Contacts(bodies, case(young=1e7, restitution=0.9))
    start = bodies.position[0, 2]
    go(bodies, contacts, 1e-3, 500)
    assert bodies.position[0, 2] == pytest.approx(start, abs=1e-4)
    assert np.abs(bodies.velocity).max() < 1e-3
