"""Turned boxes: overlap by separating axes, and what it means for the bodies of a case."""

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from example_cases import bodies, write

from parsim.case import places
from parsim.case.model import load
from parsim.errors import InputError
from parsim.solid.shapes import BoxShape


@pytest.fixture
def base(tmp_path):
    return write(tmp_path)["3d"]


def test_bodies_that_touch_or_pass_by_a_corner_are_allowed(base):
    first = ("A1", "[0.15,0.05,0.1]", "[0,0,0]")
    load(base, [bodies(first, ("A2", "[0.20,0.05,0.1]", "[0,0,0]"))])
    # turned by 45 degrees their extents overlap, they do not: half diagonal 0.0354, half edge 0.025
    load(base, [bodies(first, ("A2", "[0.212,0.05,0.1]", "[0,0,45]"))])
    with pytest.raises(InputError, match="A2: overlaps bodies.A1"):
        load(base, [bodies(first, ("A2", "[0.210,0.05,0.1]", "[0,0,45]"))])


def test_bodies_overlap_across_periodic_faces(base):
    sides = ["box.faces.y_min=periodic", "box.faces.y_max=periodic"]
    pair = bodies(("A1", "[0.2,0.01,0.1]", "[0,0,0]"), ("A2", "[0.2,0.07,0.1]", "[0,0,0]"))
    with pytest.raises(InputError) as caught:
        load(base, [*sides, pair])
    assert any("A2: overlaps bodies.A1 by 0.01 m" in message for message in caught.value.messages)


def test_overlap_agrees_with_points_inside_both():
    random = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 25)] * 3), axis=-1).reshape(-1, 3)
    seen = set()
    for _ in range(200):
        first, second = (
            places.Place(centre, places.rotation(angles), BoxShape.model_construct(size=tuple(2.0 * half)))
            for centre, half, angles in random.uniform([[-1], [0.2], [-180]], [[1], [1], [180]], (2, 3, 3))
        )
        points = (grid * first.half) @ first.axes.T + first.centre
        common = bool(np.any(np.all(np.abs((points - second.centre) @ second.axes) <= second.half, axis=1)))
        depth = places.overlap(first, second)
        assert depth == pytest.approx(places.overlap(second, first))
        # the grid misses overlaps thinner than its own step
        assert common == (depth > 0) or (not common and depth < 0.1)
        seen.add(common)
    assert seen == {True, False}


def test_rotation_is_about_x_then_y_then_z():
    assert places.rotation((90, 0, 90)) @ [0, 1, 0] == pytest.approx([0, 0, 1])
    assert places.rotation((0, 90, 90)) @ [0, 0, 1] == pytest.approx([0, 1, 0])
    assert places.rotation((0, 30, 0)) @ [1, 0, 0] == pytest.approx([math.sqrt(3) / 2, 0, -0.5])


@pytest.mark.parametrize("period", [(np.inf, np.inf, np.inf), (2.0, np.inf, np.inf), (2.0, 2.0, np.inf)])
def test_no_pair_of_boxes_is_missed(period):
    rng, period = np.random.default_rng(3), np.array(period)
    boxes = [SimpleNamespace(centre=rng.uniform(-1.0, 1.0, 3), reach=rng.uniform(0.02, 0.2, 3)) for _ in range(100)]
    expected = []
    for i, j in itertools.combinations(range(100), 2):
        apart = boxes[j].centre - boxes[i].centre
        shift = -np.where(np.isfinite(period), period * np.round(apart / period), 0.0)
        if np.all(np.abs(apart + shift) < boxes[i].reach + boxes[j].reach):
            expected.append((i, j, *shift))
    assert len(expected) > 20
    assert [(i, j, *shift) for i, j, shift in places.near_pairs(boxes, period)] == expected
    assert list(places.near_pairs([])) == []
