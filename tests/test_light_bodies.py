"""Bodies that weigh less than the water they move: the coupling must be stable for them at the default step."""

import pytest

from parsim.case import parse
from parsim.comm import Comm
from parsim.solver import Simulation

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
