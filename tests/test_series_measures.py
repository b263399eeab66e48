"""What `parsim validate` measures of series, on made-up ones whose answers are known."""

import math

import numpy as np
import pytest

from parsim.validate import series_measures as measures


class Made:
    """A run with one series, `made`."""

    def __init__(self, **columns):
        self._columns = {name: np.array(values) for name, values in columns.items()}

    def series(self, name):
        return self._columns


def swing(period=0.8, damping=0.1, until=4.0):
    """A damped swing about 2."""
    t = np.arange(0.0, until, 0.001)
    rate = damping / math.sqrt(1.0 - damping * damping) * 2.0 * math.pi / period
    return Made(time=t, z=2.0 + np.exp(-rate * t) * np.cos(2.0 * math.pi * t / period))


def test_means_extremes_and_last_values_of_chosen_rows():
    run = Made(time=[0.0, 0.0, 1.0, 1.0, 2.0, 2.0], body=list("ababab"), x=[1.0, 9.0, 3.0, 8.0, 8.0, 7.0])
    rows = {"body": "a"}
    assert measures.mean(run, "made", "x", rows) == 4.0
    assert measures.mean(run, "made", "x", rows, 1.0, 1.5) == 3.0
    assert measures.maximum(run, "made", "x", rows=rows, over=2.0) == 4.0
    assert measures.maximum(run, "made", "x", after=1.0, rows={"body": "b"}) == 8.0
    assert measures.last(run, "made", "x", rows=rows) == 8.0


def test_a_value_is_reached_between_rows():
    run = Made(time=[0.0, 1.0, 2.0, 3.0], x=[math.nan, 1.0, 3.0, 2.0])
    assert measures.first_over(run, "made", "x", 2.0) == 1.5
    assert measures.first_over(run, "made", "x", 2.0, over=0.5) == 3.0
    assert measures.first_over(run, "made", "x", 3.0, from_value=2.0) == 0.5
    assert math.isnan(measures.first_over(run, "made", "x", 3.1))
    assert measures.first_over(run, "made", "x", 0.25, dry=0.0) == 0.25
    assert math.isnan(measures.first_over(run, "made", "x", 0.25)), "a gauge that read nothing before"


def test_noise_is_what_is_off_the_running_mean():
    t = np.arange(0.0, 4.0, 0.01)
    slow = Made(time=t, p=100.0 * t)
    assert measures.noise_of(slow, "made", "p", 1.0, 3.0, 0.1, 1.0) < 1e-9
    fast = Made(time=t, p=100.0 * t + 5.0 * np.cos(math.pi * np.arange(t.size)))
    assert measures.noise_of(fast, "made", "p", 1.0, 3.0, 0.1, 10.0) == pytest.approx(0.5 * 12.0 / 11.0, rel=0.01), (
        "the mean of eleven has one left over"
    )


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.15])
def test_period_and_damping_of_a_swing(damping):
    run = swing(damping=damping)
    assert measures.period_of(run, "made", "z", 2.0) == pytest.approx(0.8, rel=1e-3)
    assert measures.damping_of(run, "made", "z", 2.0) == pytest.approx(damping, abs=0.015)


def test_a_curve_is_met_in_its_own_units():
    run = Made(time=np.arange(0.0, 2.0, 0.01), z=5.0 - 0.2 * np.arange(0.0, 2.0, 0.01))
    curve = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]
    same = {"start": 0.5, "zero": 4.9, "unit": -0.1, "time_unit": 0.5}
    assert measures.off_curve(run, "made", "z", curve, **same) < 1e-9
    off = [[0.0, 0.3], [1.0, 1.3], [2.0, 2.3]]
    assert measures.off_curve(run, "made", "z", off, **same, over=1.0) == pytest.approx(0.3)
    norm = math.sqrt((0.3**2 + 1.3**2 + 2.3**2) / 3.0)
    assert measures.off_curve(run, "made", "z", off, **same) == pytest.approx(0.3 / norm)


def test_what_is_counted_grows_over_another():
    run = Made(time=[0.0, 1.0, 2.0, 3.0], out=[9, 10, 12, 16], let_in=[0, 20, 24, 32])
    assert measures.growth_over(run, "made", "out", "let_in", 1.0) == 0.5


def test_energy_and_the_balance_of_particles():
    assert measures.energy_made(Made(total=[10.0, 9.0, 10.01, 8.0])) == pytest.approx(0.001)
    assert measures.balance(Made(balance=[20, 20, 20])) == 0.0
    assert measures.balance(Made(balance=[20, 21, 19])) == 2.0


def profile(u):
    """Two moments of a velocity on a line, the mean of which is `u`(z)."""
    z = np.arange(0.005, 0.2, 0.01)
    both = np.concatenate([z, z])
    off = np.concatenate([np.full(z.size, 0.01), np.full(z.size, -0.01)])
    return Made(time=np.repeat([1.0, 2.0], z.size), line=np.full(both.size, "l"), z=both, u=u(both) + off,
                particles=np.ones(both.size))  # fmt: skip


def test_profiles_are_held_to_the_logarithm_and_the_parabola():
    run = profile(lambda z: 0.06 / 0.41 * np.log(30.0 * z / 0.02))
    assert measures.off_log_law(run, "l", 0.0, 0.06, 0.02, 0.2) < 1e-12
    assert measures.off_log_law(run, "l", 1.5, 0.06, 0.02, 0.2) > 0.01
    run = profile(lambda z: 0.6 * z / 0.2 * (1.0 - z / 0.2))
    assert measures.off_parabola(run, "l", 0.0, 0.1, 0.2) < 1e-12
