"""The time step: what bounds it, and what a run that goes wrong is told."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from flows import fluid, merged, simulation, tank

from parsim.case.estimate import time_step
from parsim.case.model import parse
from parsim.fluid.wcmps.scheme import WCMPS
from parsim.fluid.weights import WEIGHTS
from parsim.run import guards

OIL = tank(0.3, 0.2, 0.01, (0.1, 0.1))


def energy(s):
    """Kinetic and potential energy of the water, J/m."""
    p, at = fluid(s)
    return s.scheme.mass * float((0.5 * (p.u[at] ** 2 + p.w[at] ** 2) + 9.81 * p.z[at]).sum())


@pytest.mark.parametrize("viscosity", [0.1, 1.0, 10.0])
def test_a_column_of_oil_creeps(viscosity):
    """Lubrication has it that the foot of a column moves by g H^2 / 3 nu at most, once its inertia is gone."""
    s = simulation(OIL, water={"viscosity": viscosity})
    start, fastest = energy(s), 0.0
    for _ in range(150):
        s.step()
        fastest = max(fastest, s.speed)
    assert s.dt == pytest.approx(s.scheme.time_step(s.speed)) and s.dt < 0.2 * 0.01**2 / viscosity
    assert fastest < 9.81 * 0.1**2 / viscosity and energy(s) < 1.0001 * start, "what was elastic may come back"


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("support", [2.1, 3.1, 4.0])
@pytest.mark.parametrize("weight", list(WEIGHTS))
def test_nothing_changes_faster_than_the_step_knows(dimensions, support, weight):
    """The largest rate at which viscosity changes any wave on the lattice, from the wave's own sum."""
    across = None if dimensions == 2 else 0.1
    scheme = WCMPS(
        parse(tank(0.1, 0.1, 0.01, None, across, weight=weight, support=support, viscosity=5.0, noise_damping=0.0))
    )
    reach = range(-4, 5)
    grid = (
        np.array(
            [(i, k) for i in reach for k in reach if (i, k) != (0, 0)]
            if dimensions == 2
            else [(i, j, k) for i in reach for j in reach for k in reach if (i, j, k) != (0, 0, 0)]
        )
        * 0.01
    )
    r = np.linalg.norm(grid, axis=1)
    lattice = {round(d / 0.01, 6): w / d**2 for w, _, d, _ in scheme.lattice.points()}
    slope = np.array([lattice.get(round(d / 0.01, 6), 0.0) for d in r])
    fastest = 0.0
    for wave in np.ndindex(*[5] * dimensions):
        share = slope * (1.0 - np.cos(grid @ (np.array(wave) * math.pi / 0.04))) / r**2
        rates = np.linalg.eigvalsh(np.einsum("n,ni,nj->ij", share, grid, grid))
        fastest = max(fastest, 5.0 * 2.0 * dimensions * (dimensions + 2) / scheme.lattice.number * rates.max())
    assert 0.3 / fastest < scheme.time_step(0.0) <= 1.0 / fastest


@pytest.mark.parametrize("weight", list(WEIGHTS))
def test_the_strongest_noise_damping_is_stable(weight):
    s = simulation(OIL, water={"scheme": {"noise_damping": 0.005, "support": 2.6, "weight": weight}})
    start = energy(s)
    for _ in range(200):
        s.step()
    assert energy(s) < 1.001 * start


def test_gravity_bodies_and_gates_bound_the_step():
    scheme = WCMPS(parse(OIL))
    assert scheme.time_step(0.0, 1e6) == pytest.approx(math.sqrt(2.0 * 0.01 / 1e6))
    assert scheme.time_step(0.0, 10.0) == scheme.time_step(0.0)
    gate = merged(OIL, {"gate": {"min_x": 0.1, "max_x": 0.11, "speed": 3.0, "opens": 0.005}})
    s = simulation(gate)
    while s.time < 0.006:
        s.step()
        if s.time + s.dt > 0.005:
            assert s.speed >= 3.0, "known before the step in which it rises"


def test_the_estimate_knows_the_viscous_limit():
    oil = parse(merged(OIL, {"water": {"viscosity": 1.0}}))
    assert time_step(oil) == WCMPS(oil).time_step(oil.speed) < 1e-4 < time_step(parse(OIL))


def doomed(step=100, speed=0.5, cfl=1.0, force=0.0):
    """What the words about a failed run look at: a body of 1 kg in water that is expected to reach 1 m/s."""
    load = np.array([[force, 0.0, 0.0, 0.0, 0.0, 0.0]])
    case = SimpleNamespace(speed=1.0, run=SimpleNamespace(cfl=cfl), contacts=SimpleNamespace(steps_per_contact=20))
    return SimpleNamespace(
        step_count=step,
        speed=speed,
        case=case,
        scheme=SimpleNamespace(sound=10.0),
        dt=1e-3,
        bodies=SimpleNamespace(contact_load=load, mass=np.ones(1), names=["floe"]),
    )


@pytest.mark.parametrize(("signs", "first"), [
    ({}, "Most likely water.speed = 1 m/s is less than the water or a body reaches; or what is there"),
    ({"step": 3}, "Most likely what is there at the start is too close"),
    ({"speed": 1.5}, "Most likely water.speed = 1 m/s is less than the water or a body reaches: 1.5 m/s in"),
    ({"cfl": 1.5}, "Most likely run.cfl = 1.5 is too large. Else"),
    ({"force": 2e3}, "Most likely body floe is in a contact of 2000 N: contacts.steps_per_contact = 20 is too few"),
])  # fmt: skip
def test_the_likeliest_cause_is_named_first(signs, first):
    text = guards._likely(doomed(**signs))
    assert text.startswith(first) and text.count("water.speed =") == 1 and text.count("run.cfl =") == 1
