"""The sweeps of the water scheme against slow plain versions, exact answers and conservation."""

import math

import numpy as np
import pytest
from clouds import PLAIN, cloud, lattice, listed

from parsim.fluid import moves, tait, walls
from parsim.fluid.reference import Lattice
from parsim.fluid.wcmps import sweeps, tables, updates
from parsim.fluid.wcmps.fields import NORMAL, VISCOUS, isotropy
from parsim.fluid.weights import WEIGHTS
from parsim.particles.state import DETACHED, INTERNAL, SHUT_IN, SURFACE, VICINITY
from parsim.particles.tables import Traceless, Vectors

SIZE, RE = np.array([1.3, 0.9, 0.7]), 0.2


@pytest.fixture(scope="module")
def mixed():
    """A random cloud with walls, its lists, and random pressures, viscous sums and corrections of the water."""
    domain, near = listed(cloud(500, SIZE, seed=4, walls=200), SIZE, RE)
    p, rng = domain.particles, np.random.default_rng(8)
    p.p[:], p.bx[:], p.by[:], p.bz[:] = rng.normal(size=(4, len(p)))
    for field in isotropy(p):
        field[near.fluid] = 0.1 * rng.normal(size=near.fluid.size)
    return p, near


@pytest.fixture(params=WEIGHTS)
def weight(request):
    """The name of each weight."""
    return request.param


def corrections(p):
    """The corrections of the gradient as matrices (n, 3, 3)."""
    xx, xy, xz, yz, zz = isotropy(p)
    return np.moveaxis(np.array([[xx, xy, xz], [xy, -xx - zz, yz], [xz, yz, zz]]), 2, 0)


def filled(p, near, i, weight):
    """The sum of W of the water and of the bodies that particle i sees."""
    of_boundary, _, _, _, w, _ = row(p, near, i, "boundary", weight)
    return row(p, near, i, "fluid", weight)[4].sum() + (w * p.scale[of_boundary] * (p.body[of_boundary] >= 0)).sum()


def row(p, near, i, part, weight):
    """Neighbours of one kind: indices, offsets (k, 3), velocities (k, 3) less its own, distances, W and measures."""
    a, b = {"fluid": (near.start, near.middle), "boundary": (near.middle, near.end)}[part]
    j = near.index[a[i] : b[i]].astype(int)
    d = np.stack([p.x[j] - p.x[i], p.y[j] - p.y[i], p.z[j] - p.z[i]], 1)
    v = np.stack([p.u[j] - p.u[i], p.v[j] - p.v[i], p.w[j] - p.w[i]], 1)
    r = np.sqrt((d**2).sum(1))
    return j, d, v, r, *PLAIN[weight](r, RE)


def test_seventh_roots_invert_the_state():
    y = np.array([0.0, 1e-6, 0.05, 0.7])
    assert tait.seventh_roots(y) == pytest.approx((1 + y) ** (1 / 7), rel=4e-16)


def test_the_half_step_moves_fluid_and_gives_it_the_pressure_of_the_state():
    before = np.array([1.0, 1.0, 1.0, 1.01, 1.01, 1.01])
    rate, velocity = np.array([0.0, 0.1, -0.1, 0.0, 0.0, 0.1]), np.arange(6.0)
    kind = np.array([0, 0, 0, 0, 0, 1], np.uint8)
    state = np.array([INTERNAL, INTERNAL, VICINITY, SURFACE, DETACHED, INTERNAL], np.uint8)
    n, p = before.copy(), np.full(6, 9.0)
    x, y, z = (np.full(6, start) for start in (1.0, 2.0, 3.0))
    flow, place = Vectors(velocity, 2 * velocity, -velocity), Vectors(x, y, z)
    updates.predict(kind, state, flow, rate, (0.1, 1.0, 1000.0), place, n, p)
    moved = np.where(kind == 0, 0.1 * velocity, 0.0)
    assert np.stack([x, y, z]) == pytest.approx(np.stack([1.0 + moved, 2.0 + 2 * moved, 3.0 - moved]), rel=1e-14)
    assert n == pytest.approx([1.0, 1.01, 0.99, 1.01, 1.01, 1.01], rel=1e-14)
    squeezed = 1000 * (1.01**7 - 1)
    assert p == pytest.approx([0, squeezed, 1000 * (0.99**7 - 1), squeezed, 0, 9.0], rel=1e-12, abs=1e-9)


def test_momentum_sweep(mixed, weight):
    p, near = mixed
    close, push, drag, hit, dt, own, whole = 0.1, 0.3, 0.7, 2.0, 0.05, 0.6, 50.0
    p.ax[near.boundary] = 3.0
    c, b = np.zeros(len(p)), np.zeros((3, len(p)))
    forces = tables.Forces(own, whole, close**2, push, drag, hit, dt, 1.0)
    momentum(p, near, WEIGHTS[weight].of_radius(RE), forces, tables.Around(c, p.vectors(NORMAL), Vectors(*b)))
    struck, t = 0, corrections(p)
    for i in near.fluid[::7]:
        a, normal, viscous, total = np.zeros(3), np.zeros(3), np.zeros(3), own
        for part in ("fluid", "boundary"):
            j, d, v, r, w, measure = row(p, near, i, part, weight)
            share = 1.0 if part == "fluid" else p.scale[j]
            approach = (d * v).sum(1)
            f = -push * (p.p[i] + p.p[j]) * w / r**2
            if part == "boundary":
                after = approach + dt * 3.0 * d[:, 0]
                bounce = hit * np.where(approach < 0.0, after, 0.0) / r**2 * (r < close)
                f, struck = f + bounce, struck + np.count_nonzero(bounce)
            else:
                viscous = ((approach * w / r**4)[:, None] * d).sum(0)
                a += drag * viscous
            a += ((f * share)[:, None] * d).sum(0)
            both = p.p[i] * t[i] + p.p[j, None, None] * t[j]
            a -= push * ((w * share / r**2)[:, None] * (both @ d[:, :, None])[:, :, 0]).sum(0)
            normal += ((w * share / r**2)[:, None] * d).sum(0)
            total += (measure * share).sum()
        assert [p.ax[i], p.ay[i], p.az[i]] == pytest.approx(a, rel=1e-10, abs=1e-9)
        assert [p.nx[i], p.ny[i], p.nz[i]] == pytest.approx(normal, rel=1e-10, abs=1e-10)
        assert b[:, i] == pytest.approx(viscous, rel=1e-10, abs=1e-9)
        assert c[i] == pytest.approx(total / whole, rel=1e-12)
    assert struck > 10


def test_continuity_sweep(mixed, weight):
    p, near = mixed
    flow, spread, h, crowd, close = 0.4, 0.9, (0.1, -0.2, 0.3), 30.0, 0.12
    p.body[near.boundary[::2]] = 0
    n0, shares = np.quantile([filled(p, near, i, weight) for i in near.fluid[::7]], 0.5, method="lower") / 0.98, set()
    found = continuity(p, near, WEIGHTS[weight].of_radius(RE), tables.Growth(n0, flow, spread, *h, crowd, close, 3.0))
    sums = np.stack([p.bx, p.by, p.bz], 1)
    for i in near.fluid[::7]:
        rate, apart, twofold, m = 0.0, np.zeros(3), np.zeros(3), np.zeros((3, 3))
        for part in ("fluid", "boundary"):
            j, d, v, r, w, _ = row(p, near, i, part, weight)
            g = w / r**2 * (1.0 if part == "fluid" else p.scale[j])
            rate -= flow * ((d * v).sum(1) * g).sum()
            m += np.einsum("n,ni,nj->ij", g, d, d)
            apart += ((g * (2.0 + crowd * np.maximum(close - r, 0.0)))[:, None] * d).sum(0)
            if part == "fluid":
                rate += spread * (w * ((p.n[j] - p.n[i]) / n0 - d @ h)).sum()
                twofold = ((g / r**2 * ((sums[j] - sums[i]) * d).sum(1))[:, None] * d).sum(0)
        assert found.rate[i] == pytest.approx(rate, rel=1e-9, abs=1e-9)
        assert [field[i] for field in found.apart] == pytest.approx(apart, rel=1e-9, abs=1e-9)
        assert [field[i] for field in found.twice] == pytest.approx(twofold, rel=1e-9, abs=1e-9)
        exact = np.eye(3) - 3.0 * m / np.trace(m)
        share = np.clip((filled(p, near, i, weight) / n0 - 0.97) / 0.02, 0.0, 1.0)
        shares.add(share)
        exact *= min(share, sweeps.LARGEST / np.sqrt((exact**2).sum()))
        five = exact[[0, 0, 0, 1, 2], [0, 1, 2, 2, 2]]
        assert [field[i] for field in found.isotropy] == pytest.approx(five, rel=1e-9, abs=1e-12)
    assert {0.0, 1.0} < shares, "some at the surface, some inside, some between"


def test_boundary_pressure_sweep(mixed, weight):
    p, near = mixed
    g, rho = (0.1, 0.2, -9.0), 3.0
    p.ax[near.boundary] = 0.5
    p.body[near.boundary[::2]] = 0
    pressure, sucked = p.p.copy(), [0, 0]
    p.surface[near.fluid[::5]] = SHUT_IN
    which, of_radius = (p.body, p.surface), WEIGHTS[weight].of_radius(RE)
    walls.boundary_pressure(near.boundary, near.lists, which, p.place, p.acceleration, of_radius, (*g, rho), pressure)
    acceleration = np.stack([p.ax, p.ay, p.az], 1)
    for i in near.boundary:
        j, d, _, r, w, _ = row(p, near, i, "fluid", weight)
        w = np.where(p.surface[j] == SHUT_IN, 0.0, w / r**2)
        mean = (w * (p.p[j] - rho * (np.array(g) - acceleration[i]) @ d.T)).sum() / w.sum()
        solid = int(p.body[i] >= 0)
        sucked[solid] += mean < 0.0
        assert pressure[i] == pytest.approx(mean if solid else max(mean, 0.0), rel=1e-9, abs=1e-9)
    assert min(sucked) > 0 and sum(sucked) < near.boundary.size, "no wall pulls at the water, a body does"


def test_what_bodies_get_is_what_the_water_lost(mixed, weight):
    p, near = mixed
    of_radius, forces = WEIGHTS[weight].of_radius(RE), tables.Forces(1.0, 50.0, 0.1**2, 0.3, 0.7, 2.0, 0.05, 3.0)
    p.surface[near.fluid] = INTERNAL
    acceleration = np.random.default_rng(4).normal(size=(3, len(p)))
    back, a = reaction(p, near, of_radius, forces, acceleration, p.p).force, np.stack([acceleration, acceleration])
    for k, ends in enumerate((near.end, near.middle)):
        p.ax[:], p.ay[:], p.az[:] = acceleration
        momentum(p, near, of_radius, forces, lists=near.lists._replace(end=ends))
        a[k] = p.acceleration
    lost = [math.fsum((a[0][axis] - a[1][axis])[near.fluid]) for axis in range(3)]
    got = [math.fsum(back[:, axis]) for axis in range(3)]
    assert np.abs(got).max() > 1.0
    assert got == pytest.approx([-value for value in lost], rel=1e-10)


def test_the_water_on_a_sample_is_linear_in_its_acceleration(mixed, weight):
    """The change of load and pressure is that of `response` and `lever`, and the response takes energy only."""
    p, near = mixed
    of_radius, forces = WEIGHTS[weight].of_radius(RE), tables.Forces(0.0, 0.0, 0.1**2, 0.3, 0.0, 2.0, 0.05, 3.0)
    at, change = near.boundary, np.array([0.7, -1.1, 0.4])
    p.body[at] = 0
    p.surface[near.fluid[::5]] = SHUT_IN
    found = []
    for more in (0.0 * change, change):
        a, pressure = np.tile(more[:, None], len(p)), p.p.copy()
        which, fall = (p.body, p.surface), (0.0, 0.0, -9.0, 3.0)
        walls.boundary_pressure(at, near.lists, which, p.place, Vectors(*a), of_radius, fall, pressure)
        out, lever, response = reaction(p, near, of_radius, forces, a, pressure)
        found.append((out, pressure[at], lever, response))
    (before, low, lever, response), (after, high, _, _) = found
    matrix = response[:, [[0, 1, 2], [1, 3, 4], [2, 4, 5]]]
    assert high - low == pytest.approx(lever @ change, rel=1e-9, abs=1e-9)
    assert after - before == pytest.approx(-(matrix @ change), rel=1e-9, abs=1e-9)
    assert np.linalg.eigvalsh(matrix).min() > -1e-9
    assert np.abs(after - before).max() > 0.1


def sweep(p, near, scheme):
    """Pair accelerations of all particles and their viscous sums with the constants of a lattice; concentrations."""
    push = scheme.dimensions / scheme.number
    return momentum(p, near, scheme.weight, tables.Forces(scheme.own, scheme.whole, 0.0, push, 1.0, 0.0, 0.0, 1.0))


def momentum(p, near, weight, forces, around=None, lists=None):
    """The momentum sweep over all fluid into the fields of the particles; their concentrations."""
    around = around or tables.Around(np.zeros(len(p)), p.vectors(NORMAL), p.vectors(VISCOUS))
    sweeps.momentum(
        near.fluid,
        lists or near.lists,
        p.kinematics,
        tables.Pressures(p.p, p.scale, isotropy(p), p.surface),
        weight,
        forces,
        p.acceleration,
        around,
    )
    return around.concentration


def reaction(p, near, weight, forces, acceleration, pressure):
    """What the boundary, whose samples have the acceleration (3, particles), gives back to the water."""
    out = tables.Reaction(*(np.empty((near.boundary.size, k)) for k in (3, 3, 6)))
    sweeps.reaction(
        near.boundary,
        near.lists,
        p.kinematics,
        Vectors(*acceleration),
        tables.Pressures(pressure, p.scale, isotropy(p), p.surface),
        weight,
        forces,
        out,
    )
    return out


def continuity(p, near, weight, growth):
    """What the continuity sweep finds of the fluid."""
    rate, *rest = np.zeros((12, len(p)))
    out = tables.Change(rate, Vectors(*rest[:3]), Vectors(*rest[3:6]), Traceless(*rest[6:]))
    sweeps.continuity(
        near.fluid,
        near.lists,
        p.kinematics,
        tables.Density(p.n, p.scale, p.body),
        p.vectors(VISCOUS),
        weight,
        growth,
        out,
    )
    return out


def growth_of(scheme, flow):
    """Constants of the continuity sweep with the divergence times `flow`, without diffusion, shifting and gravity."""
    return tables.Growth(scheme.number, flow, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0)


def test_pair_forces_add_up_to_nothing(weight):
    every, size = lattice((9, 8, 8), 0.1, jitter=0.3, seed=2)
    rng = np.random.default_rng(1)
    every.u[:], every.v[:], every.w[:] = rng.normal(size=(3, len(every)))
    domain, near = listed(every, size, 0.31, (True, True, True))
    p, scheme = domain.particles, Lattice(3, 0.1, 3.1, weight)
    p.p[:] = rng.uniform(-1.0, 1.0, len(every))[p.id]
    for field in isotropy(p):
        field[:] = rng.uniform(-0.1, 0.1, len(every))[p.id]
    sweep(p, near, scheme)
    for field in (p.ax, p.ay, p.az):
        total = math.fsum(field[near.fluid])
        assert abs(total) < 1e-13 * math.fsum(np.abs(field[near.fluid]))
        assert np.abs(field[near.fluid]).max() > 1


def wave_error(count, weight):
    """Largest error of the pressure gradient and the velocity divergence of a sine wave, relative, on a lattice."""
    spacing = 1.0 / count
    every, size = lattice((count, 8, 8), spacing)
    k = 2 * math.pi
    every.u[:] = np.sin(k * every.x)
    domain, near = listed(every, size, 3.1 * spacing, (True, True, True))
    p, scheme = domain.particles, Lattice(3, spacing, 3.1, weight)
    p.n[:] = scheme.number
    p.p[:] = np.sin(k * p.x)
    velocity = p.u.copy()
    p.u[:] = 0.0
    sweep(p, near, scheme)
    p.u[:] = velocity
    rate = continuity(p, near, scheme.weight, growth_of(scheme, 3.0 / scheme.number)).rate
    exact = k * np.cos(k * p.x[near.fluid])
    return [np.abs(field[near.fluid] + exact).max() / k for field in (p.ax, rate)]


def test_gradient_and_divergence_are_of_second_order_on_a_lattice(weight):
    coarse, fine = np.array(wave_error(16, weight)), np.array(wave_error(32, weight))
    order = np.log2(coarse / fine)
    assert (order > 1.8).all() and (fine < 0.06).all(), (order, fine)


def test_extremes_tell_of_what_is_not_finite():
    start, zero, bad = np.zeros((3, 2)), np.zeros(2), np.array([0.0, math.nan])
    assert moves.extremes(np.arange(2), Vectors(zero, bad, zero), Vectors(zero, zero, zero), start)[0] == math.inf
    velocity, place = Vectors(zero + 2.0, zero, zero), Vectors(zero, zero + 3.0, zero)
    assert moves.extremes(np.arange(2), velocity, place, start) == (4.0, 9.0)


@pytest.mark.parametrize("strain", [[[0.1, 0.0, 0.0], [0.0, -0.05, 0.0], [0.0, 0.0, -0.05]],
                                    [[0.0, 0.2, 0.0], [0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]])  # fmt: skip
def test_a_strained_lattice_under_even_pressure_has_no_shear_stress(weight, strain):
    """The virial of the pair forces of one particle, p sum e e W: isotropic to the second order of what it was off."""
    scheme, m = Lattice(3, 0.1, 3.1, weight), np.zeros((3, 3))
    for offset in np.ndindex(9, 9, 9):
        d = (np.eye(3) + strain) @ (0.1 * (np.array(offset) - 4.0))
        if 0.0 < (r := np.linalg.norm(d)) < scheme.radius:
            m += PLAIN[weight](np.array([r]), scheme.radius)[0] / r**2 * np.outer(d, d)
    xx, xy, xz, yz, zz = sweeps.isotropic(m[0, 0], m[0, 1], m[0, 2], m[1, 1], m[1, 2], m[2, 2], 3.0, 1.0)
    corrected = (np.eye(3) + np.array([[xx, xy, xz], [xy, -xx - zz, yz], [xz, yz, zz]])) @ m

    def uneven(matrix):
        return np.linalg.norm(matrix / np.trace(matrix) - np.eye(3) / 3.0)

    assert uneven(corrected) < 3.0 * uneven(m) ** 2 or uneven(m) * 3.0 > sweeps.LARGEST
    assert uneven(corrected) < uneven(m)
