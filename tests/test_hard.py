"""Hard bodies (the law "impulse") against closed forms: bounces, slopes, oblique hits, stacks, gates, restarts."""

import math

import numpy as np
import pytest
from contact_cases import HALF, MASS, Plate, boxes, budget, case, go

from parsim.geometry.rotation import from_angles
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.laws.impulse import ImpulseLaw
from parsim.solid.shapes import BoxShape, DiscShape, PrismShape, SphereShape

LAW = ImpulseLaw(kind="impulse")
BALL = SphereShape(kind="sphere", diameter=0.1)


def hard(bodies, **options):
    """Contacts of hard bodies."""
    given = case(**{"law": LAW, "restitution": 0.3, **options})
    given.dimensions = 2 if bodies.planar else 3
    return Contacts(bodies, given)


@pytest.mark.parametrize(("shape", "planar"), [(BALL, False), (DiscShape(kind="disc", diameter=0.1), True)])
@pytest.mark.parametrize("dt", [1e-3, 3.7e-3])
def test_a_ball_bounces_by_its_restitution_and_then_lies(shape, planar, dt):
    """Robb 2016, sec. 5.1: apexes 0.5 e^(2 n) m, whatever the step; at rest after 2.873 s."""
    ball = Bodies([shape], [1.0], [(0.5, 0.5, 0.55)], planar=planar)
    contacts, apexes, before = hard(ball, restitution=0.8), [], 0.0
    for step in range(int(3.5 / dt)):
        go(ball, contacts, dt, 1, time=step * dt)
        speed, height = ball.velocity[0, 2], ball.position[0, 2] - 0.05
        if before > 0.0 >= speed:
            apexes.append(height + speed * speed / 19.62)
        before = speed
    exact = 0.5 * 0.64 ** np.arange(1, 11)
    assert apexes[:10] == pytest.approx(exact, rel=1e-4)
    assert not ball.velocity.any() and -1e-5 < ball.position[0, 2] - 0.05 <= 0.0
    assert contacts.dissipated == pytest.approx(9.81 * 0.5, rel=1e-4)


@pytest.mark.parametrize("slope", [15.0, 22.0, 25.0, 30.0])
def test_a_block_lies_on_a_slope_or_slides_by_coulomb(slope):
    """Friction 0.412 holds to 22.4 degrees (Mellado 2021)."""
    a = math.radians(slope)
    block = Bodies([BoxShape(size=(0.08, 0.08, 0.04))], [0.2], [(0.3, 0.5, 0.02)])
    contacts = hard(block, gravity=(9.81 * math.sin(a), 0.0, -9.81 * math.cos(a)), friction=0.412)
    go(block, contacts, 1e-3, 300)
    exact = max(9.81 * (math.sin(a) - 0.412 * math.cos(a)), 0.0)
    assert block.velocity[0, 0] == pytest.approx(0.3 * exact, rel=1e-6, abs=1e-12)
    assert abs(block.spin[0, 1]) < 1e-6


@pytest.mark.parametrize(
    ("shape", "planar", "share"), [(BALL, False, 5 / 7), (DiscShape(kind="disc", diameter=0.1), True, 2 / 3)]
)
def test_what_is_round_rolls(shape, planar, share):
    a = math.radians(20.0)
    ball = Bodies([shape], [0.2], [(0.3, 0.5, 0.05)], planar=planar)
    contacts = hard(ball, gravity=(9.81 * math.sin(a), 0.0, -9.81 * math.cos(a)), friction=0.5)
    go(ball, contacts, 1e-3, 300)
    assert ball.velocity[0, 0] == pytest.approx(0.3 * share * 9.81 * math.sin(a), rel=2e-3)
    assert ball.spin[0, 1] * 0.05 == pytest.approx(ball.velocity[0, 0], rel=2e-4)


@pytest.mark.parametrize("angle", [2.0, 10.0, 30.0, 45.0, 60.0, 80.0])
def test_a_ball_that_hits_obliquely_leaves_as_a_rigid_one(angle):
    """Chung & Ooi 2011, test 4: it slides all through the hit above atan(3.5 mu (1 + e)), else leaves rolling."""
    e, mu, a, speed = 0.98, 0.092, math.radians(angle), 3.9
    v, n = speed * math.sin(a), speed * math.cos(a)
    ball = Bodies([SphereShape(kind="sphere", diameter=0.005)], [1e-4], [(0.5, 0.5, 0.003)], velocity=[(v, 0.0, -n)])
    contacts = hard(ball, gravity=(0.0, 0.0, 0.0), friction=mu, restitution=e)
    go(ball, contacts, 1e-4, 20)
    lost = min(mu * (1.0 + e) * n, v / 3.5)
    assert ball.velocity[0] == pytest.approx([v - lost, 0.0, e * n], rel=1e-6)
    assert ball.spin[0, 1] == pytest.approx(2.5 * lost / 0.0025, rel=1e-6)


@pytest.mark.parametrize("slope", [0.0, 10.0])
def test_a_stack_stands(slope):
    a = math.radians(slope)
    places = [(0.5, 0.5, (k + 0.5) * 0.1 + (k + 1) * 1e-4) for k in range(3)]
    bodies = Bodies(boxes(*[(0.05, 0.05, 0.05)] * 3), [0.9] * 3, places)
    contacts = hard(bodies, gravity=(9.81 * math.sin(a), 0.0, -9.81 * math.cos(a)), friction=0.5)
    go(bodies, contacts, 1e-3, 500)
    before = bodies.position.copy()
    go(bodies, contacts, 1e-3, 1000, time=0.5)
    assert np.abs(bodies.position - before).max() < 1e-8 and np.abs(bodies.velocity).max() < 1e-8
    assert bodies.contact_load[0, 2] == pytest.approx(0.9 * 9.81 * math.cos(a), rel=1e-4)


def test_all_shapes_land_and_lie():
    """One of each, tilted, falls on a floor and comes to rest."""
    corners = [(0.05, 0.0), (0.02, 0.05), (-0.04, 0.03), (-0.03, -0.04)]
    shapes = [BoxShape(size=(0.1, 0.08, 0.04)), PrismShape(kind="prism", points=corners, height=0.05), BALL]
    places = [(0.2, 0.5, 0.1), (0.5, 0.5, 0.1), (0.8, 0.5, 0.1)]
    pose = [from_angles((20.0, 30.0, 10.0))] * 3
    bodies = Bodies(shapes, [900.0 * s.volume for s in shapes], places, quaternion=pose)
    contacts = hard(bodies)
    before = budget(bodies, contacts)
    go(bodies, contacts, 1e-3, 2500)
    assert np.abs(bodies.velocity[:2]).max() < 1e-6
    assert bodies.position[:2, 2] == pytest.approx([0.02, 0.025], abs=1e-5)
    assert budget(bodies, contacts) == pytest.approx(before, abs=1e-9)


def test_a_gate_lifts_and_works():
    """A block that leans on a rising plate is lifted by friction: the plate does the work."""
    block = Bodies(boxes(HALF), [MASS], [(0.5025 - 0.0025 - HALF[0], 0.5, 0.2)])
    contacts = Contacts(
        block, case(law=LAW, restitution=0.3, gravity=(50.0, 0.0, -9.81), walls=(), friction=0.5), [Plate()]
    )
    before = budget(block, contacts, (50.0, 0.0, -9.81))
    go(block, contacts, 1e-3, 300)
    assert block.velocity[0, 2] == pytest.approx(0.4, abs=1e-6)
    assert contacts.driven_work > 0.0
    assert budget(block, contacts, (50.0, 0.0, -9.81)) == pytest.approx(before, abs=1e-9)


def test_a_restart_keeps_the_bits():
    def heap():
        places = [(0.5, 0.5, 0.05), (0.52, 0.5, 0.17), (0.47, 0.51, 0.29)]
        bodies = Bodies(boxes(*[(0.05, 0.05, 0.05)] * 3), [0.9] * 3, places)
        return bodies, hard(bodies)

    (bodies, contacts), (other, resumed) = heap(), heap()
    go(bodies, contacts, 1e-3, 150)
    other.restore(bodies.kept())
    resumed.restore(contacts.kept())
    for b, c in ((bodies, contacts), (other, resumed)):
        go(b, c, 1e-3, 50, time=0.15)
    assert contacts.count > 0
    for one, two in ((bodies, other), (contacts, resumed)):
        assert {k: v.tobytes() for k, v in one.kept().items()} == {k: v.tobytes() for k, v in two.kept().items()}
