"""Any two bodies, or a body and what is driven, however they meet: energy, momentum, and who stays on which side."""

import math

import numpy as np
import pytest
from contact_cases import FLAT, case, momenta
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from parsim.case.places import Place, overlap
from parsim.geometry.rotation import from_angles, matrices
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.joints.drives import ScheduleTable
from parsim.solid.laws import DEFAULT
from parsim.solid.laws.hertz import HertzLaw
from parsim.solid.laws.impulse import ImpulseLaw
from parsim.solid.laws.spring import SpringLaw
from parsim.solid.shapes import (
    BoxShape,
    CylinderShape,
    DilatedDiscShape,
    DiscShape,
    PolygonShape,
    PrismShape,
    SphereShape,
)

SOFT = DEFAULT, HertzLaw(kind="hertz"), SpringLaw(kind="spring", stiffness=1e5)
HARD = ImpulseLaw(kind="impulse")
WEIGHTLESS = (0.0, 0.0, 0.0)


def polygon(dice, size):
    """Corners of a convex polygon about that wide."""
    while True:
        angles = np.sort(dice.uniform(0.0, 2.0 * math.pi, dice.integers(3, 9)))
        if np.diff([*angles, angles[0] + 2.0 * math.pi]).max() < 2.8 and np.diff(angles).min() > 0.1:
            break
    stretch = dice.uniform(0.4, 1.0)
    return tuple((float(0.5 * size * math.cos(a)), float(0.5 * stretch * size * math.sin(a))) for a in angles)


def shape(dice, planar, size):
    """Any shape about as wide as `size`, m."""
    flat = size * dice.uniform(0.15, 1.0)
    if planar:
        return [
            lambda: DiscShape(kind="disc", diameter=size),
            lambda: PolygonShape(kind="polygon", points=polygon(dice, size)),
            lambda: BoxShape(size=(size, 1.0, flat)),
        ][dice.integers(3)]()
    return [
        lambda: SphereShape(kind="sphere", diameter=size),
        lambda: BoxShape(size=(size, size * dice.uniform(0.3, 1.0), flat)),
        lambda: CylinderShape(kind="cylinder", diameter=size, height=flat),
        lambda: PrismShape(kind="prism", points=polygon(dice, size), height=flat),
        lambda: DilatedDiscShape(kind="dilated_disc", diameter=size, thickness=0.8 * flat),
    ][dice.integers(5)]()


def pose(dice, planar):
    """Any orientation, or one that is all but upright, so that faces and edges meet."""
    if dice.random() < 0.4:
        angles = dice.choice([0.0, 90.0], 3) + dice.normal(0.0, 10.0 ** dice.uniform(-6.0, 0.0), 3)
    else:
        angles = dice.uniform(-180.0, 180.0, 3)
    return from_angles(angles * (0.0, 1.0, 0.0) if planar else angles)


def pair(dice, law):
    """Two bodies, of sizes up to 1:100, that fly at each other and spin: (bodies, contacts)."""
    planar, first = dice.random() < 0.3, 10.0 ** dice.uniform(-2.0, -1.0)
    second = first * 10.0 ** dice.uniform(-2.0, 2.0)
    shapes = [shape(dice, planar, size) for size in (first, second)]
    way = dice.normal(size=3) * ((1.0, 0.0, 1.0) if planar else 1.0)
    way /= np.linalg.norm(way)
    apart = sum(s.radius(planar) for s in shapes)
    off = dice.normal(size=3) * 0.3 * min(first, second) * ((1.0, 0.0, 1.0) if planar else 1.0)
    off -= (off @ way) * way
    speed = 10.0 ** dice.uniform(-1.0, 0.5)
    spin = dice.normal(size=(2, 3)) * speed / np.array([[first], [second]]) * ((0.0, 1.0, 0.0) if planar else 1.0)
    masses = np.array([s.volume for s in shapes]) * 10.0 ** dice.uniform(2.0, 4.0, 2)
    if law.kind == "spring":  # a third of the width deep at most
        thin = min(s.thinnest(planar) for s in shapes)
        law = SpringLaw(kind="spring", stiffness=masses.prod() / masses.sum() * (10.0 * speed / thin) ** 2)
    bodies = Bodies(
        shapes,
        masses,
        [np.full(3, 0.5), 0.5 + 1.02 * apart * way + off],
        quaternion=[pose(dice, planar) for _ in shapes],
        velocity=[0.5 * speed * way, -0.5 * speed * way],
        spin=spin * dice.choice([0.0, 1.0]),
        planar=planar,
    )
    given_case = case(
        law=law,
        gravity=WEIGHTLESS,
        walls=(),
        young=1e8,
        restitution=dice.uniform(0.05, 1.0),
        friction=dice.choice([0.0, 0.3, 1.0]),
    )
    given_case.dimensions = 2 if planar else 3
    return bodies, Contacts(bodies, given_case), 1.2 * apart / speed


def press(dice, law):
    """Any body between two plates that close, on what is soft to less than its width: (bodies, contacts, time)."""
    planar, size = dice.random() < 0.3, 10.0 ** dice.uniform(-2.0, -1.0)
    body, flat = shape(dice, planar, size), 0.5 * size
    wide, thin = 2.0 * body.radius(planar), 2.0 * body.thinnest(planar)
    start, end = 1.05 * wide, 1.02 * wide if law.INSTANT else max(dice.uniform(0.98, 1.05) * thin, wide - 0.4 * thin)
    takes, closed = 10.0 ** dice.uniform(0.5, 2.0) * size, 0.5 * (start - end)
    plate = BoxShape(size=(6.0 * size, 1.0 if planar else 6.0 * size, flat))
    masses = 900.0 * np.array([body.volume, plate.volume, plate.volume])
    if law.kind == "spring":
        law = SpringLaw(kind="spring", stiffness=masses[0] * 400.0 * (closed / takes / thin) ** 2)
    spin = dice.normal(size=3) * 2.0 * closed / (takes * size) * ((0.0, 1.0, 0.0) if planar else 1.0)
    ways = {"lower": 1.0, "upper": -1.0}
    bodies = Bodies(
        [body, plate, plate],
        masses,
        [(0.5, 0.5, 0.5 - way * 0.5 * (start + flat)) for way in (0.0, *ways.values())],
        quaternion=[pose(dice, planar), FLAT, FLAT],
        spin=[spin, np.zeros(3), np.zeros(3)],
        names=["body", *ways],
        joints=[
            ScheduleTable(kind="schedule", body=b, rows=[(0.0, 0.0, 0.0, 0.0), (takes, 0.0, 0.0, way * closed)])
            for b, way in ways.items()
        ],
        planar=planar,
    )
    chosen = {"restitution": dice.uniform(0.05, 1.0), "friction": dice.choice([0.0, 0.3, 1.0])}
    given_case = case(law=law, gravity=WEIGHTLESS, walls=(), young=1e7, **chosen)
    given_case.dimensions = 2 if planar else 3
    return bodies, Contacts(bodies, given_case), 1.1 * takes


def held(bodies, contacts):
    return bodies.kinetic_energy() + contacts.elastic_energy()


def is_pressed_and_stays(seed, law, steps=40, more=1e-6):
    """Draw a body between closing plates and check it: no energy but from them, and it stays between them."""
    bodies, contacts, takes = press(np.random.default_rng(seed), law)
    start, time = held(bodies, contacts), 0.0
    while time < takes:
        dt = min(takes / steps, contacts.limit())
        contacts.step(bodies, np.zeros((3, 6)), time, dt)
        time += dt
        given = start + contacts.driven_work
        assert held(bodies, contacts) <= given + more * (given + contacts.dissipated), (seed, time)
        at, lower, upper = bodies.position
        if np.abs(at - 0.5)[:2].max() > 2.0 * bodies.shapes[1].size[2]:
            break  # pressed out from between them, like the stone of a cherry
        assert lower[2] < at[2] < upper[2], (seed, time)


def meets_and_keeps(seed, law, steps=60, more=1e-6):
    """Draw a pair and check it, energy to a share `more`.

    Returns how deep the two were in each other at most, over the smaller one's width.
    """
    bodies, contacts, until = pair(np.random.default_rng(seed), law)
    start, before, deepest = held(bodies, contacts), momenta(bodies), 0.0
    size, taken = np.abs(before[0]).max() + bodies.mass.max() * np.abs(bodies.velocity).max(), 0
    for step in range(steps):
        if taken > 20000:  # they stay together
            break
        dt = min(until / steps, contacts.limit())
        contacts.step(bodies, np.zeros((2, 6)), step * dt, dt)
        taken += contacts.steps
        assert held(bodies, contacts) <= start * (1.0 + more), (seed, step)
        if contacts.count:
            turn = matrices(bodies.quaternion)
            places = [Place(*each) for each in zip(bodies.position, turn, bodies.shapes, strict=True)]
            deepest = max(deepest, overlap(*places))
    for now, then, arm in zip(momenta(bodies), before, (1.0, 1.0), strict=True):
        assert now == pytest.approx(then, abs=1e-9 * size * arm), seed
    return deepest / (2.0 * min(s.thinnest(bodies.planar) for s in bodies.shapes))


any_draw = given(st.integers(0, 2**32 - 1))
few = settings(max_examples=125, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
many = settings(few, max_examples=2500)


def check(law, **how):
    """Of five draws one is a body between closing plates."""

    @any_draw
    def run(seed):
        if seed % 5 == 0:
            is_pressed_and_stays(seed, law, **how)
        else:
            assert meets_and_keeps(seed, law, **how) < 0.5, seed

    return run


@pytest.mark.parametrize("law", [*SOFT, HARD], ids=lambda law: law.kind)
def test_any_two_bodies_keep_energy_and_momentum_and_do_not_pass(law):
    few(check(law))()


@pytest.mark.slow
@pytest.mark.parametrize("law", [*SOFT, HARD], ids=lambda law: law.kind)
def test_ten_thousand_pairs_keep_energy_and_momentum_and_do_not_pass(law):
    many(check(law, more=1e-5))()  # what friction springs hold is told half a sub-step late: 4e-6 in one of these


def test_boxes_that_come_apart_along_another_direction_within_a_step_do_not_touch():
    """Their share of stiffness is zero there, by which an area was divided."""
    meets_and_keeps(10164, SOFT[[law.kind for law in SOFT].index("hertz")], more=1e-5)
