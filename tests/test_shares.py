"""Contacts shared out among those that hold the same bodies: the same bits whoever finds what, and a fair deal."""

import itertools
import math
import pickle
import threading
from pathlib import Path

import numpy as np
import pytest
from contact_cases import Plate, case

from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.deal import TOGETHER, cuts, deal
from parsim.solid.shapes import BoxShape, PrismShape, SphereShape

PROGRAM = Path(__file__).with_name("shared_floes.py")
PAIRS, ISLANDS, BOTH = 0.0, math.inf, 1.05  # how uneven parts may be: all pairs are shared out, none, some
HALVES, AMONG_RANKS = (12, 12), (4, 3)  # steps before and after a restart; those of ranks, who wait for each other


class Member:
    """One of several threads that share the work, as ranks do."""

    def __init__(self, team, own, uneven):
        self._team, self.own, self.count, self.least, self.uneven = team, own, len(team[1]), 0.0, uneven

    def gather(self, found, counts):
        barrier, told = self._team
        assert found.size == counts[self.own]
        told[self.own] = np.array(found).ravel()
        barrier.wait()
        every = np.concatenate(told)
        barrier.wait()
        return every

    def gather_any(self, found):
        return self.gather(found, self.counts(found.size))

    def counts(self, own):
        return self.gather(np.array([float(own)]), [1] * self.count).astype(np.int64)


def pile(shares=None):
    """Floes of three shapes, one of them held, in two heaps that fall apart, on walls and at a gate that rises."""
    draw, shapes, place = np.random.default_rng(4), [], []
    for n in range(36):
        x, layer = 0.05 + 0.07 * (n % 3) + (0.272 if n % 2 else 0.0), n // 6
        place.append((x, 0.05 + 0.07 * (n // 2 % 2), 0.014 + 0.0285 * layer))
        points = [(0.035 * math.cos(a), 0.035 * math.sin(a)) for a in 1.2566 * np.arange(5) + draw.uniform(-0.2, 0.2)]
        kinds = (
            BoxShape(size=(0.068, 0.066, 0.028)),
            PrismShape(kind="prism", points=points, height=0.028),
            SphereShape(kind="sphere", diameter=0.03),
        )
        shapes.append(kinds[0 if n == 7 else n % 5 % 3])
    place = np.array(place) + draw.uniform(-0.002, 0.002, (36, 3)) * (1.0, 1.0, 0.2)
    mass = [900.0 * shape.volume for shape in shapes]
    bodies = Bodies(shapes, mass, place, velocity=(0.6, 0.1, -0.3), fixed=np.arange(36) == 7)
    walls = ("z_min", "x_min", "y_min")
    made = case(walls=walls, restitution=0.3, rolling=0.05, strength=1e5)
    return bodies, Contacts(bodies, made, [Plate()], shares=shares)


def found(bodies, contacts):
    """All that must have the same bits."""
    of_bodies = [bodies.position, bodies.quaternion, bodies.velocity, bodies.spin, bodies.contact_load]
    return [*of_bodies, *contacts.kept().values(), contacts.count, contacts.steps]


def moved(shares, start, steps):
    """(all that must have the same bits, what a restart needs) after some steps, from a `start` on if there is one."""
    bodies, contacts = pile(shares)
    if start:
        bodies.restore(start[0])
        contacts.restore(start[1])
    for step in range(steps):
        contacts.step(bodies, np.zeros((36, 6)), 2e-3 * step, 2e-3)
    return found(bodies, contacts), (bodies.kept(), contacts.kept())


def gone(count, uneven, start=None, steps=HALVES[0]):
    """What `moved` returns to each of `count` members."""
    team, out = (threading.Barrier(count), [None] * count), [None] * count

    def work(own):
        try:
            out[own] = moved(Member(team, own, uneven), start, steps)
        finally:
            if out[own] is None:
                team[0].abort()

    threads = [threading.Thread(target=work, args=(own,)) for own in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return out


def halves(steps):
    """The same of one that shares with nobody, before and after a restart."""
    first = moved(None, None, steps[0])
    return first, moved(None, first[1], steps[1])


@pytest.fixture(scope="module")
def alone():
    return halves(HALVES)


def same(one, other):
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, other, strict=True))


def test_the_pile_has_all_that_bits_could_hang_on(alone):
    (first, (_, kept)), (_, (_, later)) = alone
    *_, count, steps = first
    memory = np.concatenate([kept["memory"], later["memory"]])
    assert count > 20 and steps > 50
    assert np.abs(memory).max(axis=0)[[0, 3, 6]].min() > 0.0, "friction, rolling friction and crushing remember"
    assert kept["totals"][0] > 0.0 and kept["totals"][1] != 0.0, "energy is lost, and the gate does work"
    assert np.abs(first[4][7]).max() > 0.0, "what is held is pushed"


@pytest.mark.parametrize("uneven", [PAIRS, ISLANDS, BOTH])
@pytest.mark.parametrize("count", [*(pytest.param(count, marks=pytest.mark.long) for count in (1, 2)), 3])
def test_all_that_share_have_the_bits_of_one_alone(count, uneven, alone):
    assert all(same(alone[0][0], one) for one, _ in gone(count, uneven))


@pytest.mark.parametrize(("before", "after"), [((2, PAIRS), (3, ISLANDS)), ((3, BOTH), (2, PAIRS))])
def test_a_restart_with_others_keeps_the_bits(before, after, alone):
    start = gone(*before)[-1][1]
    assert all(same(alone[1][0], one) for one, _ in gone(*after, start, HALVES[1]))


@pytest.mark.parametrize(("before", "after"), [
    ((2, BOTH), (1, PAIRS)),
    pytest.param((2, PAIRS), (3, ISLANDS), marks=pytest.mark.long),
    pytest.param((3, BOTH), (1, PAIRS), marks=pytest.mark.long),
])  # fmt: skip
def test_ranks_that_share_have_the_bits_of_one_rank(before, after, mpirun, tmp_path):
    """In two pieces, on different ranks."""
    out = tmp_path / "first", tmp_path / "second"
    for (ranks, uneven), words in ((before, [out[0]]), (after, [out[1], out[0]])):
        done = mpirun(ranks, [PROGRAM, words[0], uneven, *words[1:]])
        assert done.returncode == 0, done.stdout + done.stderr
    for path, (_, kept) in zip(out, halves(AMONG_RANKS), strict=True):
        told = pickle.loads(path.read_bytes())
        assert all(same(one.values(), other.values()) for one, other in zip(told, kept, strict=True))


def test_every_pair_is_found_by_one_part_and_parts_take_as_long():
    draw = np.random.default_rng(1)
    for count in (1, 2, 3, 7):
        for costs in (draw.exponential(1.0, 1000), np.ones(50), np.ones(2), np.zeros(0)):
            ends = cuts(costs, count)
            assert ends[0] == 0 and ends[-1] == len(costs) and (np.diff(ends) >= 0).all() and len(ends) == count + 1
            parts = [costs[a:b].sum() for a, b in itertools.pairwise(ends)]
            assert max(parts) <= costs.sum() / count + costs.max(initial=0.0)


def test_islands_are_dealt_evenly_and_only_large_ones_are_shared_out():
    draw = np.random.default_rng(2)
    small = draw.uniform(0.5, 1.5, 200)
    for count in (2, 3, 8):
        owner = deal(small, np.ones(200, bool), count, 1.03)
        loads = [small[owner == part].sum() for part in range(count)]
        assert (owner != TOGETHER).all() and max(loads) <= 1.03 * small.sum() / count
        owner = deal(np.append(small, 500.0), np.ones(201, bool), count, 1.03)
        assert (np.flatnonzero(owner == TOGETHER) == 200).all() and owner[200] == TOGETHER
        owner = deal(np.append(small, 500.0), np.arange(201) < 200, count, 1.03)
        assert owner[200] >= 0, "a heap of balls moves as a whole"
    assert (deal(small, np.ones(200, bool), 4, PAIRS) == TOGETHER).all()
    assert (deal(small, np.ones(200, bool), 4, ISLANDS) != TOGETHER).all()
    assert (deal(np.array([5.0, 5.0]), np.ones(2, bool), 2, 1.03) != TOGETHER).all(), "two of a size need no messages"
