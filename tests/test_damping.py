"""The damping of noise: the viscous sums of the viscous sums, taken off the velocity."""

import math

import numpy as np
import pytest
from clouds import lattice, listed
from test_sweeps import continuity, growth_of, sweep

from parsim.fluid.reference import Lattice
from parsim.fluid.wcmps import updates
from parsim.fluid.wcmps.fields import TWICE_VISCOUS, VISCOUS
from parsim.fluid.weights import WEIGHTS

SPACING = 0.1


@pytest.fixture(params=WEIGHTS)
def box(request):
    """A periodic box of disordered water and its lattice constants."""
    return made(lattice((16, 8, 8), SPACING, jitter=0.2, seed=5), request.param)


def made(cloud, name, periodic=True):
    every, size = cloud
    domain, near = listed(every, size, 3.1 * SPACING, (periodic,) * 3)
    return domain, near, Lattice(3, SPACING, 3.1, name)


def twofold(domain, near, scheme, velocity):
    """Viscous sums and twofold viscous sums, (n, 3) each, of the fluid with the velocity (particles, 3)."""
    p = domain.particles
    p.u[:], p.v[:], p.w[:] = velocity.T
    sweep(p, near, scheme)
    domain.refresh("bx", "by", "bz")
    p.ex[:], p.ey[:], p.ez[:] = continuity(p, near, scheme.weight, growth_of(scheme, 1.0)).twice
    return [np.stack(p.vectors(names), 1)[near.fluid] for names in (VISCOUS, TWICE_VISCOUS)]


def noise(p, seed):
    """A random velocity, (particles, 3), the same for a particle and its images."""
    return np.random.default_rng(seed).normal(size=(p.id.max() + 1, 3))[p.id]


def shear_wave(p, across):
    """A velocity along y that varies `across` x with one wave in the box, (particles, 3)."""
    return np.stack([0.0 * p.x, np.sin(across * p.x), 0.0 * p.x], 1)


def share_taken(scheme, damping, cfl=1.0):
    """What a step at c0 = 1 m/s takes of the twofold sums, as `WCMPS._finish` has it."""
    viscous = 2.0 * scheme.dimensions * (scheme.dimensions + 2) / scheme.number
    return damping * SPACING**3 * viscous**2 * cfl * SPACING


def test_damping_keeps_the_momentum(box):
    domain, near, scheme = box
    for sums in twofold(domain, near, scheme, noise(domain.particles, 1)):
        for axis in range(3):
            assert abs(math.fsum(sums[:, axis])) < 1e-13 * math.fsum(np.abs(sums[:, axis]))
            assert np.abs(sums[:, axis]).max() > 1.0


@pytest.mark.parametrize("damping", [0.0001, 0.005])
def test_damping_takes_energy_from_whatever_moves(box, damping):
    domain, near, scheme = box
    p, left = domain.particles, []
    fields = [noise(p, seed) for seed in range(3)]
    jags = np.where((p.id % 2 == 0)[:, None], 1.0, -1.0) * np.ones(3)
    for velocity in (*fields, jags, shear_wave(p, 2 * math.pi / 1.6)):
        once, twice = twofold(domain, near, scheme, velocity)
        before = math.fsum((velocity[near.fluid] ** 2).ravel())
        product = math.fsum((velocity[near.fluid] * twice).ravel())
        assert product == pytest.approx(math.fsum((once**2).ravel()), rel=1e-10), "the sums are symmetric"
        updates.damp(near.fluid, share_taken(scheme, damping), p.vectors(TWICE_VISCOUS), p.velocity)
        after = math.fsum((np.stack([p.u, p.v, p.w], 1)[near.fluid] ** 2).ravel())
        left.append(after / before)
    assert max(left) < 1.0 and min(left[:3]) > 0.0


@pytest.mark.parametrize("name", WEIGHTS)
def test_damping_leaves_a_rigid_rotation_alone(name):
    domain, near, scheme = made(lattice((8, 8, 8), SPACING, jitter=0.2, seed=5), name, periodic=False)
    p = domain.particles
    place, spin = np.stack([p.x, p.y, p.z], 1), np.array([1.0, -2.0, 0.5])
    turning = twofold(domain, near, scheme, np.cross(spin, place - 0.4) + [3.0, 1.0, -2.0])
    rough = twofold(domain, near, scheme, noise(p, 1))
    for still, moved in zip(turning, rough, strict=True):
        assert np.abs(still).max() < 1e-12 * np.abs(moved).max()


def test_damping_takes_noise_and_leaves_waves(box):
    domain, near, scheme = box
    p, rates = domain.particles, []
    for velocity in (noise(p, 1), shear_wave(p, 2 * math.pi / 1.6)):
        once, _ = twofold(domain, near, scheme, velocity)
        rates.append((once**2).sum() / (velocity[near.fluid] ** 2).sum())
    assert rates[0] > 50 * rates[1], rates


@pytest.mark.parametrize("name", WEIGHTS)
def test_damping_is_biharmonic(name):
    """Exact: damping k^4 c0 l0^3 dt. The diagonal of a lattice is as much stiffer as its axes are softer."""
    every, size = lattice((32, 1, 32), SPACING)
    domain, near = listed(every, size, 3.1 * SPACING, (True, False, True))
    p, scheme, roots = domain.particles, Lattice(2, SPACING, 3.1, name), []
    for across in (0.0, 1.0):
        k = 2 * math.pi / 3.2 * np.array([1.0, across])
        wave = np.sin(k[0] * p.x + k[1] * p.z)
        velocity = np.stack([-across * wave, 0.0 * wave, wave], 1)
        _, twice = twofold(domain, near, scheme, velocity)
        rate = share_taken(scheme, 0.0002) * (twice * velocity[near.fluid]).sum() / (velocity[near.fluid] ** 2).sum()
        roots.append(math.sqrt(rate / (0.0002 * SPACING**4 * (k @ k) ** 2)))
    assert np.mean(roots) == pytest.approx(1.0, abs=0.02), roots
