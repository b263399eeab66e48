"""Heaps of balls: the way in tables of their own against that of all shapes, and bits that no list changes."""

import numpy as np
import pytest
from contact_cases import case, go

from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.laws.foundation import FoundationLaw
from parsim.solid.laws.hertz import HertzLaw
from parsim.solid.laws.spring import SpringLaw
from parsim.solid.shapes import SphereShape

LAWS = [FoundationLaw(), HertzLaw(kind="hertz"), SpringLaw(kind="spring", stiffness=2e4)]
BESIDE = {"x_min": "periodic", "x_max": "periodic"}


def heap(tied=False, **options):
    """Balls of three sizes in layers that fall on one that is held, and on walls; they reach over a periodic side."""
    draw, count = np.random.default_rng(3), 60
    place = np.array(
        [(0.045 * i, 0.04 + 0.045 * j, 0.03 + 0.045 * k) for k in range(5) for j in range(3) for i in range(4)]
    )
    place += draw.uniform(-0.001, 0.001, place.shape)
    shapes = [SphereShape(kind="sphere", diameter=(0.036, 0.04, 0.044)[n % 3]) for n in range(count)]
    mass, fixed = [0.03 * (s.diameter / 0.04) ** 3 for s in shapes], np.arange(count) == 5
    bodies = Bodies(shapes, mass, place, velocity=(0.3, 0.0, -0.4), spin=(5.0, -9.0, 3.0), fixed=fixed)
    if tied:
        bodies.joints.free[:, 1] = 1.0 - 1e-12  # takes the way of all shapes, and changes next to nothing
    made = case(walls=("z_min", "y_min"), **BESIDE, **options)
    made.box.max = (0.166, 1.0, 1.0)
    return bodies, Contacts(bodies, made)


@pytest.mark.parametrize("rolling", [0.0, 0.1])
@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.kind)
def test_heaps_move_as_the_way_of_all_shapes_has_it(law, rolling):
    (one, short), (two, long) = heap(law=law, rolling=rolling), heap(True, law=law, rolling=rolling)
    go(one, short, 2e-3, 10)
    go(two, long, 2e-3, 10)
    assert short.count == long.count > 20 and short.steps == long.steps > 3
    assert one.position == pytest.approx(two.position, abs=1e-8)
    assert one.quaternion == pytest.approx(two.quaternion, abs=1e-7)
    assert one.contact_load == pytest.approx(two.contact_load, rel=1e-5, abs=1e-5)
    assert short.dissipated == pytest.approx(long.dissipated, rel=1e-7)
    assert short.elastic_energy() == pytest.approx(long.elastic_energy(), rel=1e-6)


def test_a_heap_goes_on_to_the_same_bits_whatever_was_listed_before():
    (one, whole), (two, first) = heap(), heap()
    go(one, whole, 1e-3, 40)
    for step in range(40):
        go(two, first, 1e-3, 1, time=1e-3 * step)
        kept, first = first.kept(), heap()[1]
        first.bodies = two
        first.restore(kept)
    assert (one.position == two.position).all() and (one.quaternion == two.quaternion).all()
    assert (one.spin == two.spin).all() and whole.dissipated == first.dissipated
    assert (whole.kept()["memory"] == first.kept()["memory"]).all()


def test_a_heap_makes_no_energy():
    """The bodies' energy and what contacts hold, on the way down and as it comes to rest; what is lost is counted."""
    bodies, contacts = heap(restitution=0.3)

    def energy():
        held = contacts.elastic_energy()
        return bodies.kinetic_energy() + bodies.potential_energy((0.0, 0.0, -9.81)) + held

    last = start = energy()
    for step in range(100):
        go(bodies, contacts, 2e-3, 1, time=2e-3 * step)
        assert energy() < last + 1e-5 * start
        last = energy()
    assert last + contacts.dissipated == pytest.approx(start, rel=1e-9)
    assert last < 0.8 * start and contacts.count > 50
