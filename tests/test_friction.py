"""Friction of water at walls and bodies, and its eddies: the laws, action and reaction, flows whose course is known."""

import math

import numpy as np
import pytest
from flows import GRAVITY, WOOD, fluid, simulation, tank

from parsim.case.model import parse
from parsim.errors import InputError
from parsim.fluid.friction import logarithm, stress_over_density

DEPTH, SLOPE, ROUGH = 0.2, 0.002, 0.02
SHEAR = math.sqrt(GRAVITY * DEPTH * SLOPE)  # u*, m/s


def test_the_logarithm_is_one():
    x = np.logspace(-9, 9, 500)
    assert [logarithm(v) for v in x] == pytest.approx(np.log(x), abs=1e-10)


@pytest.mark.parametrize("distance", [0.005, 0.1])
def test_the_stress_follows_the_laws_of_the_wall(distance):
    log = math.log(distance)
    rough = stress_over_density(0.7, distance, log, 0.004, 1e-6)
    assert rough == pytest.approx((0.41 * 0.7 / math.log(30.0 * distance / 0.004)) ** 2, rel=1e-9)
    shear = math.sqrt(stress_over_density(0.7, distance, log, 0.0, 1e-6))
    assert shear * 8.3 * (distance * shear / 1e-6) ** (1 / 7) == pytest.approx(0.7, rel=1e-9), "Werner & Wengle"
    viscous = stress_over_density(1e-4, distance, log, 0.0, 1e-4)
    assert viscous == pytest.approx(1e-4 * 1e-4 / distance, rel=1e-9)
    assert stress_over_density(0.0, distance, log, 0.004, 1e-6) == 0.0


@pytest.mark.parametrize("kind", ["wall_law", "no_slip"])
def test_what_a_body_gives_to_the_water_the_water_gives_to_it(kind):
    """A plate that moves in a periodic box without gravity: momentum of both stays to the last bits."""
    body = {
        "name": "plate", "shape": {"size": [0.08, 1.0, 0.03]}, "density": 800.0, "material": "wood",
        "position": [0.2, 0.5, 0.2], "velocity": [0.4, 0.0, 0.1], "spin": [0.0, 1.0, 0.0],
    }  # fmt: skip
    water = {"speed": 2.0, "friction": {"kind": kind}, "eddies": {"kind": "smagorinsky"}, "viscosity": 1e-3}
    given = tank(0.4, 0.4, 0.01, periodic="xz", **water) | {"materials": WOOD, "bodies": [body]}
    s = simulation(given, gravity=[0.0, 0.0, 0.0])

    def momentum():
        p, at = fluid(s)
        water = s.scheme.mass * np.array([math.fsum(p.u[at]), math.fsum(p.w[at])])
        return water + s.bodies.mass[0] * s.bodies.velocity[0, ::2]

    s.step()  # in which water that begins inside is turned out of the plate
    before = momentum()
    for _ in range(40):
        s.step()
    assert momentum() == pytest.approx(before, abs=1e-10)
    free = simulation(given, gravity=[0.0, 0.0, 0.0], water={"friction": None})
    for _ in range(41):
        free.step()
    assert s.bodies.velocity[0, 0] < free.bodies.velocity[0, 0] - 1e-4, "it rubs"


@pytest.mark.parametrize(("water", "text"), [
    ({"friction": {"kind": "no_slip", "roughness": 0.001}}, "without slip walls are smooth"),
    ({"friction": {"kind": "wall_law", "walls": ["z_max"]}}, 'water.friction.walls = "z_max": is no wall; allowed'),
    ({"friction": {"kind": "wal_law"}}, "water.friction.kind = 'wal_law': must be 'wall_law' or 'no_slip'"),
    ({"friction": {"kind": "no_slip"}, "viscosity": 0.0}, "water.viscosity = 0.0: must be more than 0"),
    ({"eddies": {"kind": "smagorinsky", "constant": 0.0}}, "water.eddies.constant"),
])  # fmt: skip
def test_what_can_not_be_is_refused(water, text):
    given = tank(0.2, 0.2, 0.01)
    with pytest.raises(InputError) as error:
        parse(given | {"water": given["water"] | water})
    assert text in str(error.value)


def test_a_mixing_length_wants_a_wall():
    given = tank(0.2, 0.2, 0.01, periodic="xz", eddies={"kind": "mixing_length"})
    with pytest.raises(InputError, match="there is no wall to be at a distance from"):
        parse(given)


def test_roughness_of_a_material_wants_friction_and_too_much_is_doubted():
    given, rough = tank(0.2, 0.2, 0.01), {"wood": WOOD["wood"] | {"roughness": 0.3}}
    with pytest.raises(InputError, match=r"materials\.wood\.roughness: nothing rubs the water"):
        parse(given | {"materials": rough})
    given["water"]["friction"] = {"kind": "wall_law"}
    assert any(
        "materials.wood.roughness = 0.3: more than 0.166 m" in text
        for text in parse(given | {"materials": rough}).warnings()
    )


def channel(rows):
    """Uniform flow in a periodic channel over a rough bed (case R1), begun with the exact profile."""
    water = {"friction": {"kind": "wall_law", "roughness": ROUGH}, "eddies": {"kind": "mixing_length"}, "speed": 2.0}
    water |= {"disorder": 0.2, "recovery": 0.5}
    given = tank(4 * DEPTH, 1.5 * DEPTH, DEPTH / rows, fill=(4 * DEPTH, DEPTH), periodic="x", **water)
    mean = SHEAR / 0.41 * (math.log(30.0 * DEPTH / ROUGH) - 1.0)
    given["water"]["fill"][0] |= {"velocity": [mean, 0.0, 0.0], "profile": {"kind": "log", "roughness": ROUGH}}
    return simulation(given, gravity=[GRAVITY * SLOPE, 0.0, -GRAVITY], run={"settle": 0.5}), mean


@pytest.mark.parametrize("rows", [
    pytest.param(10, marks=pytest.mark.long), pytest.param(20, marks=pytest.mark.slow),  # which validate runs too
])  # fmt: skip
def test_a_channel_keeps_its_uniform_flow(rows):
    """River case R1: mean within 1 %, profile within 2 % of it, momentum in balance within 0.5 %, depth 0.1 / rows."""
    s, mean = channel(rows)
    mass, bed, gained, seen, steps = s.scheme.mass, 0.0, 0.0, np.zeros(rows), 0
    p, at = fluid(s)
    begun = mass * p.u[at].sum()
    while s.time < 4.0:
        s.step()
        p, at = fluid(s)
        bed += s.dt * s.solids.friction.stress[:, 0].sum()
        gained += s.dt * mass * at.size * GRAVITY * SLOPE
        if s.time > 2.0:
            row = np.clip((p.z[at] * rows / DEPTH).astype(int), 0, rows - 1)
            seen += np.bincount(row, p.u[at], rows) / np.bincount(row, minlength=rows)
            steps += 1
    exact = SHEAR / 0.41 * np.log(30.0 * (np.arange(rows) + 0.5) * DEPTH / rows / ROUGH)
    off = np.abs(seen / steps - exact)[1:] / mean
    print(f"H/{rows}: V {p.u[at].mean() / mean:.4f}, profile {off.max():.4f}, depth {2 * p.z[at].mean() / DEPTH:.4f}")
    assert p.u[at].mean() == pytest.approx(mean, rel=0.01)
    assert off.max() < 0.02
    assert mass * p.u[at].sum() - begun == pytest.approx(gained - bed, abs=0.005 * gained)
    assert 2.0 * p.z[at].mean() == pytest.approx(DEPTH, rel=0.1 / rows), "the rows at bed and surface"


@pytest.mark.long
@pytest.mark.parametrize("rows", [10, 20])
def test_laminar_flow_between_walls_is_that_of_poiseuille(rows):
    """River case R0 d, Re 10: within 2 % of the exact profile."""
    height, mean = 0.1, 0.1
    viscosity = mean * height / 10.0
    given = tank(0.4 * height if rows > 10 else 2.0 * height, height, height / rows, periodic="x", speed=0.5,
                 friction={"kind": "no_slip"}, viscosity=viscosity, disorder=0.2, pressure="zero")  # fmt: skip
    given["box"]["faces"]["z_max"] = "wall"
    given["water"]["fill"][0]["velocity"] = [mean, 0.0, 0.0]
    s = simulation(given, gravity=[12.0 * viscosity * mean / height**2, 0.0, 0.0])
    while s.time < 5.0:
        s.step()
    p, at = fluid(s)
    off = p.u[at] - 6.0 * mean * p.z[at] / height * (1.0 - p.z[at] / height)
    print(f"H/{rows}: {np.sqrt((off**2).mean()) / mean:.4f}, at most {np.abs(off).max() / mean:.4f}")
    assert math.sqrt((off**2).mean()) < 0.02 * mean
