"""Ordinary small cases with bodies: they start, keep to what their weight allows, and come to rest where they should.

The long ones are of `pytest -m validate -s`; test_light_bodies, test_step, test_fill and test_open_sides have others.
"""

import numpy as np
import pytest
from flows import course, simulation, tank
from test_validate import told

from parsim.observe.observers import rows_now

GRAVITY = 9.81
SOLID = {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}


def block(size, density, x, z, name="a", **body):
    """A body, 2D, of `size` (along x, along z), m."""
    return {
        "name": name,
        "shape": {"size": [size[0], 1.0, size[1]]},
        "density": density,
        "material": "m",
        "position": [x, 0.5, z],
        **body,
    }


def basin(length, height, spacing, bodies, fill=None, settle=0.0, friction=0.4, **water):
    """A simulation of a 2D tank of water with bodies, past its settling."""
    case = tank(length, height, spacing, fill, **water)
    case["run"]["settle"] = settle
    return simulation(case | {"materials": {"m": SOLID | {"friction": friction}}, "bodies": bodies})


def energy(s):
    """Row of the energy series as a dict, J."""
    return {name: values[0] for name, values in rows_now(s.case, s)["energy"].items()}


@pytest.mark.parametrize(("spacing", "density"), [(0.02, 900.0), (0.005, 600.0), (0.01, 200.0), (0.01, 900.0)])
def test_a_floe_afloat_off_the_rows_of_water_stays_there(spacing, density):
    s = basin(0.4, 0.2, spacing, [block((0.08, 0.04), density, 0.2, "float")], fill=(0.4, 0.1))
    times, places, _ = course(s, 0.15)
    assert np.abs(places[:, 2] - places[0, 2]).max() < 0.25 * spacing


def test_a_long_floe_floats_level():
    s = basin(3.6, 0.6, 0.02, [block((2.8, 0.04), 917.0, 1.8, "float")], fill=(3.6, 0.4))
    _, places, tilts = course(s, 0.3)
    assert 0.4 - (places[-1, 2] - 0.02) == pytest.approx(0.0367, abs=0.005)
    assert np.abs(tilts).max() < 0.2


def test_two_hundred_boxes_float_on_shallow_water():
    row = [block((0.05, 0.02), 900.0, 0.05 + 0.06 * k, "float", name=f"b{k}") for k in range(200)]
    s = basin(12.04, 0.2, 0.01, row, fill=(12.04, 0.05))
    course(s, 0.1)
    draught = 0.05 - (s.bodies.position[:, 2] - 0.01)
    assert np.abs(draught - 0.018).max() < 0.0025


@pytest.mark.validate
def test_a_body_as_light_as_foam_floats_at_its_draught():
    s = basin(1.0, 0.6, 0.02, [block((0.2, 0.2), 5.0, 0.5, "float")], fill=(1.0, 0.3))
    times, places, _ = course(s, 3.0)
    off = places[times > 2.0, 2].mean() - (0.3 + 0.1 - 0.001)
    told(off_mm=1e3 * off)
    assert abs(off) < 0.005


@pytest.mark.validate
def test_a_body_heavier_than_water_stays_on_the_bed():
    s = basin(0.6, 0.4, 0.01, [block((0.1, 0.06), 1050.0, 0.3, 0.03)], fill=(0.6, 0.3), settle=1.0)
    highest, lifts = 0.0, []
    while s.time < 3.0:
        s.step()
        highest = max(highest, s.bodies.position[0, 2])
        lifts.append((s.time, s.bodies.water_load[0, 2], s.bodies.contact_load[0, 2]))
    time, lift, contact = np.array(lifts).T
    told(lift=lift[time > 1.0].mean() / (9810.0 * 0.006), contact=contact[time > 1.0].mean(), rise=highest - 0.03)
    assert lift[time > 1.0].mean() == pytest.approx(9810.0 * 0.006, rel=0.01)
    assert contact[time > 1.0].mean() == pytest.approx(0.05 * 9810.0 * 0.006, rel=0.1)
    assert highest < 0.0305


@pytest.mark.validate
def test_a_block_slides_down_a_slope_under_water():
    """The gravity of 30 degrees; (g sin - mu N) / (m + added mass) at the start is 1.3 to 1.6 m/s2."""
    case = tank(1.6, 0.4, 0.02, speed=4.0)
    case["box"]["faces"] = {"z_max": "wall"}
    case |= {
        "gravity": [4.905, 0.0, -8.495709],
        "materials": {"m": SOLID | {"friction": 0.2}},
        "bodies": [block((0.2, 0.1), 2500.0, 0.3, 0.05, released=0.0)],
    }
    case["run"]["settle"] = 1.0
    times, places, _ = course(simulation(case), 1.0)
    early = np.interp(0.2, times, places[:, 0]) - 0.3
    last = np.polyfit(times[times > 0.9], places[times > 0.9, 0], 1)[0]
    told(start=2.0 * early / 0.2**2, speed_at_1_s=last)
    assert 1.2 < 2.0 * early / 0.2**2 < 1.7
    assert last > 0.8


@pytest.mark.validate
@pytest.mark.parametrize("spacing", [0.01, 0.005])
def test_plates_that_squeeze_water_create_no_energy(spacing):
    plates = [block((0.05, 0.2), 8000.0, x, 0.15, name=name, velocity=[speed, 0.0, 0.0])
              for name, x, speed in (("left", 0.35, 1.0), ("right", 0.65, -1.0))]  # fmt: skip
    s = basin(1.0, 0.5, spacing, plates, fill=(1.0, 0.3), speed=6.0)
    first, most, parts = energy(s)["total"], 0.0, []
    while s.time < 0.6:
        s.step()
        if s.step_count % 20 == 0:
            parts.append(energy(s)["total"] - first)
            most = max(most, parts[-1])
    told(spacing=spacing, first=first, created=most, share=most / first, at_end=parts[-1])
    assert most < 1e-3 * first


@pytest.mark.validate
def test_levels_become_equal_through_a_slot_of_two_spacings():
    case = tank(0.44, 0.4, 0.01) | {
        "materials": {"m": SOLID},
        "bodies": [block((0.04, 0.38), 1000.0, 0.22, 0.21, fixed=True)],
    }
    case["run"] |= {"settle": 0.0}
    case["water"]["fill"] = [
        {"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.3]},
        {"min": [0.2, 0.0, 0.0], "max": [0.44, 1.0, 0.1]},
    ]
    s = simulation(case)
    assert any("passage" in words for words in s.case.warnings())
    heights = []
    while s.time < 8.0:
        s.step()
        p, at = s.domain.particles, s.near.fluid
        left = p.x[at] < 0.22
        heights.append((s.time, 1e-4 * left.sum() / 0.2, 1e-4 * (~left).sum() / 0.2))
    time, one, two = np.array(heights).T
    late = time > 6.0
    told(gap_at_4_s=np.interp(4.0, time, one - two), mean_gap=(one - two)[late].mean())
    assert abs((one - two)[late].mean()) < 0.003
