"""What the sweeps take and give, by role: see `parsim.particles.tables`."""

from typing import NamedTuple

import numpy as np

from parsim.particles.tables import Traceless, Vectors


class Pressures(NamedTuple):
    """What the pressure force is made of: p (n,), Pa, scale (n,), what makes it isotropic; class (n,)."""

    p: np.ndarray
    scale: np.ndarray
    isotropy: Traceless
    surface: np.ndarray


class Forces(NamedTuple):
    """Constants of the forces of a step: see `momentum`. density, kg/m3; dt, s."""

    own: float
    whole: float
    close2: float
    push: float
    drag: float
    hit: float
    dt: float
    density: float


class Around(NamedTuple):
    """What a fluid particle sees around it: concentration (n,), inward sum, viscous sum of the velocity, 1/(m s)."""

    concentration: np.ndarray
    inward: Vectors
    viscous: Vectors


class Reaction(NamedTuple):
    """Of each body sample: force (samples, 3), lever (samples, 3), response (samples, 6), see `reaction`."""

    force: np.ndarray
    lever: np.ndarray
    response: np.ndarray


class Density(NamedTuple):
    """n (n,); scale (n,), share of a lattice volume; body (n,), number of the body or -1."""

    n: np.ndarray
    scale: np.ndarray
    body: np.ndarray


class Growth(NamedTuple):
    """Constants of `continuity`."""

    n0: float
    widening: float
    spread: float
    hx: float
    hy: float
    hz: float
    crowd: float
    close: float
    dimensions: float


class Change(NamedTuple):
    """Of each fluid particle: rate (n,), 1/s, of n; what pushes particles apart; twofold viscous sum; isotropy."""

    rate: np.ndarray
    apart: Vectors
    twice: Vectors
    isotropy: Traceless
