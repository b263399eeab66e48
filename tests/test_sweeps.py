"""The sweeps of the water scheme against slow plain versions, exact answers and conservation."""

import math

import numpy as np
import pytest
from clouds import cloud, lattice, listed

from parsim.fluid import kernels
from parsim.fluid.weights import Lattice
from parsim.state import DETACHED, INTERNAL, SURFACE, VICINITY

SIZE, RE = np.array([1.3, 0.9, 0.7]), 0.2


@pytest.fixture(scope="module")
def mixed():
    """A random cloud with walls, its lists, and random q, c."""
    domain, near = listed(cloud(500, SIZE, seed=4, walls=200), SIZE, RE)
    p, rng = domain.particles, np.random.default_rng(8)
    p.p[:] = rng.normal(size=len(p))
    p.q[:] = p.p / p.n
    p.c[:] = rng.uniform(0.5, 1.1, len(p))
    return p, near


def row(p, near, i, part):
    """Neighbours of one kind within the support: indices, offsets (k, 3), relative velocities, distances, weights."""
    a, b = {"fluid": (near.start, near.middle), "boundary": (near.middle, near.end)}[part]
    j = near.index[a[i] : b[i]].astype(int)
    d = np.stack([p.x[j] - p.x[i], p.y[j] - p.y[i], p.z[j] - p.z[i]], 1)
    v = np.stack([p.u[j] - p.u[i], p.v[j] - p.v[i], p.w[j] - p.w[i]], 1)
    r = np.sqrt((d**2).sum(1))
    return j, d, v, r, np.maximum(RE / r - 1, 0)


def test_lattice_constants():
    square = Lattice(2, 0.1, 2.1)
    near = [(1, 4), (math.sqrt(2), 4), (2, 4)]
    number = sum(count * (2.1 / r - 1) for r, count in near)
    assert square.number == pytest.approx(number, rel=1e-14)
    assert square.spread == pytest.approx(sum(c * (2.1 / r - 1) * r * r for r, c in near) / number * 0.01, rel=1e-14)
    assert (square.count, Lattice(3, 1.0, 3.1).count) == (12, 122)
    assert Lattice(3, 0.1, 3.1).volume == pytest.approx(1e-3)


@pytest.mark.parametrize("y", [0.0, 1e-6, 0.05, 0.7])
def test_seventh_root_inverts_the_state(y):
    assert kernels.seventh_root(y) == pytest.approx((1 + y) ** (1 / 7), rel=4e-16)


def test_the_half_step_moves_fluid_and_gives_it_the_pressure_of_the_state():
    before = np.array([1.0, 1.0, 1.0, 1.01, 1.01, 1.01])
    rate, velocity = np.array([0.0, 0.1, -0.1, 0.0, 0.0, 0.1]), np.arange(6.0)
    kind = np.array([0, 0, 0, 0, 0, 1], np.uint8)
    state = np.array([INTERNAL, INTERNAL, VICINITY, SURFACE, DETACHED, INTERNAL], np.uint8)
    n, p, q = before.copy(), np.full(6, 9.0), np.full(6, 9.0)
    x, y, z = (np.full(6, start) for start in (1.0, 2.0, 3.0))
    kernels.predict(kind, state, velocity, 2 * velocity, -velocity, rate, 0.1, 1.0, 1000.0, x, y, z, n, p, q)
    moved = np.where(kind == 0, 0.1 * velocity, 0.0)
    assert np.stack([x, y, z]) == pytest.approx(np.stack([1.0 + moved, 2.0 + 2 * moved, 3.0 - moved]), rel=1e-14)
    assert n == pytest.approx([1.0, 1.01, 0.99, 1.01, 1.01, 1.01], rel=1e-14)
    assert p == pytest.approx([0, 1000 * (1.01**7 - 1), 1000 * (0.99**7 - 1), 0, 0, 9.0], rel=1e-12, abs=1e-9)
    assert q[:5] == pytest.approx(p[:5] / n[:5], rel=1e-14)


def test_momentum_sweep(mixed):
    p, near = mixed
    close, push, drag, hit, n0 = 0.1, 0.3, 0.7, 2.0, 50.0
    kernels.momentum(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n, p.q,
                     p.scale, RE, close**2, push, drag, hit, n0, p.ax, p.ay, p.az, p.nx, p.nx, p.ny, p.nz)
    c = np.zeros(len(p))
    kernels.momentum(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n, p.q,
                     p.scale, RE, close**2, push, drag, hit, n0, p.ax, p.ay, p.az, c, p.nx, p.ny, p.nz)
    for i in near.fluid[::7]:
        a, normal, total = np.zeros(3), np.zeros(3), 0.0
        for part in ("fluid", "boundary"):
            j, d, v, r, w = row(p, near, i, part)
            share = 1.0 if part == "fluid" else p.scale[j]
            approach = (d * v).sum(1)
            f = -push * (p.n[i] * p.q[j] + p.q[i] * p.n[j]) * w / r**2
            f += hit * share * np.minimum(approach, 0) / r**2 * (r < close)
            if part == "fluid":
                f += drag * approach * w / r**4
            a += (f[:, None] * d).sum(0)
            normal += ((w * share / r)[:, None] * d).sum(0)
            total += (w * share).sum()
        assert [p.ax[i], p.ay[i], p.az[i]] == pytest.approx(a, rel=1e-10, abs=1e-9)
        assert [p.nx[i], p.ny[i], p.nz[i]] == pytest.approx(normal, rel=1e-10, abs=1e-10)
        assert c[i] == pytest.approx(total / n0, rel=1e-12)


def test_continuity_sweep(mixed):
    p, near = mixed
    n0, flow, spread, h = 50.0, 0.4, 0.9, (0.1, -0.2, 0.3)
    kernels.continuity(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n,
                       p.c, p.scale, RE, n0, flow, spread, *h, p.rate, p.ax, p.ay, p.az)
    for i in near.fluid[::7]:
        rate, gradient = 0.0, np.zeros(3)
        for part in ("fluid", "boundary"):
            j, d, v, r, w = row(p, near, i, part)
            rate -= flow / p.n[i] * (p.n[j] * (d * v).sum(1) * w / r**2).sum()
            other = p.c[j] if part == "fluid" else 1.0
            share = 1.0 if part == "fluid" else p.scale[j]
            gradient += ((w / r**2 * (p.c[i] + other) * share)[:, None] * d).sum(0)
            if part == "fluid":
                rate += spread * (w * ((p.n[j] - p.n[i]) / n0 - d @ h)).sum()
        assert p.rate[i] == pytest.approx(rate, rel=1e-9, abs=1e-9)
        assert [p.ax[i], p.ay[i], p.az[i]] == pytest.approx(gradient, rel=1e-9, abs=1e-9)


def test_boundary_pressure_sweep(mixed):
    p, near = mixed
    g, rho, stiffness = (0.1, 0.2, -9.0), 3.0, 50.0
    p.ax[near.boundary] = 0.5
    pressure, n, q = p.p.copy(), p.n.copy(), p.q.copy()
    kernels.boundary_pressure(near.boundary, near.start, near.middle, near.index, p.x, p.y, p.z, p.ax, p.ay, p.az,
                              p.scale, *g, rho, RE, 100.0, stiffness, n, pressure, q)
    acceleration = np.stack([p.ax, p.ay, p.az], 1)
    for i in near.boundary:
        j, d, _, _, w = row(p, near, i, "fluid")
        expected = max((w * (p.p[j] - rho * (np.array(g) - acceleration[i]) @ d.T)).sum() / w.sum(), 0.0)
        assert pressure[i] == pytest.approx(expected, rel=1e-9, abs=1e-9)
        number = 100.0 * (1 + expected / stiffness) ** (1 / 7)
        assert n[i] == pytest.approx(number * p.scale[i], rel=1e-12)
        assert q[i] == pytest.approx(expected / number * p.scale[i], rel=1e-9, abs=1e-12)


def test_what_bodies_get_is_what_the_water_lost(mixed):
    p, near = mixed
    constants = (RE, 0.1**2, 0.3)
    back, a = np.zeros((near.boundary.size, 3)), np.zeros((2, 3, len(p)))
    kernels.reaction(near.boundary, near.start, near.middle, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n, p.q,
                     p.scale, *constants, 2.0, back)
    nothing = np.zeros((4, len(p)))
    for k, ends in enumerate((near.end, near.middle)):
        kernels.momentum(near.fluid, near.start, near.middle, ends, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n, p.q,
                         p.scale, *constants, 0.7, 2.0, 50.0, *a[k], *nothing)
    lost = [math.fsum(a[0][axis] - a[1][axis]) for axis in range(3)]
    got = [math.fsum(back[:, axis]) for axis in range(3)]
    assert np.abs(got).max() > 1.0
    assert got == pytest.approx([-value for value in lost], rel=1e-10)


def sweep(p, near, scheme):
    """Pair accelerations of all particles with the constants of a lattice."""
    c = np.zeros(len(p))
    kernels.momentum(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n, p.q,
                     p.scale, scheme.radius, 0.0, scheme.dimensions / scheme.number, 1.0, 0.0, scheme.number, p.ax,
                     p.ay, p.az, c, p.nx, p.ny, p.nz)
    return c


def test_pair_forces_add_up_to_nothing():
    every, size = lattice((9, 8, 8), 0.1, jitter=0.3, seed=2)
    rng = np.random.default_rng(1)
    every.u[:], every.v[:], every.w[:] = rng.normal(size=(3, len(every)))
    domain, near = listed(every, size, 0.31, (True, True, True))
    p, scheme = domain.particles, Lattice(3, 0.1, 3.1)
    fresh = rng.uniform(0.9, 1.1, len(every))
    p.n[:] = fresh[p.id]
    p.q[:] = fresh[::-1][p.id]
    sweep(p, near, scheme)
    for field in (p.ax, p.ay, p.az):
        total = math.fsum(field[near.fluid])
        assert abs(total) < 1e-13 * math.fsum(np.abs(field[near.fluid]))
        assert np.abs(field[near.fluid]).max() > 1


def wave_error(count):
    """Largest error of the pressure gradient and the velocity divergence of a sine wave, relative, on a lattice."""
    spacing = 1.0 / count
    every, size = lattice((count, 8, 8), spacing)
    k = 2 * math.pi
    every.u[:] = np.sin(k * every.x)
    domain, near = listed(every, size, 3.1 * spacing, (True, True, True))
    p, scheme = domain.particles, Lattice(3, spacing, 3.1)
    p.n[:] = scheme.number
    p.q[:] = np.sin(k * p.x) / scheme.number
    velocity = p.u.copy()
    p.u[:] = 0.0
    sweep(p, near, scheme)
    p.u[:] = velocity
    kernels.continuity(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.u, p.v, p.w, p.n,
                       p.c, p.scale, scheme.radius, scheme.number, 3 / scheme.number, 0.0, 0.0, 0.0, 0.0, p.rate,
                       np.zeros(len(p)), p.ay, p.az)
    exact = k * np.cos(k * p.x[near.fluid])
    return [np.abs(field[near.fluid] + exact).max() / k for field in (p.ax, p.rate)]


def test_gradient_and_divergence_are_of_second_order_on_a_lattice():
    coarse, fine = np.array(wave_error(16)), np.array(wave_error(32))
    order = np.log2(coarse / fine)
    assert (order > 1.8).all() and (fine < 0.06).all(), (order, fine)


def test_extremes_tell_of_what_is_not_finite():
    start, zero, bad = np.zeros((3, 2)), np.zeros(2), np.array([0.0, math.nan])
    assert kernels.extremes(np.arange(2), zero, bad, zero, zero, zero, zero, start)[0] == math.inf
    assert kernels.extremes(np.arange(2), zero + 2.0, zero, zero, zero, zero + 3.0, zero, start) == (4.0, 9.0)
