"""What kernels take: arrays that belong together, by role. Kernels name the fields they use at their top.

What a kernel writes to inside a `prange` it takes from its tuple by name before: numba drops without a word what is
written through a tuple there, or to a name that the tuple was unpacked into (its issues 5872, 7135, and our finding).
Weights are arguments of their own: numba cannot take one out of a tuple for a `prange`.
"""

from typing import NamedTuple

import numpy as np


class Vectors(NamedTuple):
    """One vector for each particle, by component: three arrays (n,)."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray


class Kinematics(NamedTuple):
    """Where the particles are, m, and their velocity, m/s."""

    place: Vectors
    velocity: Vectors


class Traceless(NamedTuple):
    """One symmetric matrix without trace for each particle, by element; yy = -(xx + zz): five arrays (n,)."""

    xx: np.ndarray
    xy: np.ndarray
    xz: np.ndarray
    yz: np.ndarray
    zz: np.ndarray


class Lists(NamedTuple):
    """Neighbours of particle i: index[start[i]:middle[i]], the fluid ones, then those up to end[i], the others."""

    start: np.ndarray
    middle: np.ndarray
    end: np.ndarray
    index: np.ndarray
