"""What the sweeps take and give, by role: see `parsim.particles.tables`."""

from typing import NamedTuple

import numpy as np

from parsim.particles.tables import Vectors


class State(NamedTuple):
    """Place, m; velocity and that of the particle over it, m/s; pressure p (n,), Pa; volume omega (n,), m^d."""

    place: Vectors
    velocity: Vectors
    frame: Vectors
    p: np.ndarray
    omega: np.ndarray


class Slopes(NamedTuple):
    """Slopes of p less its hydrostatic part, Pa/m, and of the components of the velocity, 1/s."""

    q: Vectors
    u: Vectors
    v: Vectors
    w: Vectors


class Around(NamedTuple):
    """What a particle sees: concentration (n,), inward sum, and what pushes particles apart, m/s."""

    concentration: np.ndarray
    inward: Vectors
    apart: Vectors


class Solid(NamedTuple):
    """Of the samples: scale (n,), acceleration, m/s2, unit normal into the water, zero where there is none."""

    scale: np.ndarray
    acceleration: Vectors
    normal: Vectors


class Rates(NamedTuple):
    """Of each particle of water: of its volume (n,), m^d/s, of its mass (n,), kg/s, of its momentum, N."""

    volume: np.ndarray
    mass: np.ndarray
    momentum: Vectors


class Reaction(NamedTuple):
    """Of each sample: force (samples, 3), lever (samples, 3), response (samples, 6), see `loads.reaction`."""

    force: np.ndarray
    lever: np.ndarray
    response: np.ndarray


class Constants(NamedTuple):
    """over: of W / r2 to the slope of the kernel, 1/m^d; volume of a full sample, m^d; density, kg/m3; modulus
    rho0 c0^2, Pa; impedance rho0 c0, kg/(m2 s); drag 2 (d + 2) mu, Pa s; least, ease, s/m: see `riemann.interface`;
    even, m/s: how fast water is swapped; gx, gy, gz: gravity, m/s2; hx, hy, hz: slope of the hydrostatic pressure,
    Pa/m; spread, m, of the shift; own, whole: see `Lattice`; flat: 1 in 2D, else 0."""

    over: float
    volume: float
    density: float
    modulus: float
    impedance: float
    drag: float
    least: float
    ease: float
    even: float
    gx: float
    gy: float
    gz: float
    hx: float
    hy: float
    hz: float
    spread: float
    own: float
    whole: float
    flat: float
