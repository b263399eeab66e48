"""Probabilities, means, quantiles and curves of many outcomes, against published and exact numbers."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from parsim.study.statistics import Curve, bootstrap, estimate, logistic, wilson

# pass an exam after so many hours of study: the example of "Logistic regression", Wikipedia, whose table of 20 students
# gives an intercept of -4.0777 and 1.5046 per hour
HOURS = [0.5, 0.75, 1, 1.25, 1.5, 1.75, 1.75, 2, 2.25, 2.5, 2.75, 3, 3.25, 3.5, 4, 4.25, 4.5, 4.75, 5, 5.5]
PASSED = [0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1]


@pytest.mark.parametrize(("runs", "yes", "low", "high"), [
    (10, 0, 0.0, 0.27754),
    (10, 1, 0.0178757, 0.404156),
    (10, 9, 0.595844, 0.982124),
    (20, 10, 0.299295, 0.700705),
    (40, 36, 0.769479, 0.960421),
    (100, 10, 0.0552285, 0.174367),
])  # fmt: skip
def test_wilson_intervals_are_those_of_the_formula(runs, yes, low, high):
    """(p + z2/2n -+ z sqrt(p(1-p)/n + z2/4n2)) / (1 + z2/n) with z = 1.96, Wilson (1927), evaluated elsewhere."""
    found = wilson(yes, runs)
    assert found == pytest.approx((yes / runs, low, high), rel=1e-5)
    assert found.half_width == pytest.approx(0.5 * (high - low), rel=1e-5)


def test_without_runs_everything_is_possible():
    assert wilson(0, 0)[1:] == (0.0, 1.0) and math.isnan(wilson(0, 0).value)


@given(st.integers(1, 300), st.data())
def test_a_wilson_interval_holds_its_probability_and_mirrors(runs, data):
    yes = data.draw(st.integers(0, runs))
    found, other = wilson(yes, runs), wilson(runs - yes, runs)
    assert 0.0 <= found.low <= found.value <= found.high <= 1.0
    assert (1.0 - other.high, 1.0 - other.low) == pytest.approx(found[1:])


def test_the_bootstrap_knows_means_and_quantiles_of_a_normal_sample():
    values = tuple(np.random.default_rng(5).normal(3.0, 2.0, 400))
    mean, median, high = bootstrap(values, (0.5, 0.9))
    assert mean.value == pytest.approx(np.mean(values)) and high.value == pytest.approx(np.quantile(values, 0.9))
    assert mean.half_width == pytest.approx(1.96 * np.std(values) / 20.0, rel=0.05)
    assert median.half_width == pytest.approx(1.96 * 2.0 / 20.0 * math.sqrt(math.pi / 2.0), rel=0.25)
    assert high.low < high.value < high.high


def test_the_bootstrap_is_the_same_every_time_and_in_every_order():
    values = (3.0, 1.0, 2.0, 7.0, 5.0)
    first = bootstrap(values, (0.5,))
    bootstrap.cache_clear()
    assert bootstrap(values[::-1], (0.5,)) == first != bootstrap((3.0, 1.0, 2.0, 7.0, 6.0), (0.5,))


def test_one_value_has_no_interval():
    (mean,) = bootstrap((4.0,))
    assert mean.value == 4.0 and math.isnan(mean.half_width)


def test_the_estimate_follows_the_kind_of_outcome():
    assert estimate([True, False]) == wilson(1, 2)
    assert estimate([1.0, 2.0]) == bootstrap((1.0, 2.0))[0]


def test_a_logistic_curve_is_that_of_a_published_example():
    curve = logistic(HOURS, PASSED)
    assert curve.slope == pytest.approx(1.5046, abs=1e-4)
    assert curve.middle == pytest.approx(4.0777 / 1.5046, abs=1e-4)
    assert curve.at(np.array([2.0])) == pytest.approx([1.0 / (1.0 + math.exp(4.0777 - 2.0 * 1.5046))], abs=1e-4)


def test_a_steep_curve_is_0_and_1_far_from_its_middle():
    with np.errstate(all="raise", under="ignore"):
        nearly = logistic([-100.0, 0.0, 0.0, 0.0, 1e-4, 1e-4, 100.0], [0, 0, 0, 1, 0, 1, 1])
        assert nearly[:2] == pytest.approx((math.log(2.0) / 1e-4, 1e-4), rel=1e-3)
        assert Curve(50.0, 5.0, 4.9, 5.1).at(np.array([-50.0, 5.0, 50.0])) == pytest.approx([0.0, 0.5, 1.0])


def test_two_places_are_met_exactly_with_the_error_of_their_counts():
    """10 and 30 yes of 40 at 1 and 2: logits -+ ln 3, each of variance 1 / (40 p q)."""
    curve = logistic([1.0] * 40 + [2.0] * 40, [1] * 10 + [0] * 30 + [1] * 30 + [0] * 10)
    assert curve.middle == pytest.approx(1.5) and curve.slope == pytest.approx(2.0 * math.log(3.0))
    spread = math.sqrt(2.0 / (40.0 * 0.1875)) / (4.0 * math.log(3.0))
    assert (curve.low, curve.high) == pytest.approx((1.5 - 1.96 * spread, 1.5 + 1.96 * spread))


def test_a_falling_curve_and_far_places():
    curve = logistic([1e6 + hour for hour in HOURS], [not passed for passed in PASSED])
    assert curve.slope == pytest.approx(-1.5046, abs=1e-4) and curve.middle == pytest.approx(1e6 + 2.7102, abs=1e-3)


@pytest.mark.parametrize(("x", "yes"), [
    ([1, 2, 3, 4], [0, 0, 1, 1]),
    ([1, 2, 3, 4], [1, 1, 0, 0]),
    ([1, 2, 2, 3], [0, 0, 1, 1]),
    ([1, 2, 3], [1, 1, 1]),
    ([1, 2, 3], [0, 0, 0]),
    ([2, 2, 2], [0, 1, 0]),
])  # fmt: skip
def test_what_is_parted_or_all_the_same_has_no_curve(x, yes):
    assert logistic(x, yes) is None
