"""Exact sums: the same bits in any order, and the right value."""

import math

import numpy as np
import pytest
from clouds import lattice, listed
from hypothesis import given, settings
from hypothesis import strategies as st

from parsim.case.scales import power_of_two
from parsim.domain import exact_sums


def total(values, index=None, rows=1, unit=1.0):
    limbs = np.zeros((rows, 1, 2), np.int64)
    values = np.asarray(values, float).reshape(-1, 1)
    units = np.full((rows, 1), unit)
    good = exact_sums.accumulate(values, np.zeros(len(values), np.int64) if index is None else index, units, limbs)
    return exact_sums.value(limbs, units)[:, 0], good


@settings(deadline=None)  # the first call compiles
@given(st.lists(st.floats(-1e8, 1e8), max_size=60), st.randoms())
def test_any_order_gives_the_same_bits_and_the_value(values, random):
    shuffled = list(values)
    random.shuffle(shuffled)
    first, good = total(values)
    assert good
    assert first.tobytes() == total(shuffled)[0].tobytes()
    assert abs(first[0] - math.fsum(values)) <= max(1e-15 * abs(math.fsum(values)), len(values) * 2.0**-60)


def test_a_plain_sum_would_fail_this():
    values = np.array([1e8, 1e-9, -1e8, 1e-9])
    assert values.sum() != 2e-9
    assert abs(total(values)[0][0] - 2e-9) < 1e-17


def test_parts_add_up_like_the_whole():
    rng = np.random.default_rng(3)
    values, limbs = rng.normal(size=(999, 1)) * 1e6, np.zeros((3, 1, 2), np.int64)
    for part in range(3):
        chunk = values[part::3]
        exact_sums.accumulate(chunk, np.full(len(chunk), part), np.ones((3, 1)), limbs)
    assert exact_sums.value(limbs.sum(axis=0)[None], np.ones((1, 1)))[0, 0] == total(values)[0][0]


def test_rows_are_kept_apart():
    sums, _ = total([1.0, 2.0, 4.0, 8.0], np.array([1, 0, 1, 2]), 3)
    assert sums.tolist() == [2.0, 5.0, 8.0]


def test_what_is_not_finite_or_too_large_is_told():
    assert not total([1.0, math.nan])[1]
    assert not total([1.0, math.inf])[1]
    assert not total([2.0**31])[1]
    assert math.isnan(total([2.0**29] * 4096)[0][0])


@pytest.mark.parametrize("size", [1e-20, 1e-6, 1e15])
def test_terms_of_any_size_lose_nothing_in_a_unit_near_them(size):
    values = np.random.default_rng(1).normal(size=500) * size
    sums, good = total(values, unit=power_of_two(size))
    assert good and sums[0] == pytest.approx(math.fsum(values), rel=1e-15, abs=1e-16 * size)
    assert sums[0] == 2.0**40 * total(2.0**-40 * values, unit=2.0**-40 * power_of_two(size))[0][0]


def test_products_are_summed_exactly():
    domain, _ = listed(*lattice((6, 6, 6), 0.1), 0.25)
    one = np.array([1e4, 1.0, -1e4])
    assert domain.dot(one, np.array([1e4, 1e-9, 1e4]), 1.0) == pytest.approx(1e-9, rel=1e-8)
