"""The search for pairs against a plain one, and what of bodies belongs together within a step."""

import math

import numpy as np
import pytest
from contact_cases import boxes, case, go

from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.grid import grid_of, near_of
from parsim.solid.islands import islands_of
from parsim.solid.joints.drives import SteadyTable
from parsim.solid.joints.spring import SpringTable
from parsim.solid.laws.hertz import HertzLaw
from parsim.solid.separation import BALLS
from parsim.solid.shapes import SphereShape

ENDLESS = np.full(3, math.inf)


def found(place, extent, far, period):
    """Pairs that the grid finds, and how often."""
    grid, room, out = grid_of(place, extent, far, period), np.empty(4 * len(place), np.int64), []
    for b in range(len(place)):
        count = near_of(grid, place, period, b, room)
        assert count <= len(room)
        out += [(min(b, other), max(b, other)) for other in room[:count]]
    return out


@pytest.mark.parametrize("ratio", [1.0, 3.0, 100.0])
@pytest.mark.parametrize("period", [ENDLESS, np.array([1.0, math.inf, math.inf]), np.array([1.0, 0.7, math.inf])])
@pytest.mark.parametrize("seed", range(5))
def test_no_pair_is_missed_and_none_found_twice(ratio, period, seed):
    """Sizes of 1 to 100, places on the edges of cells and beyond the period among them."""
    draw = np.random.default_rng(seed)
    count = 120
    extent = 0.005 * ratio ** draw.uniform(0.0, 1.0, (count, 1)) * draw.uniform(0.5, 1.0, (count, 3))
    place, far = draw.uniform(-0.5, 1.5, (count, 3)), 0.003
    place[:20] = np.round(place[:20] / 0.013) * 0.013
    apart = place[:, None] - place[None]
    again = np.isfinite(period) & (extent < 0.5 * np.where(np.isfinite(period), period, 0.0))[None, :, :]
    moved = np.where(again, np.where(np.isfinite(period), period, 1.0) * np.round(apart / np.where(
        np.isfinite(period), period, 1.0)), 0.0)  # fmt: skip
    near = (np.abs(apart - moved) <= extent[:, None] + extent[None] + far).all(-1)
    pairs = found(place, extent, far, period)
    assert len(set(pairs)) == len(pairs)
    assert {(a, b) for a, b in np.argwhere(near) if a < b} <= set(pairs)


def test_the_search_grows_with_the_number_of_bodies_only():
    """Candidates a body, of spheres in a lattice: those of its own cell and half of those around."""
    for side in (6, 12):
        place = np.stack(np.meshgrid(*[np.arange(side) * 0.02] * 3, indexing="ij"), -1).reshape(-1, 3)
        extent = np.full(place.shape, 0.01)
        assert len(found(place, extent, 1e-4, ENDLESS)) < 14 * len(place)


HALF = (0.02, 0.02, 0.02)


def row_of_boxes(*places, **other):
    """Boxes along x at these places, m, on a floor."""
    return Bodies(boxes(*[HALF] * len(places)), [0.064] * len(places), [(x, 0.5, 0.02) for x in places], **other)


def islands(bodies, **options):
    """Rows and guests of each island, and how many pairs it has."""
    contacts = Contacts(bodies, case(**options))
    number, *_ = contacts._prepare(bodies, bodies.held(0.0), 0.0, 1e-3)
    found = islands_of(contacts._table, contacts._touch(), number)
    return [
        (
            list(found.rows[found.first[k] : found.own[k]]),
            list(found.rows[found.own[k] : found.last[k]]),
            found.first_pair[k + 1] - found.first_pair[k],
        )
        for k in range(len(found.first))
    ]


def test_what_may_touch_is_one_island_and_the_rest_others():
    bodies = row_of_boxes(0.1, 0.14, 0.3, 0.5, 0.18, 0.54)
    assert islands(bodies) == [([0, 1, 4], [], 5), ([2], [], 1), ([3, 5], [], 3)]
    assert islands(bodies, walls=()) == [([0, 1, 4], [], 2), ([3, 5], [], 1)]


def test_what_is_held_or_driven_is_a_guest_of_many():
    bodies = row_of_boxes(0.1, 0.14, 0.18, 0.4, fixed=[False, True, False, False], names=list("abcd"),
                          joints=[SteadyTable(kind="steady", body="d", velocity=(0.0, 0.0, 0.1))])  # fmt: skip
    assert islands(bodies, walls=()) == [([0], [1], 1), ([2], [1], 1)]
    spring = SpringTable(kind="spring", body="b", to=(0.1, 0.5, 0.5), stiffness=1.0)
    alone = row_of_boxes(0.1, 0.9, names=["a", "b"], joints=[spring])
    assert islands(alone, walls=()) == [([1], [], 0)]


def test_islands_move_as_they_would_alone():
    """Whatever else there is, but for how far they look for others."""
    together, lone = row_of_boxes(0.1, 0.1401, 0.7), row_of_boxes(0.1, 0.1401)
    together.velocity[2] = (0.0, 0.0, -3.0)
    one, two = Contacts(together, case()), Contacts(lone, case())
    go(together, one, 1e-3, 50)
    go(lone, two, 1e-3, 50)
    assert together.position[:2] == pytest.approx(lone.position, abs=1e-8)
    assert together.quaternion[:2] == pytest.approx(lone.quaternion, abs=1e-7)


def test_a_driven_body_between_two_islands_moves_once():
    """A plate that lifts one block on either side of it, each an island."""
    joint = SteadyTable(kind="steady", body="plate", velocity=(0.0, 0.0, 0.1), spin=(0.0, 0.0, 1.0))
    bodies = Bodies(
        boxes((0.2, 0.02, 0.01), HALF, HALF),
        [1.0, 0.064, 0.064],
        [(0.5, 0.5, 0.5), (0.35, 0.5, 0.53), (0.65, 0.5, 0.53)],
        names=["plate", "one", "two"],
        joints=[joint],
    )
    contacts = Contacts(bodies, case(walls=()))
    assert [rows for rows, *_ in islands(bodies, walls=())] == [[1], [2]]
    go(bodies, contacts, 1e-3, 200)
    assert bodies.position[0] == pytest.approx((0.5, 0.5, 0.52), abs=1e-12)
    assert bodies.quaternion[0, 3] == pytest.approx(math.sin(0.1), rel=1e-9)
    assert bodies.position[1:, 2] == pytest.approx([0.55, 0.55], abs=1e-4)
    assert bodies.contact_load[0, 2] == pytest.approx(-2.0 * 9.81 * 0.064, rel=1e-3)


@pytest.mark.parametrize("rolling", [0.0, 0.1])
def test_balls_alone_and_among_others_feel_the_same(rolling, monkeypatch):
    """The short way of balls against that of all shapes."""
    balls = [SphereShape(kind="sphere", diameter=0.04)] * 4
    start = [(0.5, 0.5, 0.0195), (0.53, 0.51, 0.0195), (0.52, 0.48, 0.052), (0.2, 0.2, 0.0199)]
    spin = [(1.0, 2.0, 3.0), (0.0, -4.0, 1.0), (2.0, 0.0, 0.0), (0.0, 9.0, 0.0)]

    def pile():
        bodies = Bodies(balls, [0.03, 0.04, 0.05, 0.03], start, spin=spin)
        contacts = Contacts(bodies, case(law=HertzLaw(kind="hertz"), rolling=rolling))
        go(bodies, contacts, 1e-4, 40)
        number, *_ = contacts._prepare(bodies, bodies.held(0.0), 0.0, 1e-4)
        return bodies, contacts, contacts._pairs[:number, 2].copy()

    one, short, features = pile()
    assert (features == BALLS).all()
    original = Bodies.__init__

    def tied(self, *given, **named):
        original(self, *given, **named)
        self.joints.free[:, 1] = 1.0 - 1e-12  # takes the way of all shapes, and changes next to nothing

    monkeypatch.setattr(Bodies, "__init__", tied)
    two, long, features = pile()
    assert not (features == BALLS).any()
    assert two.position == pytest.approx(one.position, rel=1e-9)
    assert two.spin == pytest.approx(one.spin, rel=1e-6, abs=1e-9)
    assert long.dissipated == pytest.approx(short.dissipated, rel=1e-6)
