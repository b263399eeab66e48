"""Friction of what is round and turns on its spot: it comes to rest, as fast as the spot that touches lets it."""

import math

import numpy as np
import pytest
from contact_cases import budget, case, go
from test_laws import HALF_SPACE, HERTZ, LAWS_HERE, SPRING

from parsim.geometry.rotation import from_angles
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.laws import DEFAULT
from parsim.solid.laws.impulse import ImpulseLaw
from parsim.solid.shapes import BoxShape, DilatedDiscShape, SphereShape

MU, RADIUS, MASS, SPIN = 0.4, 0.05, 0.5, 3.0
BALL = SphereShape(kind="sphere", diameter=2.0 * RADIUS)
OPTIONS = {"young": 1e6, "friction": MU, "restitution": 0.5, "steps": 40}


def settled(bodies, law, **options):
    """Contacts of what has been let down, and is then given its spin about z."""
    contacts = Contacts(bodies, case(law=law, **OPTIONS | options))
    go(bodies, contacts, 1e-3, 500)
    bodies.spin[-1] = (0.0, 0.0, SPIN)
    return contacts


def stops_after(bodies, contacts, dt=1e-3):
    """Time until the last body turns no more, s; then it may swing back a little, on its spring."""
    for step in range(4000):
        go(bodies, contacts, dt, 1)
        if bodies.spin[-1, 2] <= 0.0:
            return (step + 1) * dt
    return math.inf


@pytest.mark.parametrize("law", LAWS_HERE, ids=lambda law: law.kind)
def test_a_ball_that_spins_on_a_floor_is_stopped_by_its_spot(law):
    """I dw/dt = 3 pi / 16 mu m g a, a^2 = R d, and no memory of it is left when it stands."""
    bodies = Bodies([BALL], [MASS], [(0.5, 0.5, RADIUS)])
    contacts = settled(bodies, law)
    deep = RADIUS - bodies.position[0, 2]
    torque = 3.0 * math.pi / 16.0 * MU * MASS * 9.81 * math.sqrt(RADIUS * deep)
    exact = 0.4 * MASS * RADIUS**2 * SPIN / torque
    assert stops_after(bodies, contacts) == pytest.approx(exact, rel=0.03, abs=2e-3)
    go(bodies, contacts, 1e-3, 2000)
    assert np.abs(bodies.spin).max() < 1e-4
    assert np.abs(bodies.velocity).max() < 1e-9


@pytest.mark.parametrize("rolling", [0.0, 0.1])
def test_what_is_hard_is_stopped_by_rolling_friction(rolling):
    """It touches at a point: I dw/dt = mu_r R m g, and nothing without."""
    bodies = Bodies([BALL], [MASS], [(0.5, 0.5, RADIUS)])
    contacts = settled(bodies, ImpulseLaw(kind="impulse"), rolling=rolling)
    if rolling:
        assert stops_after(bodies, contacts) == pytest.approx(0.4 * RADIUS * SPIN / (rolling * 9.81), abs=2e-3)
    go(bodies, contacts, 1e-3, 500)
    assert bodies.spin[0, 2] == pytest.approx(0.0 if rolling else SPIN, abs=1e-12)


def test_hertz_has_the_spot_of_hertz():
    """a^3 = 3 N R / (4 E*)."""
    bodies = Bodies([BALL], [MASS], [(0.5, 0.5, RADIUS)])
    settled(bodies, HERTZ)
    exact = (0.75 * MASS * 9.81 * RADIUS / (0.1 * HALF_SPACE)) ** (1.0 / 3.0)
    assert math.sqrt(RADIUS * (RADIUS - bodies.position[0, 2])) == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("shape", [BALL, DilatedDiscShape(kind="dilated_disc", diameter=0.3, thickness=0.1)])
def test_what_is_round_stops_on_a_block_as_on_the_floor(shape):
    """The general way of all shapes and that of balls; a disc on its rim."""
    times = []
    turn = [from_angles((90.0, 0.0, 0.0))] if shape is not BALL else [from_angles((0.0, 0.0, 0.0))]
    high = 0.5 * shape.diameter
    for under in (0.0, 0.2):
        block = [BoxShape(kind="box", size=(0.4, 0.4, 0.2))] if under else []
        count = len(block)
        bodies = Bodies(
            [*block, shape],
            [10.0] * count + [MASS],
            [(0.5, 0.5, 0.1)] * count + [(0.5, 0.5, under + high)],
            quaternion=[(1.0, 0.0, 0.0, 0.0)] * count + turn,
            fixed=[True] * count + [False],
        )
        times.append(stops_after(bodies, settled(bodies, DEFAULT)))
    assert 0.0 < times[0] < math.inf
    assert times[1] == pytest.approx(times[0], rel=0.02)


def test_a_spot_of_two_rims_is_one():
    """Rim on rim of two discs: the torque of the whole spot, not of the halves that each of them stands for."""
    disc = DilatedDiscShape(kind="dilated_disc", diameter=0.3, thickness=0.1)
    turn = from_angles((90.0, 0.0, 0.0))
    bodies = Bodies(
        [disc] * 2, [10.0, MASS], [(0.5, 0.5, 0.2), (0.5, 0.5, 0.4999)], quaternion=[turn] * 2, fixed=[True, False]
    )
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), **OPTIONS))
    bodies.spin[1] = (0.0, 0.0, 50.0)
    go(bodies, contacts, 1e-7, 50)
    force, torque = bodies.contact_load[1, 2], bodies.contact_load[1, 5]
    spot = math.sqrt(0.5 * math.sqrt(0.15 * 0.05) * (0.5 - bodies.position[1, 2]))
    assert force > 0.0
    assert torque == pytest.approx(-3.0 * math.pi / 16.0 * MU * force * spot, rel=0.02)


def test_twisting_makes_no_energy_and_keeps_momentum():
    """Two balls pressed together that turn against each other, with nothing else."""
    bodies = Bodies(
        [BALL] * 2,
        [MASS] * 2,
        [(0.45, 0.5, 0.5), (0.5501, 0.5, 0.5)],
        velocity=[(0.2, 0.0, 0.0), (-0.2, 0.0, 0.0)],
        spin=[(3.0, 0.0, 0.0), (-1.0, 0.0, 0.0)],
    )
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), law=SPRING, **OPTIONS))
    before, most = budget(bodies, contacts, (0.0, 0.0, 0.0)), 0.0
    for _ in range(300):
        go(bodies, contacts, 1e-4, 1)
        most = max(most, budget(bodies, contacts, (0.0, 0.0, 0.0)) / before)
    assert most < 1.0 + 1e-9
    assert bodies.spin[0, 0] < 2.9999, "it twists while they touch"
    assert bodies.spin.sum(axis=0) == pytest.approx([2.0, 0.0, 0.0], abs=1e-12)
