"""Bodies that weigh less than the water they move: the coupling must be stable for them at the default step."""

import numpy as np
import pytest

from parsim.case.model import parse
from parsim.coupling.response import added_inertia
from parsim.domain.comm import Comm
from parsim.geometry.rotation import from_angles, matrices
from parsim.run.simulation import Simulation
from parsim.solid.acceleration import Given, accelerate_bodies

SQUARE, ADDED = 0.2, 1.18831  # m; added mass of a deep square over its displaced mass (1.513 pi / 4)


def tank(density, z, spacing=0.02, depth=0.4):
    """A square of this density, kg/m3, at height z, m, in a 2D tank."""
    return parse({
        "dimensions": 2, "spacing": spacing, "box": {"max": [1.0, 1.0, 0.8]}, "run": {"until": 0.2, "settle": 0.0},
        "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, depth]}]},
        "materials": {"m": {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}},
        "bodies": [{"name": "a", "shape": {"size": [SQUARE, 1.0, SQUARE]}, "density": density, "material": "m",
                    "position": [0.5, 0.5, z]}],
    })  # fmt: skip


@pytest.mark.parametrize("density", [1.0, 35.0, 200.0])
def test_a_light_square_rises_as_its_added_mass_lets_it(density):
    simulation = Simulation(tank(density, 0.2), Comm())
    while simulation.time < 0.05:
        simulation.step()
    exact = (1000.0 - density) * 9.81 / (density + ADDED * 1000.0)
    assert simulation.bodies.velocity[0, 2] / simulation.time == pytest.approx(exact, rel=0.1)


@pytest.mark.parametrize("gap", [0.5, 0.6, 0.65, 0.68, 0.71, 0.8, 1.0])
def test_a_block_starts_at_any_height_above_a_row_of_water(gap):
    simulation = Simulation(tank(900.0, 0.15 + 0.02 * gap + 0.1, depth=0.16), Comm())
    fastest = 0.0
    while simulation.time < 0.05:
        simulation.step()
        fastest = max(fastest, abs(simulation.bodies.velocity[0, 2]))
    assert fastest < 1.1 * 9.81 * simulation.time


def cross(v):
    """Matrix of the cross product with v (3,) from the left."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def test_accelerations_against_a_plain_solution():
    """One turned body in 3D with three samples: the inertia that they add, and the equations of Newton and Euler."""
    rng = np.random.default_rng(3)
    place, centre, root = rng.normal(size=(3, 3)), rng.normal(size=(1, 3)), rng.normal(size=(3, 3, 3))
    s = root @ root.transpose(0, 2, 1)
    triangle = np.triu_indices(3)
    added, water = np.empty((3, 24)), np.zeros((6, 6))
    response = s[:, triangle[0], triangle[1]]
    added_inertia(place - centre, response, added)
    for k in range(3):
        j = np.hstack([np.eye(3), -cross(place[k] - centre[0])])
        water += j.T @ s[k] @ j
    total = added.sum(0)
    assert total[:21] == pytest.approx(water[np.triu_indices(6)], rel=1e-12)

    mass, inertia, quaternion = np.array([0.3]), np.array([[0.2, 0.5, 0.4]]), from_angles((20.0, -50.0, 70.0))[None]
    before, spin, load, contact = rng.normal(size=(6,)), rng.normal(size=(1, 3)), *rng.normal(size=(2, 1, 6))
    gravity, turn = np.array([0.0, 0.0, -9.81]), matrices(quaternion)[0]
    own = turn @ np.diag(inertia[0]) @ turn.T
    rigid = np.block([[mass[0] * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), own]])
    given = contact[0] + np.concatenate([mass[0] * gravity, -np.cross(spin[0], own @ spin[0])])
    exact = np.linalg.solve(rigid + water, load[0] + water @ before + given)
    for held in (False, True):
        now, angular, change, left = before[None, :3].copy(), before[None, 3:].copy(), np.zeros((1, 6)), load.copy()
        free = np.full((1, 6), 0.0 if held else 1.0)
        bodies = Given(mass, inertia, quaternion, contact, spin, free, np.zeros((1, 6)), np.zeros((1, 3)), np.zeros(1))
        accelerate_bodies(left, total[None], bodies, gravity, now, angular, change)
        after = np.zeros(6) if held else exact
        assert np.hstack([now, angular])[0] == pytest.approx(after, rel=1e-10, abs=1e-10)
        assert change[0] == pytest.approx(after - before, rel=1e-10, abs=1e-10)
        assert left[0] == pytest.approx(load[0] - water @ (after - before), rel=1e-10, abs=1e-10)
    assert rigid @ exact == pytest.approx(load[0] - water @ (exact - before) + given, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("weight", ["mps", "wendland_c4"])
@pytest.mark.parametrize("second", [1.5, 1.8])
@pytest.mark.parametrize("height", [0.2, 0.25, 0.3])
def test_no_water_is_left_in_an_edge_of_a_body_or_flung_out_of_it(weight, second, height):
    blocks = [{"name": name, "shape": {"size": [0.015, 1.0, 0.015]}, "density": 2000.0, "material": "wood",
               "position": [0.01 * x, 0.5, 0.01 * (height + 0.75)], "fixed": True}
              for name, x in (("a", 2.0), ("b", 2.0 + second))]  # fmt: skip
    simulation = Simulation(parse({
        "dimensions": 2, "spacing": 0.01, "box": {"max": [0.4, 1.0, 0.2]}, "bodies": blocks, "run": {"until": 1.0},
        "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.02]}], "speed": 1.5,
                  "scheme": {"weight": weight}},
        "materials": {"wood": {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}},
    }), Comm())  # fmt: skip
    for _ in range(10):
        simulation.step()
    water = simulation.snapshot().water
    assert np.hypot(water.u, water.w).max() < 0.5
