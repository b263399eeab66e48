"""The weights of the water's sums against plain formulas, what they do on sheared lattices, and their constants."""

import math

import numpy as np
import pytest
from clouds import PLAIN

from parsim.fluid.reference import Lattice
from parsim.fluid.weights import WEIGHTS
from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import kernel


@kernel
def compiled(weight, r2, out):
    """What `weight_at` gives in a kernel, at squared distances r2 (n,): out (n, 3)."""
    for i in range(r2.size):
        out[i, 0], out[i, 1], out[i, 2] = weight_at(weight, r2[i], 1.0 / math.sqrt(r2[i]))


@pytest.mark.parametrize("name", WEIGHTS)
def test_weights_against_plain_formulas(name):
    radius = 0.31
    r = np.concatenate([np.linspace(0.001, radius * (1 - 1e-9), 400), radius * np.array([1.0, 1.0 + 1e-9, 1.3, 2.0])])
    weight, fast = WEIGHTS[name].of_radius(radius), np.empty((r.size, 3))
    compiled(weight, r * r, fast)
    plain = np.array([weight_at(weight, s * s, 1.0 / s) for s in r])
    w, measure = PLAIN[name](r, radius)
    for found in (plain, fast):
        assert found == pytest.approx(np.stack([w, w / r**2, measure], 1), rel=1e-9, abs=1e-15)
        assert found[r > radius] == pytest.approx(0.0, abs=1e-30), "nothing beyond the radius"
        assert (found[:-4, 0] > 0.0).all() and (found[:-4, 2] > 0.0).all()


@pytest.mark.parametrize("name, kernel_of, share, slope", [
    ("wendland_c2", lambda q: (1 - q) ** 4 * (4 * q + 1), 1.5, 20.0),
    ("wendland_c4", lambda q: (1 - q) ** 5 * (1 + 5 * q + 8 * q**2), 1.8, 14.0),
])  # fmt: skip
def test_weights_are_the_slope_of_a_kernel_and_measures_its_mix_with_it(name, kernel_of, share, slope):
    q, step, weight = np.linspace(0.01, 0.99, 99), 1e-6, WEIGHTS[name].of_radius(1.0)
    w, _, measure = np.array([weight_at(weight, s * s, 1.0 / s) for s in q]).T
    falls = -(kernel_of(q + step) - kernel_of(q - step)) / (2 * step)
    assert q * falls == pytest.approx(slope * w, rel=1e-6, abs=1e-9)
    assert measure == pytest.approx(kernel_of(q) + share * w, rel=1e-12, abs=1e-15)
    assert kernel_of(0.0) == WEIGHTS[name].OWN


def off_isotropic(name, strain, support=3.1):
    """The length of what keeps sum e e W from isotropic, over half its trace, on a square lattice times `strain`."""
    offsets = np.array([(i, k) for i in range(-8, 9) for k in range(-8, 9) if i or k])
    away = offsets @ np.transpose(strain)
    r = np.sqrt((away**2).sum(1))
    moment = (away.T * (PLAIN[name](r, support)[0] / r**2)) @ away
    return np.linalg.norm(2.0 * moment / np.trace(moment) - np.eye(2))


SHEARED = [((1.0, shear), (0.0, 1.0)) for shear in np.linspace(0.0, 0.5, 11)]
STRETCHED = [((stretch, 0.0), (0.0, 1.0 / stretch)) for stretch in (1.05, 1.1, 1.15, 1.2)]


@pytest.mark.parametrize("name, least, most", [
    ("wendland_c4", 0.0, 0.011), ("wendland_c2", 0.0, 0.019), ("mps", 0.17, 0.19),
])  # fmt: skip
def test_which_weights_stay_isotropic_on_strained_lattices(name, least, most):
    assert least < max(off_isotropic(name, strain) for strain in SHEARED + STRETCHED) < most
    assert off_isotropic(name, np.eye(2)) < 1e-12, "a square lattice is isotropic"


def plain_lattice(dimensions, support):
    """Distances (n,) and heights (n,) of the neighbours of a lattice, in spacings, seen from the particle at 0."""
    grid = np.stack(np.meshgrid(*[np.arange(-5, 6)] * dimensions), -1).reshape(-1, dimensions)
    r = np.sqrt((grid**2).sum(1))
    near = (r > 0) & (r < support)
    return r[near], grid[near, -1]


@pytest.mark.parametrize("name", WEIGHTS)
@pytest.mark.parametrize("dimensions, support, count", [(2, 2.1, 12), (2, 3.1, 28), (3, 2.1, 32), (3, 3.1, 122)])
def test_lattice_constants(name, dimensions, support, count):
    found, (r, up) = Lattice(dimensions, 0.1, support, name), plain_lattice(dimensions, support)
    w, measure = PLAIN[name](r, support)
    own = 0.0 if name == "mps" else 1.0
    assert (found.count, r.size, found.own) == (count, count, own)
    assert found.radius == pytest.approx(0.1 * support) and found.volume == pytest.approx(0.1**dimensions)
    assert found.number == pytest.approx(w.sum(), rel=1e-12)
    assert found.spread == pytest.approx((w * r**2).sum() / w.sum() * 0.01, rel=1e-12)
    assert found.whole == pytest.approx(own + measure.sum(), rel=1e-12)
    lost = up >= 2
    assert found.cut == pytest.approx(measure[lost].sum() / (measure * up / r)[lost].sum(), rel=1e-12)
    rows = [(own + measure[up <= k].sum()) / found.whole for k in range(4)]
    assert [found.concentration(k) for k in range(4)] == pytest.approx(rows, rel=1e-12)
    assert found.lowest < found.concentration(0) < found.highest < found.concentration(1) <= rows[3]
    assert rows[3] == pytest.approx(1.0)
    assert sum(w for w, _, _, _ in found.points()) == pytest.approx(found.number)
