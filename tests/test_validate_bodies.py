"""Bodies in water that shears, against Archimedes, added mass and drag: `pytest -m validate -s`."""

import math

import numpy as np
import pytest
from flows import course, simulation, square_in_tank
from test_validate import told

pytestmark = pytest.mark.validate

# side 0.1 m: relative density, tilt, degrees, height of the centre over the side: least potential energy
UPRIGHT = [(0.2, 0.0, 0.3), (0.25, 26.5651, 0.223607), (0.4, 45.0, 0.0746512), (0.6, 45.0, -0.0746512),
           (0.75, 26.5651, -0.223607), (0.9, 0.0, -0.4)]  # fmt: skip


@pytest.mark.parametrize("density, tilt, height", UPRIGHT)
def test_a_square_floats_as_archimedes_has_it(density, tilt, height):
    case = square_in_tank(0.1, 0.01, 1000.0 * density, 0.5 + 0.1 * height, 0.6, 0.5, angle=tilt + 5.0)
    times, places, tilts = course(simulation(case), 4.0)
    late = times > 2.5
    told(
        density=density,
        tilt=tilts[late].mean(),
        exact=tilt,
        swing=tilts[late].std(),
        centre_in_spacings=(places[late, 2].mean() - 0.5 - 0.1 * height) / 0.01,
    )
    assert abs(tilts[late].mean() - tilt) < 3.0
    assert abs(places[late, 2].mean() - 0.5 - 0.1 * height) < 0.0025


@pytest.mark.parametrize("spacing", [0.02, 0.01])
def test_a_square_released_above_its_level_swings(spacing):
    """Linear potential flow (boundary elements): T 0.84 to 0.87 s, damping ratio 0.104; viscous flow 0.857 s, 0.129."""
    case = square_in_tank(0.2, spacing, 500.0, 0.43, 6.0, 0.4)
    times, places, _ = course(simulation(case), 1.2)
    z = places[:, 2] - 0.4
    trough = np.argmin(z[times < 0.7])
    crest = trough + np.argmax(z[trough:])
    ratio = -z[trough] / 0.03
    log = -math.log(ratio)
    damping = log / math.hypot(log, math.pi)
    period = times[crest]
    told(spacing=spacing, period=period, trough=z[trough] * 1e3, crest=z[crest] * 1e3, damping_ratio=damping)
    assert abs(period / 0.857 - 1.0) < 0.06
    assert 0.10 < damping < 0.21


@pytest.mark.parametrize("density", [1500.0, 700.0])
def test_a_square_in_deep_water_moves_by_its_added_mass_and_drag(density):
    """z = vt^2 / a ln cosh(a t / vt): a by the added mass 1.188 rho side^2, vt by a drag coefficient of 2."""
    side, excess = 0.1, (density - 1000.0) / 1000.0
    start = abs(excess) * 9.81 / (density / 1000.0 + 1.18831)
    terminal2 = abs(excess) * 9.81 * side
    for spacing in (0.02, 0.01, 0.005):
        case = square_in_tank(side, spacing, density, 0.7 if excess > 0 else 0.3, 1.0, 1.0)
        case["water"]["speed"] = 2.0
        times, places, _ = course(simulation(case), 0.4)
        gone = np.abs(places[:, 2] - case["bodies"][0]["position"][2])
        exact = terminal2 / start * np.log(np.cosh(start * times / math.sqrt(terminal2)))
        shares = [float(np.interp(t, times, gone) / np.interp(t, times, exact)) for t in (0.1, 0.2, 0.4)]
        told(density=density, spacing=spacing, at_0_1=shares[0], at_0_2=shares[1], at_0_4=shares[2])
    assert abs(shares[0] - 1.0) < 0.1 and abs(shares[2] - 1.0) < 0.1
