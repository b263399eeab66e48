"""Depth of the water by columns, and the length of eddies that follows from it."""

import math

import numpy as np
import pytest
from flows import WOOD, simulation, tank

from parsim.fluid import turbulence
from parsim.fluid.friction import KAPPA
from parsim.fluid.turbulence import Depths, Length
from parsim.observe.counts import Counts
from parsim.particles.state import BODY

EDDIES = {"friction": {"kind": "wall_law", "roughness": 0.001}, "eddies": {"kind": "mixing_length"}}


def body(name, x, z, size, **changes):
    own = {"name": name, "shape": {"size": size}, "density": 800.0, "position": [x, 0.5, z], "material": "wood"}
    return own | changes


def pond(*bodies, **friction):
    water = EDDIES | {"friction": EDDIES["friction"] | friction}
    return simulation(tank(0.8, 0.3, 0.01, fill=(0.8, 0.2), **water) | {"materials": WOOD, "bodies": list(bodies)})


def row_of(observer, s):
    return dict(zip((column.name for column in observer.columns), observer(s.case).rows(s)[0], strict=True))


def test_columns_reach_from_the_bottom_to_the_surface_or_to_ice():
    s = pond(
        body("ice", 0.2, 0.19, [0.2, 1.0, 0.06], fixed=True),
        body("sill", 0.5, 0.03, [0.2, 1.0, 0.06], fixed=True),
        body("sunk", 0.7, 0.1, [0.04, 1.0, 0.04]),
    )
    depths = s.solids.depths
    x = (np.arange(depths.nx) + 0.5) * depths.edge
    assert depths.edge == 0.02 and depths.ny == 1 and depths.bottom.size == depths.nx == 40
    within = {name: (x > low + 0.01) & (x < high - 0.01) for name, low, high in (
        ("ice", 0.1, 0.3), ("sill", 0.4, 0.6), ("sunk", 0.68, 0.72)
    )}  # fmt: skip
    plain = ~np.logical_or.reduce(list(within.values())) & ~((x > 0.08) & (x < 0.74))
    assert depths.bottom[plain] == pytest.approx(0.0) and depths.top[plain] == pytest.approx(0.2, abs=0.006)
    assert not depths.covered[plain].any() and not depths.covered[within["sill"]].any()
    assert depths.covered[within["ice"]].all() and depths.top[within["ice"]] == pytest.approx(0.16, abs=1e-9)
    assert depths.bottom[within["sill"]] == pytest.approx(0.06, abs=1e-9)
    assert depths.covered[within["sunk"]].all() and depths.top[within["sunk"]] == pytest.approx(0.08, abs=1e-9)


def test_fixed_bodies_may_stand_in_each_other():
    """A pier in a sill: nobody is sampled twice, nothing is missing, and the water beside stays at rest."""
    s = pond(
        body("pier", 0.5, 0.13, [0.04, 1.0, 0.26], fixed=True), body("sill", 0.5, 0.03, [0.2, 1.0, 0.06], fixed=True)
    )
    p = s.domain.particles
    at = np.flatnonzero(p.kind == BODY)
    places = np.stack([p.x[at], p.z[at]], axis=1)
    apart = np.sqrt(((places[:, None] - places[None]) ** 2).sum(2)) + np.eye(at.size)
    assert apart.min() > 0.0099
    holes = np.stack(np.meshgrid(np.arange(0.41, 0.6, 0.01), np.arange(0.035, 0.055, 0.01)), -1).reshape(-1, 2)
    assert np.sqrt(((holes[:, None] - places[None]) ** 2).sum(2)).min(axis=1).max() < 0.0075
    while s.time < 0.2:
        s.step()
    at = s.near.fluid
    assert np.sqrt(p.u[at] ** 2 + p.w[at] ** 2).max() < 0.02 and row_of(Counts, s)["in_bodies"] == 0
    assert s.bodies.water_load[:, 0] == pytest.approx(0.0, abs=0.5)


def test_what_does_not_rub_covers_nothing():
    s = pond(body("ice", 0.2, 0.19, [0.2, 1.0, 0.06], fixed=True), bodies=False)
    depths = s.solids.depths
    assert not depths.covered.any() and depths.top[10] == pytest.approx(0.16, abs=1e-9)


def test_the_length_of_eddies():
    """Over the floor kappa d sqrt(1 - d / H), of whatever depth the column has; under ice that of a pipe."""
    bottom, top = np.array([0.0, 0.1]), np.array([0.2, 0.3])
    walls, open_top = np.zeros((0, 4)), np.array([False, False])
    length = Length(walls, True, math.inf)
    for covered in (open_top, ~open_top):
        depths = Depths(0.0, 0.0, 1.0, 2, 1, bottom, top, covered)
        for x, low in ((0.5, 0.0), (1.5, 0.1), (9.0, 0.1), (-9.0, 0.0)):
            for d in (0.001, 0.05, 0.1, 0.15, 0.199):
                found = turbulence._mixing_length(length, depths, x, 0.5, low + d)
                s = 1.0 - min(d, 0.2 - d) / 0.1
                duct = KAPPA / 0.4 * 0.1 * (0.14 - 0.08 * s**2 - 0.06 * s**4)
                assert found == pytest.approx(duct if covered[0] else KAPPA * d * math.sqrt(1.0 - d / 0.2), rel=1e-12)
                if d == 0.001 and covered[0]:
                    assert found == pytest.approx(KAPPA * d, rel=0.02)
            assert turbulence._mixing_length(length, depths, x, 0.5, low + 0.25) == pytest.approx(0.0, abs=1e-15)
    beside = Length(np.array([[1.0, 0.0, 0.0, 0.48]]), True, 0.03)
    assert turbulence._mixing_length(beside, depths, 0.5, 0.5, 0.1) == pytest.approx(KAPPA * 0.02)
    assert turbulence._mixing_length(beside._replace(walls=walls), depths, 0.5, 0.5, 0.1) == pytest.approx(
        0.014 * KAPPA / 0.4
    )
    assert turbulence._mixing_length(Length(walls, False, 0.03), depths, 0.5, 0.5, 0.1) == 0.03
