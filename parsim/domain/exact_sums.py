"""Sums whose bits do not depend on their order: two int64 limbs per sum (Hallberg & Adcroft 2014).

A value is split into a multiple of 2^-20 and a remainder in multiples of 2^-60 of the sum's unit; both limbs are
integers, so adding them, within a rank or over ranks, is exact in any order. The largest sum is 2^40 units. A unit is a
power of two: with lengths and masses 2^k times as large the sums have the same bits.
"""

import numpy as np

from parsim.machine.jit import kernel

HIGH, LOW = 2.0**20, 2.0**40
LARGEST = 2.0**40


@kernel
def accumulate(values, index, units, limbs):
    """Add values (n, c), in `units` (m, c), to limbs (m, c, 2) int64 at rows `index` (n,).

    False when one is too large or not finite.
    """
    good = True
    for i in range(values.shape[0]):
        for c in range(values.shape[1]):
            value = values[i, c] / units[index[i], c]
            if not abs(value) < LARGEST / 1024.0:
                good = False
                continue
            scaled = value * HIGH
            high = np.rint(scaled)
            limbs[index[i], c, 0] += np.int64(high)
            limbs[index[i], c, 1] += np.int64(np.rint((scaled - high) * LOW))
    return good


def value(limbs: np.ndarray, units: np.ndarray) -> np.ndarray:
    """Float64 sums (m, c) of limbs (m, c, 2) int64 in `units` (m, c); NaN where the sum left its range."""
    carry = limbs[..., 1] >> 40
    high, low = limbs[..., 0] + carry, limbs[..., 1] - (carry << 40)
    result = high / HIGH + low / (HIGH * LOW)
    return np.where(np.abs(result) < LARGEST, result * units, np.nan)
