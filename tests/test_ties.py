"""Joints beside contacts and sub-steps: stiff springs, slack ropes, two free turns, loads of what is driven or held."""

import math

import numpy as np
import pytest
from contact_cases import GRAVITY, HALF, MASS, boxes, budget, case, go

from parsim.geometry.rotation import from_angles, matrices
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.joints.drives import SteadyTable
from parsim.solid.joints.lock import LockTable
from parsim.solid.joints.spring import SpringTable
from parsim.solid.laws import DEFAULT
from parsim.solid.laws.impulse import ImpulseLaw

HARD = ImpulseLaw(kind="impulse")
WEIGHTLESS = (0.0, 0.0, 0.0)
LAWS = pytest.mark.parametrize("law", [DEFAULT, HARD], ids=["soft", "hard"])


def tied(*joints, law=DEFAULT, gravity=GRAVITY, position=(0.5, 0.5, 0.5), **state):
    """One block and its contacts, far from all walls."""
    body = Bodies(boxes(HALF), [MASS], [position], names=["a"], joints=joints, **state)
    return body, Contacts(body, case(gravity=gravity, walls=(), law=law))


def spring(**given):
    """A spring of body a."""
    return SpringTable(**{"kind": "spring", "body": "a", "to": (0.5, 0.5, 0.7), "stiffness": 20.0} | given)


@LAWS
def test_a_spring_stiffer_than_the_step_swings_on(law):
    """dt sqrt(k/m) = 5: a whole step would blow up."""
    dt = 1e-3
    body, contacts = tied(spring(stiffness=MASS * (5.0 / dt) ** 2, length=0.2), law=law, velocity=[(0.0, 0.0, 0.1)])
    before = budget(body, contacts)
    most = 0.0
    for step in range(300):
        go(body, contacts, dt, 1, time=step * dt)
        most = max(most, abs(body.velocity[0, 2]))
        assert budget(body, contacts) == pytest.approx(before, abs=0.02 * 0.5 * MASS * 0.1**2)
    assert 0.09 < most < 0.102 and contacts.steps > 20


@LAWS
@pytest.mark.parametrize("offset", [0.0, 0.3, 0.7])
def test_a_rope_that_goes_taut_gives_no_energy(law, offset):
    """A block falls into a rope that stops it within a fraction of a step, and swings under it."""
    dt, length = 1e-3, 0.25
    at = (0.52, 0.5, 0.5 + 1e-3 * offset)
    rope = spring(stiffness=MASS * (4.0 / dt) ** 2, length=length, slack=True)
    body, contacts = tied(rope, law=law, position=at)
    before, stretched = budget(body, contacts), 0.0
    for step in range(1500):
        go(body, contacts, dt, 1, time=step * dt)
        stretched = max(stretched, np.linalg.norm(body.position[0] - (0.5, 0.5, 0.7)) - length)
        assert budget(body, contacts) < before + 0.01 * MASS * 9.81 * length
    assert 0.0 < stretched < 0.01, "it became taut, and held"


@LAWS
def test_the_first_row_knows_what_springs_hold(law):
    body, contacts = tied(spring(length=0.1), law=law)
    assert contacts.elastic_energy() == pytest.approx(0.5 * 20.0 * 0.1**2)


def test_several_dampers_off_the_axis_calm_a_body():
    """Each alone would let a whole step be; together they would not."""
    each = [spring(to=(0.5 + x, 0.5, 0.9), at=(x, 0.0, 0.0), damping=100.0) for x in (-0.03, -0.01, 0.01, 0.03)]
    body, contacts = tied(*each, gravity=WEIGHTLESS, velocity=[(0.0, 0.0, 1.0)], spin=[(0.0, 5.0, 0.0)])
    before = budget(body, contacts, WEIGHTLESS)
    go(body, contacts, 1e-3, 100)
    assert body.kinetic_energy() < 1e-2 and contacts.dissipated > 0.0
    assert budget(body, contacts, WEIGHTLESS) == pytest.approx(before, rel=0.02)


def test_a_spring_turns_with_its_body_however_far_it_is_fixed():
    """A long arm under tension swings as a pendulum does."""
    body, contacts = tied(
        spring(at=(0.0, 0.0, 0.009), to=(0.5, 0.5, 0.56), stiffness=1e4, length=0.04),
        gravity=WEIGHTLESS,
        quaternion=[from_angles((0.0, 40.0, 0.0))],
    )
    before = budget(body, contacts, WEIGHTLESS)
    for step in range(1000):
        go(body, contacts, 1e-3, 1, time=1e-3 * step)
        assert budget(body, contacts, WEIGHTLESS) == pytest.approx(before, rel=0.02)


def _exact(axes, inertia, turn, spin, dt, steps):
    """Runge-Kutta solution of a body that turns about two `axes` of space: spin (3,) at the end."""

    def rate(turn, spin):
        moments = turn @ inertia @ turn.T
        gyro = np.cross(spin, moments @ spin)
        out = np.zeros(3)
        out[axes] = np.linalg.solve(moments[np.ix_(axes, axes)], -gyro[axes])
        cross = np.array([[0, -spin[2], spin[1]], [spin[2], 0, -spin[0]], [-spin[1], spin[0], 0]])
        return cross @ turn, out

    for _ in range(steps):
        k1 = rate(turn, spin)
        k2 = rate(turn + 0.5 * dt * k1[0], spin + 0.5 * dt * k1[1])
        k3 = rate(turn + 0.5 * dt * k2[0], spin + 0.5 * dt * k2[1])
        k4 = rate(turn + dt * k3[0], spin + dt * k3[1])
        turn = turn + dt / 6.0 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        spin = spin + dt / 6.0 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
    return spin


def test_two_free_turns_trade_their_spin_in_order_two():
    """One turn locked, no torque: the moments about the two others change as the body turns."""
    pose, spin = from_angles((20.0, 30.0, 40.0)), np.array((0.0, 3.0, 2.0))
    lock, errors = LockTable(kind="lock", body="a", locked=("turn_x",)), []
    for steps in (100, 200):
        body, contacts = tied(lock, gravity=WEIGHTLESS, quaternion=[pose], spin=[spin])
        before = body.kinetic_energy()
        go(body, contacts, 1.0 / steps, steps)
        exact = _exact([1, 2], np.diag(body.inertia[0]), matrices(np.array(pose)[None])[0], spin, 5e-4, 2000)
        errors.append(np.abs(body.spin[0] - exact).max())
        assert body.spin[0, 0] == 0.0
    assert errors[1] < 1e-3 and 3.5 < errors[0] / errors[1] < 4.5
    assert np.abs(exact - spin).max() > 0.3, "the spins do change"
    go(body, contacts, 1e-3, 20000)
    assert body.kinetic_energy() == pytest.approx(before, rel=1e-5)


@LAWS
def test_what_is_driven_and_what_is_held_feel_what_lies_on_them(law):
    """A block on a driven one on a fixed one: their contact loads are in balance, the joint carries both weights."""
    x, y, z = 0.5, 0.5, HALF[2]
    joint = SteadyTable(kind="steady", body="b", velocity=(0.0, 0.0, 0.0))
    bodies = Bodies(
        boxes(HALF, HALF, HALF, HALF),
        [MASS] * 4,
        [(x, y, 3 * z), (x, y, z), (x - 0.2, y, z), (x - 0.2, y, 3 * z)],
        names=["a", "b", "c", "d"],
        fixed=[False, False, True, False],
        joints=[joint],
    )
    contacts = Contacts(bodies, case(law=law, walls=()))
    go(bodies, contacts, 1e-3, 400)
    weight = 9.81 * MASS
    assert bodies.contact_load[:, 2] == pytest.approx([weight, -weight, -weight, weight], rel=1e-3)
    assert bodies.joint_load[1, 2] == pytest.approx(2.0 * weight, rel=1e-3)


def test_what_holds_a_body_carries_it_not_its_joint():
    body, contacts = tied(spring(length=0.1), released=1.0)
    go(body, contacts, 1e-3, 10)
    assert body.joint_load[0] == pytest.approx([0.0, 0.0, 2.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("joint", [spring(), SteadyTable(kind="steady", body="a", velocity=(0.0, 0.0, 1.0))])
def test_what_has_left_the_box_is_tied_no_more(joint):
    body, contacts = tied(joint, velocity=[(0.0, 0.0, 1.0)] if joint.kind == "steady" else 0.0)
    go(body, contacts, 1e-3, 5)
    body.take_out(np.zeros(3), np.array((1.0, 1.0, 0.4)), 0.005)
    assert body.gone[0]
    place = body.position.copy()
    go(body, contacts, 1e-3, 5, time=0.005)
    assert np.array_equal(body.position, place) and contacts.elastic_energy() == 0.0
    assert math.isfinite(contacts.driven_work) and not body.spring_load.any()


@LAWS
@pytest.mark.parametrize(("stiffness", "height"), [(2e4, 0.00005), (4e5, 0.05)])
def test_no_spring_pulls_a_body_through_a_wall(law, stiffness, height):
    """From rest, in one step of the water; energy stays what it was."""
    rope = spring(to=(0.5, 0.5, -0.5), stiffness=stiffness, length=0.45)
    body = Bodies(boxes(HALF), [MASS], [(0.5, 0.5, HALF[2] + height)], names=["a"], joints=[rope])
    contacts = Contacts(body, case(law=law, young=1e9))
    before = budget(body, contacts)
    for step in range(60):
        go(body, contacts, 1e-3, 1, time=1e-3 * step)
        assert body.position[0, 2] > HALF[2] - 0.005
        assert budget(body, contacts) == pytest.approx(before, rel=0.03)


def test_gravity_that_grows_does_no_work_on_what_has_left():
    bodies = Bodies(boxes(HALF, HALF), [MASS] * 2, [(0.5, 0.5, 0.5), (0.5, 0.5, -5.0)])
    contacts = Contacts(bodies, case(walls=(), ramp=0.1))
    go(bodies, contacts, 1e-3, 5)
    bodies.take_out(np.zeros(3), np.ones(3), 0.005)
    before = contacts.driven_work
    go(bodies, contacts, 1e-3, 5, time=0.005)
    assert abs(contacts.driven_work - before) < 1.0


def test_a_fixed_body_under_many_takes_no_more_steps_than_under_one():
    steps = []
    for count in (1, 5):
        places = [(0.5, 0.5, -0.01), *((0.2 + 0.15 * k, 0.5, HALF[2] + 1e-6) for k in range(count))]
        bodies = Bodies(
            boxes((0.5, 0.5, 0.01), *[HALF] * count), [1.0, *[MASS] * count], places, fixed=[True, *[False] * count]
        )
        contacts = Contacts(bodies, case(walls=()))
        go(bodies, contacts, 1e-3, 20)
        steps.append(contacts.steps)
    assert steps[1] <= 1.2 * steps[0]
