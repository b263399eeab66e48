"""Bodies that cross periodic sides: what happens there is what happens in the middle of the box."""

import numpy as np
import pytest
from flows import WOOD, fluid, simulation, tank

from parsim.case.model import parse
from parsim.domain.grid import check_ranks
from parsim.errors import InputError

LENGTH, SPACING = 0.4, 0.01


def floes(across):
    """Two floes that drift downstream side by side with the water, one turned and one fast, which meet."""
    width, turned = (1.0, [0.0, 10.0, 0.0]) if across is None else (0.06, [5.0, 10.0, 20.0])
    middle = 0.5 if across is None else 0.5 * across
    shape = {"size": [0.08, width, 0.03]}
    return [
        {"name": "slow", "shape": shape, "density": 800.0, "material": "wood", "position": [0.22, middle, 0.108],
         "angles": turned, "velocity": [0.5, 0.0, 0.0]},
        {"name": "fast", "shape": shape, "density": 800.0, "material": "wood", "position": [0.125, middle, 0.102],
         "velocity": [1.0, 0.0, 0.0]},
    ]  # fmt: skip


def course(axis, shift, across, steps, periodic="x"):
    """Velocities and spins of the bodies after so many steps, all moved by `shift` along an axis."""
    given = tank(LENGTH, 0.2, SPACING, fill=(LENGTH, 0.1), across=across, periodic=periodic, speed=2.0,
                 friction={"kind": "wall_law"})  # fmt: skip
    given["water"]["fill"][0]["velocity"] = [0.5, 0.0, 0.0]
    s = simulation(given, materials=WOOD, bodies=floes(across), run={"settle": 0.0})
    p, at = fluid(s)
    size = LENGTH if axis == 0 else across
    place = (p.x, p.y)[axis]
    place[at] = (place[at] + shift) % size
    s.bodies.position[:, axis] += shift
    s._rebuild(s.fluid)
    out = []
    for _ in range(steps):
        s.step()
        out.append(np.hstack([s.bodies.velocity, s.bodies.spin, s.bodies.water_load, s.bodies.contact_load]))
    return np.array(out), s


@pytest.mark.parametrize(("axis", "shift", "across"), [(0, 0.2, None), (0, 0.16, 0.1), (1, 0.05, 0.1)])
def test_nothing_tells_a_periodic_side_from_the_middle(axis, shift, across):
    """To the rounding of places: the first steps have the same loads, over a side or not."""
    periodic = "x" if axis == 0 else "xy"
    base, _ = course(axis, 0.0, across, 12, periodic)
    moved, s = course(axis, shift, across, 12, periodic)
    reach = s.bodies.position[:, axis] + 0.04 * (1.0 if axis == 0 else 0.5)
    assert (reach > (LENGTH if axis == 0 else across)).any(), "one of them stands in the side"
    for at in (slice(0, 6), slice(6, 12), slice(12, 18)):
        assert moved[..., at] == pytest.approx(base[..., at], abs=1e-6 * np.abs(base[..., at]).max())


@pytest.mark.long
def test_floes_drift_around_a_channel():
    """Two rounds of the channel: they float on, at the speed of the water, and none holds water."""
    given = tank(LENGTH, 0.2, SPACING, fill=(LENGTH, 0.1), periodic="x", speed=2.0)
    given["water"]["fill"][0]["velocity"] = [0.5, 0.0, 0.0]
    bodies = [body | {"velocity": [0.5, 0.0, 0.0], "angles": [0.0] * 3} for body in floes(None)]
    bodies[1]["position"] = [0.08, 0.5, 0.1]
    s = simulation(given, materials=WOOD, bodies=bodies)
    while s.time < 1.8:
        s.step()
    (home,) = {len(s.solids.samples.home(*s.bodies.position.T)) // 2}
    assert home == 1 and (s.bodies.position[:, 0] > 2.0 * LENGTH).all()
    assert s.bodies.velocity[:, 0] == pytest.approx(0.5, abs=0.05)
    assert s.bodies.position[:, 2] == pytest.approx(0.1 + 0.015 - 0.03 * 0.8 + 0.006, abs=0.006)


@pytest.mark.parametrize("axis", "xy")
def test_sides_that_repeat_too_soon_are_refused(axis):
    """Each particle is seen once from either side: not twice, as it would have to be."""
    sizes = {"x": 0.4, "y": 0.4}
    for size, wrong in ((0.03, True), (0.04, False)):  # the lists reach over 0.035 m
        sizes[axis] = size
        case = parse(tank(sizes["x"], 0.2, SPACING, fill=(sizes["x"], 0.1), across=sizes["y"], periodic=axis))
        if not wrong:
            check_ranks(case, 1)
            continue
        with pytest.raises(InputError, match=rf"{axis} repeats after 0.03 m; must be 0.035 m or more"):
            check_ranks(case, 1)


def test_a_body_longer_than_the_period_is_refused():
    given = tank(0.4, 0.4, 0.02, periodic="x") | {"materials": WOOD}
    given["water"] = {}
    bar = {"name": "a", "shape": {"size": [0.5, 1.0, 0.04]}, "density": 500.0, "material": "wood",
           "position": [0.2, 0.5, 0.2]}  # fmt: skip
    with pytest.raises(InputError, match="reaches over 0.5 m along x, where the box repeats after 0.4 m; must be less"):
        parse(given | {"bodies": [bar]})
