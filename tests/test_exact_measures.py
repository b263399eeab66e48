"""Solutions that depend on time and place satisfy their equations, and what is measured against them."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from parsim.validate.exact_measures import couette, off_couette, off_sway, sway

MOTION = {"amplitude": 0.005, "period": 1.5, "phase": 90.0}
TANK = {"length": 1.0, "depth": 0.5, "gravity": 9.81, "motion": MOTION}


def test_a_tank_that_sways_starts_at_rest_and_bends_by_its_acceleration():
    """At first each mode is b'' t^2 / 2; their sum at the wall, tanh left out, is that of a ramp."""
    times, h = np.array([0.0, 1e-3]), 1e-3
    first, second = sway(times, 0.05, **TANK)
    assert first == pytest.approx(0.0, abs=1e-12) and second < 0.0
    deep = sway(times, 0.25, 1.0, 1e3, 1e-9, MOTION)[1]
    forced = -0.005 * (2.0 * math.pi / 1.5) ** 2 * math.sin(math.pi / 2.0)
    odd = np.arange(1, 4001, 2)
    exact = (4.0 / (odd * math.pi) * np.cos(odd * math.pi * 0.25)).sum() * forced * 0.5 * h * h
    assert deep == pytest.approx(exact, rel=0.01)


def test_one_mode_of_it_is_a_forced_oscillator():
    h, t = 1e-4, 0.7
    around = [sway(np.array([t + k * h]), x, **TANK)[0] - sway(np.array([t + k * h]), 1.0 - x, **TANK)[0]
              for x in np.linspace(0.0, 0.5, 401) for k in (-1, 0, 1)]  # fmt: skip
    values = np.array(around).reshape(-1, 3)  # twice the odd part: all of it
    x = np.linspace(0.0, 0.5, 401)
    b = 2.0 * np.trapezoid(values * np.cos(math.pi * x)[:, None], x, axis=0)  # first mode
    steep = math.tanh(0.5 * math.pi)
    own = 9.81 * math.pi * steep
    forced = (
        4.0 * steep / math.pi * -0.005 * (2.0 * math.pi / 1.5) ** 2 * math.sin(2.0 * math.pi / 1.5 * t + 0.5 * math.pi)
    )
    assert (b[0] - 2.0 * b[1] + b[2]) / h**2 + own * b[1] == pytest.approx(forced, rel=1e-3)


def test_couette_flow_starts_at_rest_spreads_and_ends_as_a_line():
    z = np.linspace(0.0, 0.1, 21)
    assert couette(z[:-1], np.full(20, 1e-2), 0.1, 1e-3)[:10] == pytest.approx(0.0, abs=1e-6)
    assert couette(z, np.full(21, 50.0), 0.1, 1e-3) == pytest.approx(z / 0.1)
    t, h, d = 1.0, 1e-4, 1e-4
    rate = (couette(np.array([0.06]), np.array([t + h]), 0.1, 1e-3)
            - couette(np.array([0.06]), np.array([t - h]), 0.1, 1e-3)) / (2.0 * h)  # fmt: skip
    low, now, high = (couette(np.array([0.06 + k * d]), np.array([t]), 0.1, 1e-3) for k in (-1, 0, 1))
    assert rate == pytest.approx(1e-3 * (low - 2.0 * now + high) / d**2, rel=1e-3)


def test_what_is_off_is_over_the_solution():
    times = np.linspace(0.0, 3.0, 200)
    gauge = {"time": times, "gauge": np.full(200, "side"), "level": 0.5 + 1.1 * sway(times, 0.05, **TANK)}
    box = {"min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.7]}
    case = {"box": box, "water": {"fill": [{"max": [1.0, 1.0, 0.5]}]}, "gravity": [0.0, 0.0, -9.81], "motion": MOTION,
            "output": {"sensors": [{"name": "side", "x": 0.05}]}}  # fmt: skip
    assert off_sway(SimpleNamespace(case=case, series=lambda name: gauge), "side") == pytest.approx(0.1)
    z, late = np.tile([0.025, 0.075], 3), np.repeat([0.0, 40.0, 50.0], 2)
    line = {"time": late, "line": np.full(6, "line"), "z": z, "u": 2.0 * z / 0.1 + np.where(late > 45.0, 9.0, 0.02)}
    plates = {"box": {"min": [0.0] * 3, "max": [0.1, 1.0, 0.1], "faces": {"z_max": {"velocity": [2.0, 0.0, 0.0]}}},
              "water": {"viscosity": 1e-3}}  # fmt: skip
    run = SimpleNamespace(case=plates, series=lambda name: line)
    assert off_couette(run, "line", 30.0, 45.0) == pytest.approx(0.01)
