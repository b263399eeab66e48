"""What the sweeps take and give, by role: see `parsim.particles.tables`."""

from typing import NamedTuple

import numpy as np

from parsim.particles.tables import Vectors


class Prediction(NamedTuple):
    """Constants of `predict`: own, whole: see `Lattice`; drag, 1/s m2; close2, m2; bounce, 1 + restitution; dt, s."""

    own: float
    whole: float
    drag: float
    close2: float
    bounce: float
    dt: float


class Around(NamedTuple):
    """What a particle sees around it: concentration (n,), sum of the weights (n,), inward sum, viscous sum, m/s."""

    concentration: np.ndarray
    number: np.ndarray
    inward: Vectors
    viscous: Vectors


class Balance(NamedTuple):
    """Constants of `assemble`: half the spread, m2; rate = density / dt; density over dt2 in units of the matrix, with
    compressibility and with relaxation; number n0; kappa of particles at the surface and in its vicinity; dt, s;
    divergence, share of it that is taken away; rise of the pressure of water at rest, Pa/m."""

    half: float
    rate: float
    soft: float
    relaxed: float
    number: float
    surface: float
    vicinity: float
    dt: float
    divergence: float
    hx: float
    hy: float
    hz: float


class Equation(NamedTuple):
    """The pressure equation: weight of each listed pair (pairs,), diagonal and right-hand side by particle (n,).

    water (n,): the sum of the weights of its pairs, what of the diagonal does not hold the pressure to zero.
    """

    pairs: np.ndarray
    diagonal: np.ndarray
    right: np.ndarray
    water: np.ndarray


class Slope(NamedTuple):
    """Constants of `gradient`: share of the least pressure; density, kg/m3; even = n0 / d; planar, 1 in 2D; calm, 1/s;
    rise of the pressure of water at rest, Pa/m."""

    least: float
    density: float
    even: float
    planar: float
    calm: float
    hx: float
    hy: float
    hz: float


class Reaction(NamedTuple):
    """Of each body sample: force (samples, 3), lever (samples, 3), response (samples, 6), see `reaction`."""

    force: np.ndarray
    lever: np.ndarray
    response: np.ndarray
