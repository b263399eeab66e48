"""The free surface: who is at it, how shifting keeps within it, and the density of shifted water."""

import numpy as np
import pytest
from clouds import PLAIN, lattice, listed
from test_sweeps import sweep

from parsim.fluid import recovery, shifting, surface
from parsim.fluid.reference import Lattice
from parsim.fluid.wcmps.fields import NORMAL
from parsim.fluid.weights import WEIGHTS
from parsim.particles.state import DETACHED, FLUID, INTERNAL, SURFACE, VICINITY, WALL, make_id
from parsim.particles.tables import Lists

DOWN = (0.0, 0.0, -1.0)


def found(domain, near, scheme):
    """Domain and lists of a cloud, its concentrations and surface found with the constants of the lattice."""
    p = domain.particles
    p.n[:] = scheme.number
    p.c[:] = sweep(p, near, scheme)
    bounds = surface.Bounds(scheme.spacing, scheme.lowest, scheme.highest)
    surface.classify(near.fluid, near.lists, p.place, p.c, bounds, p.surface, p.vectors(NORMAL))
    domain.refresh("surface", "nx", "ny", "nz", "c")
    return domain, near, scheme


def shift(domain, near, scheme, pull=0.1, slope=0.0):
    """Shift the fluid, 0.004 m2 times the sums that the fields ax, ay, az hold, at most 0.01 m."""
    p = domain.particles
    at = near.fluid
    surface.clamp(at, near.lists, p.surface, scheme.number, 0.005, p.n)
    surface.mark(at, near.lists, p.place, scheme.weight, domain.near(SURFACE, "surface"), p.surface, p.vectors(NORMAL))
    recovery.recover(
        at, near.lists, p.place, (p.scale, p.body), (p.c, p.surface), scheme.weight, recovering(scheme, pull), p.n
    )
    constants = shifting.Shifting(0.004, 0.01, *DOWN, scheme.number * slope)
    shifting.shift(at, p.surface, p.vectors(NORMAL), constants, p.acceleration, p.n)


def recovering(scheme, pull):
    """Constants of the recovery by the share `pull`."""
    return recovery.Recovery(
        scheme.radius**2, 0.21**2, scheme.number, scheme.own, scheme.whole, scheme.cut, *DOWN, pull, 0.8 * pull
    )


@pytest.fixture(params=WEIGHTS)
def slab(request):
    """A lattice block of water with a free top and one particle apart, periodic in x and y."""
    every, size = lattice((8, 8, 6), 0.1)
    apart = every.take([0])
    apart.id[:], apart.z[:] = 10**6, 1.1
    every = every.join([every, apart])
    domain, near = listed(every, [size[0], size[1], 1.5], 0.31, (True, True, False))
    return found(domain, near, Lattice(3, 0.1, 3.1, request.param))


@pytest.fixture(params=WEIGHTS)
def shallow(request):
    """Three rows of water on a bed of three rows of wall, on one lattice, periodic in x and y."""
    every, size = lattice((8, 8, 6), 0.1)
    low = every.z < 0.3
    every.kind[low], every.id[low] = WALL, make_id(WALL, np.arange(low.sum()))
    domain, near = listed(every, [size[0], size[1], 1.0], 0.31, (True, True, False))
    return found(domain, near, Lattice(3, 0.1, 3.1, request.param))


def test_a_drop_does_not_pull():
    """Of up to four particles: one on a body, which turns it out all the time, has lifted it for ever."""
    start = np.array([0, 3, 7, 7])
    lists = Lists(start, start + [3, 4, 0, 9], start + [3, 4, 0, 9], np.zeros(16, np.int64))
    n = np.full(4, 0.9)
    surface.clamp(np.arange(4), lists, np.array([SURFACE, SURFACE, DETACHED, INTERNAL]), 1.0, 0.005, n)
    assert n.tolist() == [1.0, 0.995, 1.0, 0.9]


def test_the_top_and_bottom_of_a_free_slab_are_its_surface(slab):
    domain, near, _ = slab
    p = domain.particles
    z, state = p.z[near.fluid], p.surface[near.fluid]
    assert (state[z > 1.0] == DETACHED).all() and (z > 1.0).sum() == 1
    assert (state[np.abs(z - 0.55) < 0.01] == SURFACE).all() and (state[z < 0.1] == SURFACE).all()
    assert (state[(z > 0.1) & (z < 0.5)] == INTERNAL).all()
    top = near.fluid[np.abs(z - 0.55) < 0.01]
    assert p.nz[top] == pytest.approx(1.0) and p.nx[top] == pytest.approx(0.0, abs=1e-12)


def test_shifting_never_moves_water_out_through_the_surface(slab):
    domain, near, _ = slab
    p = domain.particles
    p.ax[:], p.ay[:], p.az[:] = 0.3, 0.0, -1.0  # sums that point downward, as at any free surface
    shift(*slab)
    at, z = near.fluid, p.z[near.fluid]
    assert p.az[at[np.abs(z - 0.55) < 0.01]] == pytest.approx(0.0, abs=1e-12)
    assert p.ax[at[np.abs(z - 0.55) < 0.01]] == pytest.approx(-0.0012)
    assert (p.surface[at[(z > 0.1) & (z < 0.5)]] == VICINITY).all(), "all that see the surface"
    assert p.az[at[np.abs(z - 0.45) < 0.01]] == pytest.approx(0.0, abs=1e-12)
    assert p.az[at[np.abs(z - 0.15) < 0.01]] == pytest.approx(0.004), "away from a surface is allowed"
    assert (p.ax[at[z > 1.0]] == 0.0).all() and (p.az[at[z > 1.0]] == 0.0).all()


def shifted_density(domain, near, scheme, pull):
    """Number density of the fluid after a shift with the recovery `pull`, from 1.01 times that of the lattice."""
    p = domain.particles
    p.n[:], p.ax[:], p.ay[:], p.az[:] = 1.01 * scheme.number, 0.0, 0.0, 0.0
    shift(domain, near, scheme, pull)
    return p.n[near.fluid] / scheme.number


def test_density_goes_back_to_that_of_the_arrangement_where_no_surface_is_near(slab):
    domain, near, scheme = slab
    density, at_surface = shifted_density(domain, near, scheme, 0.1), domain.particles.surface[near.fluid] >= SURFACE
    assert density[at_surface] == pytest.approx(1.005) and at_surface.any(), "kept where the flow can have it"
    assert density[~at_surface] == pytest.approx(1.01), "all the others of the slab see a surface"
    every, size = lattice((8, 8, 8), 0.1)
    domain, near = listed(every, size, 0.31, (True, True, True))
    assert shifted_density(*found(domain, near, scheme), 0.1) == pytest.approx(1.009, abs=1e-12)


def packed(p, near, i, scheme):
    """Measure of a particle and its neighbours with what a surface has cut off, over that of the lattice, plainly."""
    row = near.index[near.start[i] : near.end[i]]
    away = np.stack([p.x[row] - p.x[i], p.y[row] - p.y[i], p.z[row] - p.z[i]], 1)
    r = np.sqrt((away**2).sum(1))
    measure = PLAIN[type(scheme.weight).__module__.split(".")[-1]](r, scheme.radius)[1] * p.scale[row]
    return (scheme.own + measure.sum() + scheme.cut * np.linalg.norm((measure / r) @ away)) / scheme.whole


def test_shallow_water_goes_back_to_that_of_its_packing(shallow):
    domain, near, scheme = shallow
    p = domain.particles
    inside = p.z[near.fluid] < 0.5
    assert (p.surface[near.fluid] == np.where(inside, INTERNAL, SURFACE)).all()
    expected = [1.01 + 0.8 * 0.1 * (packed(p, near, i, scheme) - 1.01) for i in near.fluid[inside]]
    assert shifted_density(domain, near, scheme, 0.1)[inside] == pytest.approx(expected, rel=1e-12)


def test_shifted_water_takes_the_hydrostatic_density_of_its_new_place(slab):
    domain, near, scheme = slab
    p = domain.particles
    p.ax[:], p.ay[:], p.az[:] = 0.3, 0.0, np.where(p.z < 0.3, -1.0, 1.0)
    shift(*slab, slope=0.5)
    free = p.surface[near.fluid] < DETACHED
    assert np.abs(p.az[near.fluid[free]]).max() == pytest.approx(0.004)
    assert p.n[near.fluid] == pytest.approx(scheme.number * (1.0 - 0.5 * p.az[near.fluid]), rel=1e-12)


def test_the_packing_makes_up_for_what_a_surface_cuts_off(slab):
    domain, near, scheme = slab
    p = domain.particles
    inside = near.fluid[(p.z[near.fluid] > 0.1) & (p.z[near.fluid] < 0.5)]
    assert p.c[inside].min() < 0.98
    for i in inside:
        fast = scheme.own + recovery.packing(i, near.lists, p.place, p.scale, scheme.weight, scheme.cut)
        assert fast == pytest.approx(packed(p, near, i, scheme) * scheme.whole, rel=1e-12)
        assert fast == pytest.approx(scheme.whole, rel=2e-4)


def test_the_cells_near_the_surface_hold_all_that_list_a_surface_particle(slab):
    domain, near, _ = slab
    p = domain.particles
    p.surface[p.x > p.x.mean()] = INTERNAL
    expected = [(p.surface[near.index[near.start[i] : near.middle[i]]] == SURFACE).any() for i in near.fluid]
    flagged = domain.near(SURFACE, "surface")[near.fluid]
    assert flagged[expected].all() and any(expected)
    assert not domain.near(77, "surface").any()


def test_shifts_are_cut_to_their_longest(slab):
    domain, near, _ = slab
    p = domain.particles
    p.ax[:], p.ay[:], p.az[:] = 30.0, 40.0, 0.0
    shift(*slab)
    moved = np.sqrt(p.ax**2 + p.ay**2 + p.az**2)[near.fluid]
    assert moved.max() == pytest.approx(0.01) and (p.kind[near.fluid] == FLUID).all()
