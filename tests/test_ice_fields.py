"""Floes of a field have room: among themselves, beside all else and within the box; and they float."""

import math
import subprocess
import sys
import tomllib
from itertools import pairwise

import numpy as np
import pytest
from example_cases import ROOT
from hypothesis import given, settings
from hypothesis import strategies as st
from ice_cases import FIELD, basin, field, plane

from parsim.__main__ import main
from parsim.case import ice
from parsim.case.model import load, parse
from parsim.case.places import Place, rotation
from parsim.case.plans import plan_of
from parsim.ice.cells import cut
from parsim.ice.draw import Laws, draw
from parsim.ice.field import covering, room_for, spread
from parsim.ice.laws import Listed, Lognormal, Uniform
from parsim.ice.outlines import gaps, moved, near, outlines
from parsim.ice.place import Region, Taken, place
from parsim.solid.shapes import BoxShape

THICK, SQUARE = Listed(kind="list", values=(0.1,)), Listed(kind="list", values=(1.0,))
NOTHING = outlines([], [])
REGION = Region((1.0, -2.0), (9.0, 4.0))
PIER = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


def laws(shape, sigma=0.3):
    size = Lognormal(kind="lognormal", median=1.0, sigma=sigma, min=0.5, max=2.0)
    return Laws(shape, size, THICK, Uniform(kind="uniform", min=1.0, max=1.5))


def corners(one):
    """Corners (k, 2) of a placed floe, by its own turn and place."""
    c, s = math.cos(one.pose.turn), math.sin(one.pose.turn)
    return one.floe.outline @ np.array([[c, s], [-s, c]]) + (one.pose.x, one.pose.y)


def between(one, two):
    """Distance of two polygons from corners to sides; 0 where a corner or the middle of one is in the other."""
    least = np.inf
    for points, around in ((one, two), (two, one)):
        start, way = around, np.roll(around, -1, axis=0) - around
        off = points[:, None] - start
        outward = off[..., 0] * way[:, 1] - off[..., 1] * way[:, 0]
        if (outward <= 0.0).all(axis=1).any():
            return 0.0
        along = np.clip((off * way).sum(axis=2) / (way * way).sum(axis=1), 0.0, 1.0)
        least = min(least, np.linalg.norm(off - along[..., None] * way, axis=2).min())
    return least


def assert_room(found, gap, region=REGION, fixed=()):
    every = [corners(one) for one in found]
    for points in every:
        assert (points > np.array(region.low) - 1e-6).all() and (points < np.array(region.high) + 1e-6).all()
    for i, one in enumerate(found):
        for j, other in enumerate(found[:i]):
            if one.floe.round:
                apart = math.dist(one.pose[:2], other.pose[:2]) - one.floe.round - other.floe.round
            else:
                apart = between(every[i], every[j])
            assert apart >= gap - 1e-6
        assert all(between(every[i], wall) >= gap - 1e-6 for wall in fixed)


@settings(max_examples=20, deadline=None)
@given(shape=st.sampled_from(["box", "disc", "polygon"]), seed=st.integers(0, 2**40), share=st.floats(0.05, 0.6),
       gap=st.sampled_from([0.0, 0.02, 0.05]))  # fmt: skip
def test_no_floe_meets_another(shape, seed, share, gap):
    floes = covering(share * 48.0, seed, 1, laws(shape))
    found = spread(floes, REGION, NOTHING, gap)
    assert found is not None
    assert [one.floe.key for one in found] == [floe.key for floe in floes]
    assert [one.floe.area for one in found] == [floe.area for floe in floes]
    assert_room(found, gap)
    assert abs(sum(one.floe.area for one in found) - share * 48.0) <= max(one.floe.area for one in found)


@pytest.mark.parametrize(("shape", "share"), [("disc", 0.65), ("box", 0.65), ("polygon", 0.8), ("polygon", 0.85)])
def test_what_each_shape_reaches(shape, share):
    """Large floes, 40 gaps across, of which a few sizes are mixed; polygons are cut from a cover."""
    floes = covering(share * 48.0, 3, 1, laws(shape))
    found = spread(floes, REGION, NOTHING, 0.025)
    assert_room(found, 0.025)
    reached = sum(abs(0.5 * np.sum(np.cross(c, np.roll(c, -1, axis=0)))) for c in map(of_plane, found))
    if shape != "disc":
        assert reached == pytest.approx(share * 48.0, abs=0.5 * max(floe.area for floe in floes))


def of_plane(one):
    return np.column_stack([corners(one), np.zeros(len(one.floe.outline))])


@pytest.mark.parametrize("shape", ["box", "disc", "polygon"])
@pytest.mark.parametrize("share", [0.3, 0.6])
def test_what_stands_there_is_left_free(shape, share):
    wall = PIER * 0.8 + (5.0, 1.0)
    fixed = moved(outlines([PIER * 0.8], [0.0]), *(np.array([v]) for v in (5.0, 1.0, 1.0, 0.0)))
    found = spread(covering(share * 48.0, 4, 1, laws(shape)), REGION, fixed, 0.04)
    assert_room(found, 0.04, fixed=[wall])


@pytest.mark.parametrize("shape", ["box", "disc", "polygon"])
def test_what_stands_right_beside_the_rectangle_is_kept_off_too(shape):
    wall = np.array([[0.0, -3.0], [0.99, -3.0], [0.99, 5.0], [0.0, 5.0]])
    centre = wall.mean(axis=0)
    fixed = moved(outlines([wall - centre], [0.0]), *(np.array([v]) for v in (*centre, 1.0, 0.0)))
    found = spread(covering(0.2 * 48.0, 4, 1, laws(shape)), REGION, fixed, 0.3)
    assert min(corners(one)[:, 0].min() for one in found) >= 0.99 + 0.3 - 1e-6


def test_where_there_is_no_room():
    region, floes = Region((0.0, 0.0), (4.0, 4.0)), covering(0.9 * 16.0, 1, 1, laws("disc"))
    assert spread(floes, region, NOTHING, 0.05) is None
    reached = room_for(floes, region, NOTHING, 0.05)
    assert 0.4 < reached / 16.0 < 0.85
    assert spread(covering(reached, 1, 1, laws("disc")), region, NOTHING, 0.05, 1) is not None
    assert room_for(floes, Region((0.0, 0.0), (0.1, 0.1)), NOTHING, 0.05) == 0.0


def test_one_after_the_other():
    """As a supply does it: until there is no room, and each floe at the same place in what is the same."""
    poses = []
    for _ in range(2):
        taken = Taken(REGION, 0.02, 2.0)
        poses.append([place(draw(1, 1, n, laws("polygon")), taken) for n in range(1, 60)])
    assert poses[0] == poses[1]
    placed = [pose is not None for pose in poses[0]]
    assert all(placed[:10]) and not all(placed) and 15 < sum(placed) < 50


def test_gaps_in_plain_cases():
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    own = outlines([square, square, PIER], [0.0, 0.0, 0.0])
    there = moved(own, *(np.array(v) for v in ([0.0, 1.3, 0.0], [0.0, 0.2, 2.0], [1.0] * 3, [0.0] * 3)))
    found = gaps(there.take(np.array([0, 0, 2])), there.take(np.array([1, 2, 0])))
    assert found.apart == pytest.approx([0.3, 0.5, 0.5])
    assert (found.nx[0], found.ny[0]) == pytest.approx((1.0, 0.0))
    assert (found.nx[2], found.ny[2]) == pytest.approx((0.0, -1.0)), "from the first to the second"
    assert sorted(zip(*(rows.tolist() for rows in near(there, 0.0)), strict=True)) == []
    assert {frozenset(p) for p in zip(*(r.tolist() for r in near(there, 0.35)), strict=True)} == {
        frozenset(p) for p in ((0, 1), (1, 2))
    }


def test_corners_that_nearly_coincide_keep_nothing_apart():
    plate = np.array([[-0.02, -0.5], [0.02, -0.5], [0.02, 0.5], [0.02 + 3e-18, 0.5 + 1e-17], [-0.02, 0.5]])
    own = outlines([plate, PIER * 0.2], [0.0, 0.0])
    there = moved(own, *(np.array(v) for v in ([0.0, 0.2], [0.0, 0.3], [1.0] * 2, [0.0] * 2)))
    for one, two in ((0, 1), (1, 0)):
        assert gaps(there.take(np.array([one])), there.take(np.array([two]))).apart[0] == pytest.approx(-0.02)


def test_cells_hold_their_areas():
    dice = np.random.default_rng(1)
    sites, areas = dice.uniform((1.0, -2.0), (9.0, 4.0), (40, 2)), dice.uniform(0.5, 1.5, 40)
    areas *= 0.8 * 48.0 / areas.sum()
    cells = cut(sites, areas, NOTHING, REGION, 0.03)
    for cell, area in zip(cells, areas, strict=True):
        x, y = cell.T
        assert 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) == pytest.approx(area)
    assert min(between(a, b) for i, a in enumerate(cells) for b in cells[:i]) >= 0.03 - 1e-9
    assert cut(sites, areas * 1.24, NOTHING, REGION, 0.03, rounds=20) is None


@pytest.mark.parametrize("shape", ["box", "disc", "polygon"])
def test_floes_of_a_case_float(shape):
    case = parse(basin(field(shape=shape, thickness={"kind": "uniform", "min": 0.05, "max": 0.08}), gate=True))
    (made,) = case.ice.fields
    floes = [body for body in case.bodies if body.name.startswith("ice_")]
    assert [body.name for body in floes] == [f"ice_{n}" for n in range(1, made.floes + 1)]
    for body in floes:
        thick = 2.0 * body.shape.half[2]
        assert body.position[2] == pytest.approx(0.2 + thick * (0.5 - 0.9), abs=1e-12), "Archimedes"
        assert 0.05 <= thick <= 0.08 and body.velocity == (0.1, 0.0, 0.0) and body.density == 900.0
    assert len({body.angles[2] for body in floes}) == len(floes)
    assert parse(tomllib.loads(case.to_toml())) == case, "the stored case has the same floes, to the bit"


def test_the_plan_of_a_body_holds_all_of_it():
    size = BoxShape(size=(0.04, 1.0, 0.3))
    for angle in (0.0, 15.0, 20.0, 90.0):
        there = plan_of(Place(np.array([1.0, 2.0, 0.0]), rotation((0.0, 0.0, angle)), size), 0.0)
        plan = np.stack(there[:2], 2)[0]
        corners = size.surface()[0] @ rotation((0.0, 0.0, angle)).T + (1.0, 2.0, 0.0)
        for n in (np.array([math.cos(a), math.sin(a)]) for a in np.arange(0.0, 6.3, 0.05)):
            assert (corners[:, :2] @ n).max() - 1e-6 <= (plan @ n).max() <= (corners[:, :2] @ n).max() + 0.02


def test_several_fields_and_bodies_leave_each_other_room():
    """The check of all bodies, exact and by other code, finds no overlap, across fields, a pier, a gate and sides."""
    pier = {"name": "pier", "shape": {"kind": "cylinder", "diameter": 0.2, "height": 0.4}, "density": 2000.0,
            "position": [0.5, 0.5, 0.2], "material": "ice", "fixed": True}  # fmt: skip
    deep = pier | {"name": "sunk", "position": [1.7, 0.5, 0.02], "shape": {"size": [0.4, 0.4, 0.04]}}
    fields = [field(name="a", max=[1.2, 1.0]), field(name="b", min=[0.8, 0.0], shape="disc", concentration=0.2)]
    case = parse(basin(*fields, bodies=[pier, deep], gate=True))
    assert all(f.floes > 5 for f in case.ice.fields)
    over = [b for b in case.bodies[2:] if abs(b.position[0] - 1.7) < 0.2 and abs(b.position[1] - 0.5) < 0.2]
    assert over, "what lies on the floor takes no room at the surface"


def test_the_same_in_another_process(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text((ROOT / "cases" / "ice_field" / "floes.toml").read_text())
    words = f"from parsim.case.model import load; import sys; sys.stdout.write(load({str(path)!r}).to_toml())"
    other = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    assert other == load(path).to_toml()


def test_what_check_says(capsys):
    main(["check", str(ROOT / "cases" / "ice_field" / "floes.toml")])
    out = capsys.readouterr().out
    (line,) = [line for line in out.splitlines() if line.startswith("ice ")]
    asked, reached = 0.6 * 1.6, float(line.split(" floes on ")[1].split()[0])
    assert f"{asked:.4g} m2 asked for" in line and f"concentration {reached / 1.6:.3f}"[:17] in line
    assert abs(reached - asked) < math.pi / 4.0 * 0.45**2, "within one floe"
    assert "warning: ice" not in out


def test_small_floes_are_told_once_a_field():
    told = [text for text in parse(basin(field())).warnings() if "ice" in text]
    assert len(told) == 1 and "ice.fields.ice: " in told[0] and "fewer than four particles" in told[0]


@pytest.mark.parametrize("share", [0.1, 0.6, 0.9])
def test_floes_in_a_row(share):
    wall = {"name": "weir", "shape": {"size": [0.2, 1.0, 0.4]}, "density": 2000.0, "position": [1.0, 0.5, 0.2],
            "material": "ice", "fixed": True}  # fmt: skip
    case = parse(plane({"concentration": share * 0.88, "gap": 0.005}, bodies=[wall]))
    floes = sorted(case.bodies, key=lambda body: body.position[0])
    ends = [(b.position[0] - b.shape.half[0], b.position[0] + b.shape.half[0]) for b in floes]
    assert all(low - high >= 0.005 - 1e-8 for (_, high), (low, _) in pairwise(ends))
    lengths = [b.shape.size[0] for b in case.bodies[1:]]
    assert sum(lengths) == pytest.approx(share * 0.88 * 2.0, abs=max(lengths))
    assert all(b.shape.size[1] == 1.0 and b.position[1] == 0.5 and not any(b.angles) for b in case.bodies)
    assert ice.told(case)[0].count(" m ") >= 1 and FIELD["name"] in ice.told(case)[0]
