"""The water as a whole: at rest, in a periodic box, at a body, at the start, through a gate."""

import math

import numpy as np
import pytest
from clouds import outside_box
from contact_cases import boxes

from parsim.case.model import parse
from parsim.domain.comm import Comm
from parsim.fluid.wcmps.energy import elastic
from parsim.geometry.nearby import near_points
from parsim.geometry.rotation import from_angles, matrices
from parsim.observe.energy import energies
from parsim.particles.lattice import Lattice
from parsim.particles.state import GATE_DOWN, GATE_UP
from parsim.particles.tables import Kinematics, Vectors
from parsim.run.fill import taken_by_bodies, water
from parsim.run.near_bodies import Bodies, away
from parsim.run.simulation import Simulation
from parsim.solid.bodies import from_case
from parsim.solid.shapes.forms import forms_of

TANK = {
    "dimensions": 2,
    "spacing": 0.01,
    "box": {"max": [0.2, 1.0, 0.2]},
    "run": {"until": 1.0},
    "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.1]}]},
    "materials": {"wood": {"young": 1e9, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}},
}
SQUARE = {
    "name": "square",
    "shape": {"size": [0.06, 1.0, 0.06]},
    "density": 1000.0,
    "material": "wood",
    "position": [0.2, 0.5, 0.15],
}
POOL = TANK | {"box": {"max": [0.4, 1.0, 0.4]}, "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.4, 1.0, 0.3]}]}}
PERIODIC = {
    "box": {"max": [0.2, 1.0, 0.2], "faces": {f"{a}_{s}": "periodic" for a in "xz" for s in ("min", "max")}},
    "gravity": [0.0, 0.0, 0.0],
}


def simulation(data):
    """A case as a nested dict, ready to step on one rank."""
    case = parse(data)
    return Simulation(case, Comm(case.box.faces.x_min.repeats))


def bottom(s):
    """Mean pressure of the lowest row over its hydrostatic value."""
    p, at = s.domain.particles, s.near.fluid
    low = at[p.z[at] < s.case.spacing]
    return (p.p[low] / (9810.0 * (0.1 - p.z[low]))).mean()


@pytest.mark.parametrize("rows", [3, *(pytest.param(rows, marks=pytest.mark.long) for rows in (5, 7))])
def test_thin_water_at_rest_keeps_its_level(rows):
    level = 0.01 * rows
    s = simulation(TANK | {"water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, level]}]}})
    while s.time < 4.0:
        s.step()
    p, at = s.domain.particles, s.near.fluid
    assert 2 * p.z[at].mean() / level == pytest.approx(1.0, abs=0.02)


def test_water_at_rest_stays_at_rest():
    s = simulation(TANK)
    pressures, speeds = [], []
    while s.time < 1.0:
        s.step()
        pressures.append(bottom(s))
        speeds.append(s.speed)
    p, at = s.domain.particles, s.near.fluid
    assert np.mean(pressures[200:]) == pytest.approx(1.0, abs=0.02)
    assert np.std(pressures[-500:]) < 0.01
    assert 2 * p.z[at].mean() == pytest.approx(0.1, rel=0.01)
    assert max(speeds) < 0.08 * s.case.speed
    assert at.size == 200 and s.domain.lost == 0


def test_settled_water_does_not_jump_at_the_start():
    s = simulation(TANK)
    s.step()
    p, at = s.domain.particles, s.near.fluid
    acceleration = np.hypot(p.u[at], p.w[at]) / s.dt
    inner = p.surface[at] < 2
    assert acceleration[inner].max() < 0.15 * 9.81, "a particle of unbalanced water would fall with g"
    assert bottom(s) == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("shifting", [True, False])
def test_momentum_stays_in_a_periodic_box(shifting):
    fill = [{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.2], "velocity": [0.3, 0.0, -0.2]}]
    s = simulation(TANK | PERIODIC | {"water": {"fill": fill, "speed": 1.0, "scheme": {"shifting": shifting}}})
    p, rng = s.domain.particles, np.random.default_rng(2)
    kick = rng.normal(scale=0.2, size=(2, s.near.fluid.size))
    p.u[s.near.fluid] += kick[0]
    p.w[s.near.fluid] += kick[1]
    s.domain.refresh("u", "w")
    before = [math.fsum(f[s.near.fluid]) for f in (p.u, p.w)]
    for _ in range(300):
        s.step()
    p = s.domain.particles
    after = [math.fsum(f[s.near.fluid]) for f in (p.u, p.w)]
    assert s.rebuilds > 20 and s.near.fluid.size == 400
    assert after == pytest.approx(before, abs=1e-11)
    assert not np.allclose(p.u[s.near.fluid], p.u[s.near.fluid][0])


def test_the_elastic_energy_is_the_work_of_the_pressure():
    n0, sound2, mass = 20.0, 900.0, 1.7
    s = np.array([0.97, 0.999, 1.0, 1.003, 1.02])
    out = np.zeros(5)
    elastic(np.arange(5), n0 * s, mass, n0, sound2, out)
    for energy, end in zip(out, s, strict=True):
        middles = 1.0 + (end - 1.0) * (np.arange(2000) + 0.5) / 2000
        work = (sound2 / 7.0 * (middles**7 - 1.0) / middles).mean() * (end - 1.0)  # p / (rho0 s) over s
        assert energy == pytest.approx(mass * work, rel=1e-6, abs=1e-12)


def test_energies_of_water_that_moves_at_a_height():
    zero, out = np.zeros(2), np.zeros((2, 3))
    flow = Kinematics(Vectors(zero, zero, zero + 2.0), Vectors(zero + 3.0, zero, zero))
    energies(np.arange(2), flow, 1.7, (0.0, 0.0, -9.81), out)
    assert out[1, :2] == pytest.approx([4.5 * 1.7, 19.62 * 1.7])


def test_the_budget_counts_the_work_of_the_gate_on_the_water():
    """A plate that stands in water with its edge off the floor is lifted by the pressure under that edge."""
    thick, speed, until = 0.04, 0.05, 0.2
    s = simulation(TANK | {"box": {"max": [0.4, 1.0, 0.3]}, "run": {"until": 1.0, "settle": 1.0},
                           "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.4, 1.0, 0.2]}]},
                           "gate": {"min_x": 0.18, "max_x": 0.18 + thick, "bottom": 0.1, "speed": speed}})  # fmt: skip
    while s.time < 0.0:
        s.step()
    p, at = s.domain.particles, s.near.fluid
    level = p.z[at].max() + 0.005
    while s.time < until:
        s.step()
    lifted = 9810.0 * (level - 0.1 - 0.5 * speed * until) * thick * speed * until
    assert s.contacts.driven_work == pytest.approx(-lifted, rel=0.15)


def decay_error(spacing, across):
    """Relative error of the decay of u = sin(k x) along one of two directions that average a square lattice out."""
    fill = [{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.2]}]
    s = simulation(TANK | PERIODIC | {"spacing": spacing, "water": {"fill": fill, "speed": 0.1, "viscosity": 2e-3}})
    k = 2 * math.pi / 0.2 * np.array([across, 1.0])
    along = np.array([1.0, -across]) / math.hypot(1.0, across)
    p = s.domain.particles
    wave = np.sin(k[0] * p.x + k[1] * p.z)
    p.u[:], p.w[:] = 0.001 * along[0] * wave, 0.001 * along[1] * wave
    while s.time < 0.1:
        s.step()
    p, at = s.domain.particles, s.near.fluid
    wave = np.sin(k[0] * p.x[at] + k[1] * p.z[at])
    amplitude = 2 * ((p.u[at] * along[0] + p.w[at] * along[1]) * wave).mean() / 0.001
    return math.log(amplitude) / (-2e-3 * (k**2).sum() * s.time) - 1


def test_shear_waves_decay_by_their_viscosity():
    """Exact: exp(-nu k^2 t). A lattice is stiffer along its diagonal by as much as it is softer along its axes."""
    coarse, fine = ([decay_error(spacing, across) for across in (0.0, 1.0)] for spacing in (0.02, 0.01))
    means = [abs(sum(errors) / 2) for errors in (coarse, fine)]
    assert means[1] < 0.03 and means[0] / means[1] > 3, (coarse, fine)


def test_a_body_in_water_at_rest_is_carried_by_what_it_displaces():
    s = simulation(POOL | {"bodies": [SQUARE]})
    loads = []
    for _ in range(200):
        s.step()
        loads.append(s.bodies.water_load[0].copy())
    mean = np.mean(loads, axis=0)
    weight = 1000.0 * 0.06**2 * 9.81
    assert mean[2] == pytest.approx(weight, rel=0.03)
    assert abs(mean[0]) < 0.02 * weight and abs(mean[4]) < 0.02 * weight * 0.03


def test_the_samples_of_a_body_carry_its_volume():
    s = simulation(POOL | {"bodies": [SQUARE | {"shape": {"size": [0.064, 1.0, 0.057]}, "angles": [0.0, 30.0, 0.0]}]})
    samples = s.solids.samples
    assert samples.scale.sum() * s.scheme.lattice.volume == pytest.approx(0.064 * 0.057, rel=1e-12)
    p = s.domain.particles
    at = np.flatnonzero(p.body == 0)
    distance = np.hypot(p.x[at] - 0.2, p.z[at] - 0.15)
    assert distance.max() < 0.5 * math.hypot(0.064, 0.057)


def turned_boxes(centre, turn, half):
    """Boxes as `run.near_bodies` has them."""
    return Bodies(centre, turn.reshape(-1, 9), forms_of(boxes(*half), False))


def test_how_far_a_box_is_away():
    box = turned_boxes(np.zeros((1, 3)), np.eye(3), [(1.0, 2.0, 3.0)])
    points = [(2.0, 0.0, 0.0), (0.5, 0.0, 0.0), (2.0, 3.0, 0.0), (0.0, 0.0, -1.5)]
    assert [away(p, 0, box)[0] for p in points] == pytest.approx([1.0, -0.5, math.sqrt(2), -1.0])
    assert away(points[2], 0, box)[1] == pytest.approx((math.sqrt(0.5), math.sqrt(0.5), 0.0))


def test_how_far_turned_boxes_are_away_against_a_plain_version():
    rng = np.random.default_rng(5)
    turn = matrices(np.array([from_angles(rng.uniform(-90.0, 90.0, 3)) for _ in range(20)]))
    box = turned_boxes(rng.uniform(-1.0, 1.0, (20, 3)), turn, rng.uniform(0.1, 0.5, (20, 3)))
    points = rng.uniform(-1.5, 1.5, (50, 3))
    for b in range(20):
        distance, direction = outside_box(points, box.position[b], turn[b], box.forms.half[b], (0, 1, 2))
        found = [away(tuple(p), b, box) for p in points]
        assert [d for d, _ in found] == pytest.approx(distance, abs=1e-12)
        out = distance > 0.0
        assert np.array([way for _, way in found])[out] == pytest.approx(direction[out], abs=1e-12)


@pytest.mark.parametrize("axes", [(0, 2), (0, 1, 2)])
def test_every_body_within_reach_of_a_point_is_found(axes):
    rng = np.random.default_rng(6)
    points, place, reach = rng.uniform(-1.0, 1.0, (300, 3)), rng.uniform(-1.0, 1.0, (40, 3)), rng.uniform(0.1, 0.4, 40)
    first, near = near_points(points, place, reach, np.isin(range(3), axes))
    apart = np.sqrt(((points[:, None] - place)[:, :, axes] ** 2).sum(2))
    for k in range(300):
        assert sorted(near[first[k] : first[k + 1]]) == list(np.flatnonzero(apart[k] < reach))


@pytest.mark.parametrize("height", [0.15, 0.153, 0.1567])
def test_the_fill_leaves_out_the_volume_of_the_bodies_wherever_they_are(height):
    case = parse(POOL | {"bodies": [SQUARE | {"position": [0.2034, 0.5, height]}]})
    points = Lattice((0.0, 0.0, 0.0), (0.4, 1.0, 0.3), 0.01, (0, 2))
    gone = points.points(taken_by_bodies([points], case, from_case(case), Comm()))
    assert len(gone) == pytest.approx(36, abs=1)
    assert np.abs(gone - [0.2034, 0.5, height]).max() < 0.04


def test_gaps_narrower_than_the_spacing_hold_no_water():
    blocks = [SQUARE | {"name": f"b{k}", "position": [x, 0.5, 0.15]} for k, x in enumerate((0.1, 0.164))]
    case = parse(POOL | {"bodies": blocks})
    s = simulation(POOL | {"bodies": blocks})
    fluid = water(case, s.bodies, s.scheme, Comm())
    assert not ((np.abs(fluid.x - 0.132) < 0.002) & (np.abs(fluid.z - 0.15) < 0.025)).any()
    expected = 40 * 30 - (2 * 36 + 0.4 * 6)
    assert len(fluid) == pytest.approx(expected, abs=1.5)


def test_slabs_start_with_the_parts_of_one_water():
    blocks = [SQUARE | {"name": f"b{k}", "position": [x, 0.5, 0.15]} for k, x in enumerate((0.1, 0.164))]
    s = simulation(POOL | {"bodies": blocks})
    whole = water(s.case, s.bodies, s.scheme, Comm())
    parts = [
        water(s.case, s.bodies, s.scheme, Comm(), lambda x, side=side: (x < 0.113) == side) for side in (True, False)
    ]
    for name in ("id", "x", "z", "n"):
        assert np.concatenate([getattr(part, name) for part in parts]).tolist() == getattr(whole, name).tolist()


def gated(opens):
    fill = [{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.2]}, {"min": [0.21, 0.0, 0.0], "max": [0.4, 1.0, 0.05]}]
    return simulation(
        POOL | {"water": {"fill": fill}, "gate": {"min_x": 0.2, "max_x": 0.21, "speed": 1.0, "opens": opens}}
    )


def test_the_waters_beside_a_closed_gate_never_meet():
    s = gated(opens=10.0)
    for _ in range(150):
        s.step()
        p, near = s.domain.particles, s.near
        for i in near.fluid:
            side = p.x[i] < 0.205
            row = near.index[near.start[i] : near.end[i]].astype(int)
            fluid = row[: near.middle[i] - near.start[i]]
            assert ((p.x[fluid] < 0.205) == side).all()
            assert not (p.kind[row] == (GATE_DOWN if side else GATE_UP)).any()
    low = near.fluid[(p.z[near.fluid] < 0.01) & (p.x[near.fluid] > 0.22)]
    assert p.p[low].mean() == pytest.approx(9810 * 0.045, rel=0.05), "the shallow side feels nothing of the deep one"


@pytest.mark.parametrize("high", [0.12, 0.1225, 0.125, 0.1275])
def test_no_water_leaves_beside_a_gate_off_the_lattice(high):
    """A plate thinner than the spacing: each side's floor and sides go on behind it without a hole."""
    fill = [
        {"min": [0.0, 0.0, 0.0], "max": [high - 0.005, 0.06, 0.1]},
        {"min": [high, 0.0, 0.0], "max": [0.24, 0.06, 0.04]},
    ]
    s = simulation(
        TANK
        | {
            "dimensions": 3,
            "box": {"max": [0.24, 0.06, 0.2]},
            "water": {"fill": fill},
            "gate": {"min_x": high - 0.005, "max_x": high, "speed": 1.0, "opens": 10.0},
        }
    )
    while s.time < 0.15:
        s.step()
    p, at = s.domain.particles, s.near.fluid
    assert p.z[at].min() > 0.0025 and p.y[at].min() > 0.0025 and p.y[at].max() < 0.0575
    assert np.hypot(p.u[at], np.hypot(p.v[at], p.w[at])).max() < 0.1


def test_water_passes_under_a_gate_that_has_risen_and_not_through_it():
    s = gated(opens=0.0)
    while s.time < 0.1:
        s.step()
    p, at = s.domain.particles, s.near.fluid
    inside = (p.x[at] > 0.2025) & (p.x[at] < 0.2075) & (p.z[at] > s.gate.bottom(s.time) + 0.0025)
    assert not inside.any()
    assert (p.x[at] > 0.21).sum() >= 19 * 5 + 12, "water has come through below the edge"
