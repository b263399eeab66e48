"""Elements, depths and common normals against naive searches."""

import numpy as np
import pytest
from contact_cases import HALF, blocks, boxes, case

from parsim.case.places import Place, overlap
from parsim.geometry.rotation import matrices
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.search import AREA, DEPTH, INDEX, MIDDLE, POINT
from parsim.solid.separation import best_feature
from parsim.solid.shapes import elements_of
from parsim.solid.shapes.forms import forms_of
from parsim.solid.shapes.kernels import depth as depth_along
from parsim.solid.touch import measure, normal_of


def random_pair(seed):
    """Two overlapping boxes at random."""
    random = np.random.default_rng(seed)
    turns = random.normal(size=(2, 4))
    half = random.uniform(0.02, 0.06, (2, 3))
    between = random.normal(size=3)
    places = np.array([(0.0, 0.0, 0.0), between / np.linalg.norm(between) * random.uniform(0.03, 0.1)])
    return Bodies(boxes(*half), [1.0, 1.0], places, quaternion=turns / np.linalg.norm(turns, axis=1)[:, None])


def test_separating_axes_agree_with_the_exact_overlap():
    turned = 0
    for seed in range(200):
        bodies = random_pair(seed)
        turn = matrices(bodies.quaternion)
        pair = [Place(*each) for each in zip(bodies.position, turn, bodies.shapes, strict=True)]
        exact = overlap(*pair)
        contacts = Contacts(bodies, case(walls=()))
        contacts._prepare(bodies, bodies.fixed, 0.0, 0.0)
        feature, apart = best_feature(contacts._table, contacts._forms, 0, 1, (0.0, 0.0, 0.0), False)
        turned += feature > 5
        assert exact - 1e-12 <= -apart <= exact + 0.06 * abs(exact)
    assert turned > 10, "some touch by their edges"


def naive_depth(p, direction, half):
    """Distance along `direction` from a point in a box to its surface, by bisection; 0 outside."""
    if np.any(np.abs(p) > half):
        return 0.0
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if np.any(np.abs(p + middle * direction) > half) else (middle, high)
    return low


def test_depths_agree_with_a_naive_search():
    random, half, inside = np.random.default_rng(3), np.array([0.1, 0.2, 0.3]), 0
    forms = forms_of(boxes(half), False)
    for _ in range(500):
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        p = random.uniform(-1.1, 1.1, 3) * half
        if np.abs(direction).min() < 0.1:
            continue
        depth, weight = depth_along(forms, 0, tuple(p), tuple(direction), 0.01)
        exact = naive_depth(p, direction, half)
        behind = np.any((p * np.sign(direction) > half) | (p * np.sign(direction) < -half))
        found = weight > 0.0 and depth > 0.0
        assert (not found) == behind == (exact == 0.0)
        inside += found
        if found:
            assert depth == pytest.approx(exact, abs=1e-12)
    assert inside > 100


def test_elements_of_a_pair_agree_with_naive_python():
    found = 0
    for seed in range(30):
        bodies = random_pair(seed)
        contacts = Contacts(bodies, case(walls=()))
        number, slots, *_ = contacts._prepare(bodies, bodies.fixed, 0.0, 0.01)
        if not number:
            continue
        touch = contacts._touch()
        e, pairs, marks, s = touch.elements, touch.pairs, touch.marks, touch.slots
        apart, *n = normal_of(contacts._table, touch, 0)
        measure(contacts._table, touch, 0, tuple(n), apart)
        turn, n = matrices(bodies.quaternion), np.array(n)
        for slot in range(slots - 1):
            own = int(slot >= pairs[0, MIDDLE])
            out, other = (-n, n)[own], 1 - own
            element = e[marks[slot, INDEX]]
            point = bodies.position[own] + turn[own] @ element[:3]
            seen = np.maximum(element[3:] * (turn[own].T @ out), 0.0).sum()
            ways = turn[other].T @ -out
            if np.abs(ways).min() < 0.1 or apart > 0:
                continue
            depth = naive_depth(turn[other].T @ (point - bodies.position[other]), ways, bodies.forms.half[other])
            depth = depth if seen > 0.0 else 0.0
            assert s[slot, DEPTH] == pytest.approx(depth, abs=1e-12)
            found += depth > 0
            if depth > 0:
                assert s[slot, POINT : POINT + 3] == pytest.approx(point, abs=1e-15)
                assert 0.0 < s[slot, AREA] <= seen * (1 + 1e-12)
    assert found > 20


def test_element_areas_add_up_to_the_faces():
    bodies = blocks([(0.0, 0.0, 0.0)])
    _, elements, _ = elements_of(bodies)
    faces = 4 * np.array([HALF[1] * HALF[2], HALF[2] * HALF[0], HALF[0] * HALF[1]])
    assert np.maximum(elements[:, 3:], 0.0).sum(axis=0) == pytest.approx(faces)
    assert np.abs(elements[:, 3:]).sum(axis=0) == pytest.approx(2 * faces)
    assert sum((np.abs(point) == HALF).all() for point in elements[:, :3]) == 8, "the corners"
