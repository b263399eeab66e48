"""The water at the start: profiles of its velocity, when it gets it, and its disorder."""

import numpy as np
import pytest
from clouds import outside_box
from test_water import TANK, simulation

from parsim.case.fill import profile_shares
from parsim.case.model import Fill, parse
from parsim.case.openings import standing_at
from parsim.domain.comm import Comm
from parsim.fluid.wcmps.scheme import WCMPS
from parsim.geometry.rotation import matrices
from parsim.particles.lattice import Lattice
from parsim.particles.state import FLUID, make_id
from parsim.run.fill import disordered, flow, water
from parsim.solid.bodies import from_case

CHANNEL = TANK | {"box": {"max": [0.2, 1.0, 0.2], "faces": {"x_min": "periodic", "x_max": "periodic"}}}


def fill(profile, top=0.4, **more):
    """A fill from z = 0.1 to `top` with a profile."""
    return Fill.model_validate({"min": [0.0, 0.0, 0.1], "max": [1.0, 1.0, top], "profile": profile} | more)


@pytest.mark.parametrize("profile", [
    None, {"kind": "linear"}, {"kind": "linear", "bottom": 0.7}, {"kind": "linear", "bottom": 2.0},
    {"kind": "log", "roughness": 1e-4}, {"kind": "log", "roughness": 0.03}, {"kind": "log", "roughness": 0.3},
    {"kind": "log", "roughness": 2.9}, {"kind": "table", "heights": [0.0, 0.1, 0.3], "shares": [0.25, 1.0, 1.375]},
])  # fmt: skip
def test_the_mean_of_a_profile_over_the_depth_is_one(profile):
    heights = 0.1 + 0.3 * (np.arange(200) + 0.5) / 200
    assert profile_shares(fill(profile), heights).mean() == pytest.approx(1.0, abs=0.01)


def test_profiles_have_the_shape_they_are_named_after():
    z = np.array([0.1, 0.2, 0.35, 0.4])
    assert profile_shares(fill({"kind": "linear", "bottom": 0.4}), z) == pytest.approx([0.4, 0.8, 1.4, 1.6])
    rough = {"kind": "log", "roughness": 0.003}
    low, deep, high = profile_shares(fill(rough), 0.1 + np.array([0.01, 0.1, 0.2]))
    assert (high - deep) / (deep - low) == pytest.approx(np.log(2) / np.log(10))
    assert (profile_shares(fill(rough), 0.1 + np.array([0.0, 5e-5, 9.9e-5])) == 0.0).all(), "nothing flows backward"
    table = {"kind": "table", "heights": [0.05, 0.1, 0.2], "shares": [0.5, 1.0, 3.0]}
    assert profile_shares(fill(table), z) == pytest.approx([0.5, 1.0, 3.0, 3.0]), "kept beyond its ends"
    assert profile_shares(fill(table), np.array([0.175, 0.25])) == pytest.approx([0.75, 2.0])


def two_fills(**water_too):
    """A tank with two fills of their own velocities; no settling."""
    fills = [
        {
            "min": [0.0, 0.0, 0.0],
            "max": [0.1, 1.0, 0.1],
            "velocity": [0.2, 0.0, 0.1],
            "profile": {"kind": "linear", "bottom": 0.5},
        },
        {"min": [0.1, 0.0, 0.0], "max": [0.2, 1.0, 0.05], "velocity": [-0.3, 0.0, 0.0]},
    ]
    return parse(TANK | {"water": {"fill": fills} | water_too})


def test_every_fill_gives_its_own_water_its_velocity():
    case = two_fills()
    s = simulation(case.model_dump(exclude_none=True))
    p = s.domain.particles
    fluid = p.kind == FLUID
    first, second = fluid & (p.id < make_id(FLUID, 100)), fluid & (p.id >= make_id(FLUID, 100))
    assert (first.sum(), second.sum()) == (100, 50)
    share = 0.5 + p.z / 0.1
    for _ in range(2):
        assert p.u[first] == pytest.approx(0.2 * share[first]) and p.w[first] == pytest.approx(0.1 * share[first])
        assert (p.u[second] == -0.3).all() and (p.w[second] == 0.0).all()
        assert (p.u[~fluid] == 0.0).all()
        p.u[first], p.u[second] = 7.0, 8.0
        p.x[first] += 0.1  # water is known by its number, not by its place
        flow(case, p)


def test_water_that_settles_gets_its_velocity_when_it_has_settled():
    profile = {"kind": "log", "roughness": 0.001}
    start = [{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.1], "velocity": [0.4, 0.0, 0.0], "profile": profile}]
    s = simulation(CHANNEL | {"water": {"fill": start, "disorder": 0.1}, "run": {"until": 1.0, "settle": 0.01}})
    while s.time < 0.0:
        assert s.speed < 0.1 and abs(s.domain.particles.u[s.near.fluid].mean()) < 0.01
        s.step()
    p, at = s.domain.particles, s.near.fluid
    halo = np.setdiff1d(np.flatnonzero(p.kind == FLUID), at)
    for where in (at, halo):
        assert where.size > 50
        assert p.u[where] == pytest.approx(0.4 * profile_shares(s.case.water.fill[0], p.z[where]), rel=1e-12)
    assert p.u[at].mean() == pytest.approx(0.4, rel=0.01) and (p.w[at] == 0.0).all()
    assert s.speed == pytest.approx(p.u[at].max())
    for _ in range(10):
        s.step()
    p, at = s.domain.particles, s.near.fluid
    assert p.u[at].mean() == pytest.approx(0.4, rel=0.05), "once, and not held there"


@pytest.mark.parametrize("axes", [(0, 2), (0, 1, 2)])
def test_disorder_moves_nobody_far_nor_out(axes):
    points = Lattice((0.0, 0.0, 0.0), (0.2, 0.1, 0.15), 0.01, axes)
    every = np.arange(points.size)
    even, moved = points.points(every), disordered(points, every, 7, 0.3, axes)
    off = np.abs(moved - even) / points.spacing
    assert off.max() <= 0.3 + 1e-9
    for a in range(3):
        assert moved[:, a].min() >= points.rows[a][0] and moved[:, a].max() <= points.rows[a][-1]
        if a in axes:
            inner = (even[:, a] > points.rows[a][0]) & (even[:, a] < points.rows[a][-1])
            assert off[inner, a].mean() == pytest.approx(0.15, rel=0.1)
            assert abs((moved - even)[inner, a].mean()) < 0.1 * 0.15 * points.spacing[a]
        else:
            assert (moved[:, a] == even[:, a]).all()
    some = every[3::5]
    assert (disordered(points, some, 7, 0.3, axes) == moved[some]).all(), "the same in any slab"
    assert (disordered(points, every, 8, 0.3, axes) != moved)[:, axes].mean() > 0.9
    assert (disordered(points, every, 7, 0.0, axes) == even).all()


@pytest.mark.parametrize("seed", range(4))
def test_disorder_moves_no_water_into_bodies_or_the_gate(seed):
    random = np.random.default_rng(seed)
    body = {"shape": {"size": [0.06, 1.0, 0.043]}, "density": 700.0, "material": "wood"}
    bodies = [
        body
        | {
            "name": f"b{i}",
            "position": [0.06 + 0.17 * i + 0.01 * random.random(), 0.5, 0.08],
            "angles": [0.0, 90.0 * random.random(), 0.0],
        }
        for i in range(2)
    ]
    fills = [{"min": [0.0, 0.0, 0.0], "max": [0.4, 1.0, 0.13]}]
    data = TANK | {"box": {"max": [0.4, 1.0, 0.2]}, "bodies": bodies, "gate": {"min_x": 0.147, "max_x": 0.152}}
    even, moved = (simulation(data | {"water": {"fill": fills, "disorder": share}}) for share in (0.0, 0.5))
    places = []
    for s in (even, moved):
        p, at = s.domain.particles, s.near.fluid
        order = np.argsort(p.id[at])
        places.append(np.stack([p.x[at], p.y[at], p.z[at]], 1)[order])
    before, after = places
    assert before.shape == after.shape and np.abs(after - before)[:, [0, 2]].mean() > 0.002

    def clear(place):
        boxes = [
            outside_box(place, c, turn, half, (0, 2))[0]
            for c, turn, half in zip(
                even.bodies.position, matrices(even.bodies.quaternion), even.bodies.forms.half, strict=True
            )
        ]
        return np.minimum(np.min(boxes, axis=0), np.maximum(0.147 - place[:, 0], place[:, 0] - 0.152))

    assert (clear(after) >= np.minimum(clear(before), 0.005) - 1e-12).all()
    assert (clear(after) < 0.01).sum() > 20, "some do stand beside them"


def cut(low, high, random, depth):
    """Boxes of lattice points, (2, 2) in x and z, that a box from `low` to `high` is cut into at random."""
    axis = int(random.integers(2))
    if not depth or high[axis] - low[axis] < 2:
        return [(low, high)]
    at = int(random.integers(low[axis] + 1, high[axis]))
    middle = [(at if a == axis else high[a]) for a in range(2)], [(at if a == axis else low[a]) for a in range(2)]
    return [*cut(low, middle[0], random, depth - 1), *cut(middle[1], high, random, depth - 1)]


@pytest.mark.parametrize("seed", range(20))
def test_touching_fills_are_one_water_however_they_are_cut(seed):
    random = np.random.default_rng(seed)
    boxes = cut([0, 0], [20, 17], random, 3)
    random.shuffle(boxes)
    parts = [{"min": [0.01 * x0, 0.0, 0.01 * z0], "max": [0.01 * x1, 1.0, 0.01 * z1]}
             for (x0, z0), (x1, z1) in boxes]  # fmt: skip
    body = {
        "name": "b",
        "shape": {"size": [0.053, 1.0, 0.06]},
        "density": 800.0,
        "material": "wood",
        "position": [0.1, 0.5, "float"],
    }
    found = []
    for fills in ([{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.17]}], parts):
        case, free = (parse(TANK | {"bodies": bodies, "water": {"fill": fills}}) for bodies in ([body], []))
        p = water(free, from_case(free), WCMPS(free), Comm())
        order = np.lexsort((np.round(p.x, 9), np.round(p.z, 9)))
        found.append((case.bodies[0].position[2], p.x[order], p.z[order], p.n[order]))
        immersed = water(case, from_case(case), WCMPS(case), Comm())
        assert len(immersed) == pytest.approx(20 * 17 - 5.3 * 4.8, abs=0.6), "less what the body displaces"
    for one, many in zip(*found, strict=True):
        assert many == pytest.approx(one, rel=1e-12, abs=1e-12)
    assert np.ptp(found[0][3]) > 0.001 * found[0][3][0], "the pressure rises with depth"


def test_slabs_start_with_the_parts_of_one_disorder_and_flow():
    case = two_fills(disorder=0.3)
    s = simulation(case.model_dump(exclude_none=True))
    whole = water(case, s.bodies, s.scheme, Comm())
    assert (whole.y == 0.5).all() and np.unique(whole.x).size > 100
    parts = [
        water(case, s.bodies, s.scheme, Comm(), lambda x, side=side: (x < 0.063) == side) for side in (True, False)
    ]
    order = np.argsort(np.concatenate([part.id for part in parts]))
    for name in ("id", "x", "z", "u", "w", "n"):
        assert (np.concatenate([getattr(part, name) for part in parts])[order] == getattr(whole, name)).all()


def test_the_water_at_a_side_is_looked_for_beside_its_middle():
    """Two arms of a river beside an island; where there is water amid, that one tells."""
    arms = [
        {"min": [0.0, low, 0.0], "max": [0.4, high, level]} for low, high, level in ((0.0, 0.1, 0.1), (0.2, 0.3, 0.12))
    ]
    case = parse(TANK | {"dimensions": 3, "box": {"max": [0.4, 0.3, 0.2]}, "water": {"fill": arms}})
    assert standing_at(case, 0.0) == (0.0, 0.12)
    assert standing_at(case, 9.0) is None
    amid = {"min": [0.0, 0.1, 0.0], "max": [0.4, 0.2, 0.06]}
    case = parse(TANK | {"dimensions": 3, "box": {"max": [0.4, 0.3, 0.2]}, "water": {"fill": [*arms, amid]}})
    assert standing_at(case, 0.0) == (0.0, 0.06)
