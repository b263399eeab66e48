"""Nothing knows a length: with all lengths times a power of four every bit is as before, times the power of its unit.

Of two it would not be, for masses then are no squares and solving for accelerations takes roots.
"""

import numpy as np
import pytest
from flows import tank

from parsim.case.model import parse
from parsim.domain.comm import Comm
from parsim.run.simulation import Simulation

WOOD = {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}


def pool(factor, across):
    """A case of water that falls on two blocks, one afloat and one beside it, of lengths times `factor`."""
    length, width = 0.24 * factor, 0.06 * factor
    case = tank(
        length,
        0.2 * factor,
        0.01 * factor,
        (0.5 * length, 0.08 * factor),
        width if across else None,
        viscosity=1e-6 * factor * factor,
        speed=2.0 * factor,
    )
    side = 0.5 * width if across else 0.5
    size = [0.04 * factor, 0.04 * factor if across else 1.0, 0.02 * factor]
    places = [[0.05 * factor, side, 0.08 * factor], [0.16 * factor, side, 0.011 * factor]]
    bodies = [
        {"name": f"b{k}", "shape": {"size": size}, "density": 700.0, "material": "wood", "position": place}
        for k, place in enumerate(places)
    ]
    return case | {
        "gravity": [0.0, 0.0, -9.81 * factor],
        "bodies": bodies,
        "materials": {"wood": WOOD | {"young": WOOD["young"] * factor * factor}},
    }


@pytest.mark.parametrize("across", [True, False])
def test_lengths_times_a_power_of_four_give_the_same_bits(across):
    found = {}
    for factor in (1.0, 2.0**-8, 2.0**4):
        s = Simulation(parse(pool(factor, across)), Comm())
        for _ in range(60):
            s.step()
        p, at = s.domain.particles, s.near.fluid
        places = s.bodies.position[:, s.case.axes]
        lengths = [p.x[at], p.z[at], p.u[at], p.w[at], places, s.bodies.velocity]
        found[factor] = [s.time, *(values / factor for values in lengths), p.n[at], s.bodies.quaternion, s.bodies.spin]
    for factor, values in found.items():
        assert all(np.array_equal(one, two) for one, two in zip(found[1.0], values, strict=True)), factor
