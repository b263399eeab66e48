"""Contacts against closed forms and conservation laws."""

import math

import numpy as np
import pytest
from contact_cases import CORNER, EDGE, FLAT, HALF, MASS, MU, Plate, blocks, boxes, budget, case, go, momenta

from parsim.geometry.rotation import from_angles
from parsim.solid import contacts as contacts_module
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.laws.law import damping_of
from parsim.solid.shapes import elements_of


def drop(quaternion, **options):
    """A block that hits the floor at 0.5 m/s: (its restitution, energy budget over the energy before, contacts)."""
    bodies = blocks([(0.5, 0.5, 0.5)], quaternion=[quaternion], velocity=[(0.0, 0.0, -0.5)])
    bodies.position[0, 2] += 1e-4 - bodies.surface()[0][:, 2].min()
    contacts, before = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), **options)), bodies.kinetic_energy()
    go(bodies, contacts, 2e-4, 100)
    assert contacts.count == 0
    return bodies.velocity[0, 2] / 0.5, budget(bodies, contacts, (0.0, 0.0, 0.0)) / before, contacts


def test_damping_gives_the_restitution_of_the_oscillator():
    for restitution in (0.2, 0.5, 0.8545):
        b, x, v, dt = damping_of(restitution), 0.0, 1.0, 1e-5
        while True:  # midpoint rule of x'' = -x - 2 b x', until the force would pull
            force = -x - 2 * b * v
            xm, vm = x + dt / 2 * v, v + dt / 2 * force
            x, v = x + dt * vm, v + dt * (-xm - 2 * b * vm)
            if v < 0 and -x - 2 * b * v > 0:
                break
        assert -v == pytest.approx(restitution, abs=1e-4)


@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.8545])
@pytest.mark.parametrize("pose", [FLAT, EDGE, CORNER], ids=["face", "edge", "corner"])
def test_a_dropped_block_rebounds_by_its_restitution(pose, restitution):
    measured, kept, _ = drop(pose, restitution=restitution)
    assert measured == pytest.approx(restitution, rel=0.05)
    assert kept == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("spacing", [0.04, 0.01, 0.003])
def test_restitution_does_not_depend_on_the_number_of_elements(spacing, monkeypatch):
    monkeypatch.setattr(contacts_module, "elements_of", lambda bodies: elements_of(bodies, spacing))
    for pose in (FLAT, EDGE, CORNER):
        assert drop(pose, restitution=0.5)[0] == pytest.approx(0.5, abs=0.02)


def test_halving_substeps_converges():
    errors = []
    for steps in (20, 40, 80):
        measured, kept, _ = drop(FLAT, restitution=0.5, steps=steps)
        errors.append((abs(measured - 0.5), abs(kept - 1.0)))
    assert errors[0][0] > 1.7 * errors[1][0] > 1.7**2 * errors[2][0]  # dashpots lag by half a sub-step: order one
    assert max(kept for _, kept in errors) < 1e-12, "what is not held is dissipated"


def test_elastic_bounce_keeps_energy():
    for pose in (FLAT, EDGE, CORNER):
        measured, kept, contacts = drop(pose, restitution=1.0, friction=0.0)
        assert measured == pytest.approx(1.0, abs=2e-3) and kept == pytest.approx(1.0, abs=1e-12)
        assert contacts.elastic_energy() == 0.0, "all of it is given back"


def test_without_contact_one_exact_step():
    bodies = blocks([(0.5, 0.5, 0.5)], velocity=[(0.3, 0.2, 1.0)], spin=[(0.0, 0.0, 2.0)])
    contacts = Contacts(bodies, case())
    load = np.array([[0.1, 0.0, 0.0, 0.0, 0.0, 1e-5]])
    contacts.step(bodies, load, 0.0, 0.01)
    acceleration = np.array([0.1 / MASS, 0.0, -9.81])
    assert contacts.steps == 1 and contacts.limit() < math.inf
    assert bodies.position[0] == pytest.approx([0.503, 0.502, 0.51] + 0.5e-4 * acceleration, abs=1e-15)
    assert bodies.velocity[0] == pytest.approx([0.3, 0.2, 1.0] + 0.01 * acceleration, abs=1e-15)
    assert bodies.acceleration[0] == pytest.approx(acceleration)
    assert bodies.spin[0, 2] == pytest.approx(2.0 + 1e-7 / bodies.inertia[0, 2], rel=1e-14)
    assert bodies.gravity_load[0].tolist() == [0.0, 0.0, -9.81 * MASS, 0.0, 0.0, 0.0]
    assert bodies.water_load.tolist() == load.tolist() and not bodies.contact_load.any()


def test_a_block_rests_without_creep():
    bodies = blocks([(0.5, 0.5, HALF[2])])
    contacts = Contacts(bodies, case())
    go(bodies, contacts, 1e-3, 1000)
    settled = bodies.position.copy(), bodies.quaternion.copy()
    go(bodies, contacts, 1e-3, 500)
    assert np.abs(bodies.position - settled[0]).max() < 1e-12
    assert np.abs(bodies.quaternion - settled[1]).max() < 1e-12
    assert bodies.contact_load[0] == pytest.approx([0.0, 0.0, 9.81 * MASS, 0.0, 0.0, 0.0], abs=1e-9)


def on_slope(angle, layers, seconds, ramp=0.0):
    """Blocks on a slope of `angle`, degrees, tilted within `ramp`, s: (bodies, contacts, positions at the start)."""
    bodies = blocks([(0.3, 0.5, HALF[2] * (2 * k + 1)) for k in range(layers)])
    contacts, start = Contacts(bodies, case(young=1e8)), bodies.position.copy()
    for step in range(round(seconds / 5e-4)):
        tilt = math.radians(angle) * min(step * 5e-4 / ramp if ramp else 1.0, 1.0)
        tilted = 9.81 * math.sin(tilt), 0.0, -9.81 * math.cos(tilt)
        contacts._gravity_at = lambda time, tilted=tilted: tilted
        go(bodies, contacts, 5e-4, 1)
    return bodies, contacts, start


def test_a_block_holds_on_a_slope_below_the_friction_angle():
    bodies, contacts, start = on_slope(22.0, 1, 0.5)
    held = bodies.position.copy()
    assert np.abs(held - start).max() < 1e-5
    go(bodies, contacts, 5e-4, 500)
    assert np.abs(bodies.position - held).max() < 1e-10


def test_a_block_slides_on_a_slope_above_the_friction_angle():
    bodies, contacts, _ = on_slope(25.0, 1, 0.1)
    before = bodies.velocity[0, 0]
    go(bodies, contacts, 5e-4, 400)
    angle = math.radians(25.0)
    exact = 9.81 * (math.sin(angle) - MU * math.cos(angle))
    assert (bodies.velocity[0, 0] - before) / 0.2 == pytest.approx(exact, rel=0.01)


def test_a_stack_stands_on_a_slope():
    """Tilted slowly; switched on at once, gravity makes an elastic stack rattle and walk until that has died out."""
    bodies, _, start = on_slope(21.0, 3, 0.5, ramp=0.3)
    assert np.abs(bodies.position - start).max() < 2e-6
    assert bodies.kinetic_energy() < 1e-15


@pytest.mark.parametrize("yaw", [0.0, 20.0])
def test_a_stack_of_three_stands(yaw):
    bodies = blocks(
        [(0.5, 0.5, HALF[2] * (2 * k + 1)) for k in range(3)],
        quaternion=[from_angles((0.0, 0.0, yaw * k)) for k in range(3)],
    )
    start, contacts = bodies.position.copy(), Contacts(bodies, case())
    go(bodies, contacts, 1e-3, 2000)
    assert np.abs(bodies.position - start)[:, :2].max() < 1e-9
    assert np.abs(bodies.position - start)[:, 2].max() < 1e-5
    assert bodies.kinetic_energy() < 1e-15


def test_blocks_collide_head_on():
    bodies = blocks([(0.3, 0.5, 0.5), (0.38, 0.5, 0.5)], velocity=[(0.5, 0.0, 0.0), (-0.3, 0.0, 0.0)])
    contacts, before = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), restitution=0.8)), momenta(bodies)
    go(bodies, contacts, 2e-4, 200)
    assert (bodies.velocity[1, 0] - bodies.velocity[0, 0]) / 0.8 == pytest.approx(0.8, rel=0.02)
    for now, then in zip(momenta(bodies), before, strict=True):
        assert now == pytest.approx(then, abs=1e-16)
    assert not bodies.spin.any() or np.abs(bodies.spin).max() < 1e-12


@pytest.mark.parametrize(
    "poses",
    [
        (FLAT, from_angles((0.0, 0.0, 45.0))),
        (from_angles((20.0, 45.0, 7.0)), from_angles((0.0, 13.0, 41.0))),
        (from_angles((45.0, 0.0, 0.0)), from_angles((0.0, 45.0, 0.0))),
    ],
    ids=["face-edge", "skew", "edges crossing"],
)
def test_action_is_reaction(poses):
    bodies = Bodies(
        boxes(*[(0.03, 0.03, 0.03)] * 2),
        [MASS, 2 * MASS],
        [(0.5, 0.5, 0.6), (0.503, 0.501, 0.5)],
        quaternion=poses,
        velocity=[(0.1, 0.0, -0.5), (0.0, 0.0, 0.5)],
        spin=[(1.0, 2.0, 3.0), (0, 0, 0)],
    )
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), young=1e8))
    before, energy = momenta(bodies), bodies.kinetic_energy()
    go(bodies, contacts, 1e-4, 1000)
    assert bodies.velocity[0, 2] > bodies.velocity[1, 2] and contacts.count == 0, "they have parted"
    assert contacts.dissipated > 0.01 * energy
    assert budget(bodies, contacts, (0.0, 0.0, 0.0)) == pytest.approx(energy, rel=1e-6)
    for now, then in zip(momenta(bodies), before, strict=True):
        assert now == pytest.approx(then, abs=1e-14)


def test_crossing_edges_bounce():
    """Two bars whose edges cross midway between elements."""
    up, down = from_angles((45.0, 0.0, 0.0)), from_angles((0.0, 45.0, 0.0))
    bodies = Bodies(
        boxes((0.03, 0.01, 0.01), (0.01, 0.03, 0.01)),
        [MASS] * 2,
        [(0.507, 0.5, 0.55), (0.5, 0.507, 0.5)],
        quaternion=[up, down],
        velocity=[(0.0, 0.0, -0.5), (0.0, 0.0, 0.0)],
    )
    contacts, lowest = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), friction=0.0)), 1.0
    for _ in range(700):
        go(bodies, contacts, 1e-4, 1)
        lowest = min(lowest, bodies.position[0, 2] - bodies.position[1, 2])
    assert 0.0 < 2 * 0.01 * math.sqrt(2.0) - lowest < 2e-3
    assert bodies.velocity[0, 2] > bodies.velocity[1, 2]


def test_an_oblique_impact_slides_by_friction():
    bodies = blocks([(0.5, 0.5, HALF[2] + 1e-4)], velocity=[(1.0, 0.0, -0.1)])
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), restitution=0.8, friction=0.2))
    go(bodies, contacts, 2e-4, 50)
    change = bodies.velocity[0] - (1.0, 0.0, -0.1)
    assert change[0] / change[2] == pytest.approx(-0.2, rel=1e-9)  # sliding all the time


def test_a_raft_does_not_heat_up():
    gap, edge, work = 5e-3 / 3, 2 * HALF[0], 0.0
    places = [(0.1 + i * (edge + gap), 0.1 + j * (edge + gap), 0.5) for i in range(2) for j in range(2)]
    random = np.random.default_rng(1)
    bodies = blocks(places, velocity=random.normal(0.0, 0.05, (4, 3)) * (1, 1, 0))
    contacts, touched = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0))), 0
    start = bodies.kinetic_energy()
    for _ in range(1500):
        load = np.zeros((4, 6))
        load[:, :2] = random.normal(0.0, 0.02, (4, 2)) - 2.0 * (bodies.position[:, :2] - (0.137, 0.137))
        before, velocity = bodies.position.copy(), bodies.velocity
        contacts.step(bodies, load, 0.0, 2e-4)
        work += (load[:, :3] * (bodies.position - before)).sum()
        touched += contacts.count > 0
    assert touched > 20 and np.isfinite(velocity).all()
    elastic = contacts.elastic_energy()
    assert bodies.kinetic_energy() + elastic + contacts.dissipated == pytest.approx(start + work, rel=1e-3)
    assert contacts.dissipated > 0.0
    assert np.abs(bodies.position[:, 2] - 0.5).max() < 1e-4, "no kick out of the plane"


def test_aligned_corners_hardly_feel_each_other():
    bodies = blocks([(0.5, 0.5, 0.5), (0.5 + 2 * HALF[0] - 1e-7, 0.5 + 2 * HALF[1] - 1e-7, 0.5)])
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0)))
    contacts.step(bodies, np.zeros((2, 6)), 0.0, 2e-4)
    whole = contacts._pair_law[0, 0, 0] * 4 * HALF[0] * HALF[2] * 1e-7
    assert np.abs(bodies.contact_load).max() < 1e-3 * whole


def test_a_rising_gate_drags_a_block_by_friction():
    """Pressed against the plate with 5 N, a block of 0.089 kg is lifted by up to 2.06 N: it rises with the plate."""
    bodies = blocks([(0.5 - HALF[2], 0.5, 0.5)], quaternion=[from_angles((0.0, 90.0, 0.0))])
    contacts = Contacts(bodies, case(), [Plate()])
    load = np.array([[2.0, 0.0, 0.0, 0.0, 0.0, 0.0]])  # 0.824 N of friction against 0.873 N of weight: it slides down
    go(bodies, contacts, 2e-4, 250, load=load)
    assert bodies.velocity[0, 2] == pytest.approx((MU * 2.0 / MASS - 9.81) * 0.05, rel=0.02)
    assert contacts.driven_work == pytest.approx(MU * 2.0 * 0.4 * 0.05, rel=0.02)
    bodies = blocks([(0.5 - HALF[2], 0.5, 0.5)], quaternion=[from_angles((0.0, 90.0, 0.0))])
    contacts, load = Contacts(bodies, case(), [Plate()]), np.array([[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
    start, pushed = budget(bodies, contacts), bodies.position[0, 0]
    go(bodies, contacts, 2e-4, 1000, load=load)
    assert bodies.velocity[0, 2] == pytest.approx(0.4, abs=0.01)
    pushed = 5.0 * (bodies.position[0, 0] - pushed)
    assert budget(bodies, contacts) == pytest.approx(start + pushed, abs=1e-4 * contacts.driven_work)


def test_going_on_from_what_was_kept_gives_the_same_bits():
    bodies = blocks(
        [(0.5, 0.5, HALF[2]), (0.5, 0.51, 3 * HALF[2] + 1e-5)],
        velocity=[(0.3, 0, 0), (0, 0, 0)],
        quaternion=[FLAT, from_angles((0.0, 0.0, 10.0))],
    )
    contacts = Contacts(bodies, case())
    go(bodies, contacts, 2e-4, 100)
    kept = contacts.kept()
    assert len(kept["key"]) > 0 and kept["memory"].any()
    state = {name: getattr(bodies, name).copy() for name in ("position", "quaternion", "velocity", "spin")}
    other = blocks(state["position"], quaternion=state["quaternion"], velocity=state["velocity"], spin=state["spin"])
    resumed = Contacts(other, case())
    resumed.restore({name: values.copy() for name, values in kept.items()})
    assert resumed.elastic_energy() == contacts.elastic_energy() > 0.0
    go(bodies, contacts, 2e-4, 100, 0.02)
    go(other, resumed, 2e-4, 100, 0.02)
    for name in state:
        assert getattr(bodies, name).tobytes() == getattr(other, name).tobytes()
    assert {k: v.tobytes() for k, v in contacts.kept().items()} == {k: v.tobytes() for k, v in resumed.kept().items()}


def test_held_bodies_wait_and_fixed_ones_stay():
    bodies = blocks([(0.5, 0.5, 0.5), (0.5, 0.5, 0.3)], released=[0.01, -math.inf], fixed=[False, True])
    contacts = Contacts(bodies, case())
    go(bodies, contacts, 1e-3, 10)
    assert bodies.position[:, 2].tolist() == [0.5, 0.3] and not bodies.velocity.any()
    go(bodies, contacts, 1e-3, 400, 0.01)
    assert bodies.position[1, 2] == 0.3
    assert 0.3 + 2 * HALF[2] - 1e-3 < bodies.position[0, 2] < 0.499, "it fell onto the other one"
    assert contacts.dissipated > 0.0


def test_planar_bodies_stay_in_the_plane():
    bodies = Bodies(
        boxes(*[(0.05, 0.5, 0.02)] * 2),
        [5.0] * 2,
        [(0.5, 0.5, 0.1), (0.53, 0.5, 0.16)],
        planar=True,
        quaternion=[from_angles((0.0, 30.0, 0.0)), from_angles((0.0, -10.0, 0.0))],
    )
    given = case(young=1e8, restitution=0.3)
    given.dimensions = 2
    contacts = Contacts(bodies, given)
    go(bodies, contacts, 5e-4, 1000, load=np.array([[0.0, 1.0, 0.0, 1.0, 0.0, 1.0]] * 2))
    assert contacts.count > 0
    assert (bodies.position[:, 1] == 0.5).all() and not bodies.velocity[:, 1].any()
    assert not bodies.spin[:, [0, 2]].any() and not bodies.quaternion[:, [1, 3]].any()
    assert bodies.position[:, 2].min() > 0.0199


def test_bodies_meet_across_a_periodic_face():
    bodies = blocks([(0.04, 0.5, 0.5), (0.96, 0.5, 0.5)], velocity=[(-0.5, 0.0, 0.0), (0.5, 0.0, 0.0)])
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), walls=(), x_min="periodic", x_max="periodic"))
    go(bodies, contacts, 2e-4, 100)
    assert bodies.velocity[0, 0] == pytest.approx(0.5 * 0.8545, rel=0.02)
    assert bodies.velocity[1, 0] == -bodies.velocity[0, 0]


def test_nothing_to_move():
    contacts = Contacts(Bodies([], [], []), case())
    contacts.step(contacts.bodies, np.zeros((0, 6)), 0.0, 1e-3)
    assert contacts.limit() == math.inf and contacts.elastic_energy() == 0.0
