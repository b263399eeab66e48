"""Sides of the box that move in their own plane: what the water feels, the work, and what is refused."""

import math

import numpy as np
import pytest
from flows import WOOD, fluid, simulation, tank

from parsim.case.model import parse
from parsim.errors import InputError
from parsim.observe.energy import Energy
from parsim.validate.exact_measures import couette

SPEED, HEIGHT = 0.1, 0.1
BLOCK = {"name": "a", "shape": {"size": [0.04, 1.0, 0.04]}, "density": 500.0, "position": [0.05, 0.5, 0.05],
         "material": "wood"}  # fmt: skip


def plates(side="z_max", velocity=(SPEED, 0.0, 0.0), rows=10, kind="no_slip", **changes):
    """Water without weight between two plates, of which one moves."""
    given = tank(0.1, HEIGHT, HEIGHT / rows, periodic="x", speed=0.5, friction={"kind": kind}, viscosity=1e-3,
                 disorder=0.2, pressure="zero")  # fmt: skip
    given["box"]["faces"] |= {"z_max": "wall", side: {"kind": "wall", "velocity": list(velocity)}}
    return given | {"gravity": [0.0, 0.0, 0.0]} | changes


def test_a_plate_takes_the_water_along_as_in_couette_flow():
    s = simulation(plates())
    start = Energy(s.case).rows(s)[0][-1]
    while s.time < 1.0:
        s.step()
    p, at = fluid(s)
    exact = SPEED * couette(p.z[at], np.full(at.size, s.time), HEIGHT, 1e-3)
    assert math.sqrt(np.mean((p.u[at] - exact) ** 2)) < 0.01 * SPEED
    stress = 1000.0 * 1e-3 * SPEED * 2.0 * math.sqrt(s.time / (math.pi * 1e-3)) * 0.1  # N s, of a half space
    assert s.contacts.driven_work == pytest.approx(SPEED * stress, rel=0.1)
    assert 0.0 < Energy(s.case).rows(s)[0][-1] - start < s.contacts.driven_work, "friction takes the rest"


def test_the_walls_of_a_case_that_stands_give_the_same_as_before():
    moved, still = simulation(plates(velocity=(0.0, 0.0, 0.0))), simulation(plates(side="z_min", velocity=(0.0,) * 3))
    for s in (moved, still):
        for _ in range(20):
            s.step()
    assert np.array_equal(moved.fluid.u, still.fluid.u) and moved.solids.sliding() is None


def test_a_wall_law_feels_it_too():
    s = simulation(plates(kind="wall_law"))
    for _ in range(20):
        s.step()
    p, at = fluid(s)
    top, low = p.z[at] > 0.08, p.z[at] < 0.02
    assert p.u[at][top].mean() > 10.0 * abs(p.u[at][low].mean()) > 0.0


def test_a_side_that_moves_is_written_back(tmp_path):
    case = parse(plates())
    assert "velocity = [0.1, 0.0, 0.0]" in case.to_toml() and 'z_min = "wall"' in case.to_toml()


@pytest.mark.parametrize(("changes", "said"), [
    ({"velocity": (0.1, 0.0, 0.2)}, "box.faces.z_max.velocity = [0.1, 0.0, 0.2]: z must be 0; a side moves in its"),
    ({"velocity": (0.1, 0.2, 0.0)}, "y must be 0 in a 2D case"),
    ({"velocity": (0.9, 0.0, 0.0)}, "is more than the largest expected speed, 0.5 m/s; give water.speed"),
    ({"materials": WOOD, "bodies": [BLOCK]}, "bodies.a: must be fixed; contacts do not feel that a side moves"),
])  # fmt: skip
def test_a_side_that_cannot_move_so_is_told(changes, said):
    with pytest.raises(InputError) as error:
        parse(plates(**changes))
    assert said in str(error.value)


def test_a_side_that_nothing_rubs_is_told():
    given = plates()
    rubs = given["water"]["friction"]
    for friction in (rubs | {"walls": ["z_min"]}, rubs | {"walls": []}, None):
        given["water"] = {k: v for k, v in given["water"].items() if k != "friction"}
        given["water"] |= {"friction": friction} if friction else {}
        with pytest.raises(InputError, match="nothing feels it; water.friction is missing, or this side is not in its"):
            parse(given)
    given["water"] = {}
    with pytest.raises(InputError, match="nothing feels it; water.friction is missing"):
        parse(given)
