"""The free surface: who is at it, how shifting keeps within it, and the density of shifted water."""

import numpy as np
import pytest
from clouds import lattice, listed
from test_sweeps import sweep

from parsim.fluid import surface
from parsim.fluid.weights import Lattice
from parsim.state import DETACHED, FLUID, INTERNAL, SURFACE, VICINITY


@pytest.fixture
def slab():
    """A lattice block of water with a free top and one particle apart, periodic in x and y."""
    every, size = lattice((8, 8, 6), 0.1)
    apart = every.take([0])
    apart.id[:], apart.z[:] = 10**6, 1.1
    every = every.join([every, apart])
    domain, near = listed(every, [size[0], size[1], 1.5], 0.31, (True, True, False))
    p, scheme = domain.particles, Lattice(3, 0.1, 3.1)
    p.n[:] = scheme.number
    p.c[:] = sweep(p, near, scheme)
    surface.classify(near.fluid, near.start, near.end, near.index, p.x, p.y, p.z, p.c, 0.1, 0.4, 0.9, p.surface, p.nx,
                     p.ny, p.nz)
    domain.refresh("surface", "nx", "ny", "nz", "c")
    return domain, near, scheme


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
    domain, near, scheme = slab
    p = domain.particles
    p.ax[:], p.ay[:], p.az[:] = 0.3, 0.0, -1.0  # a concentration that falls upward, as at any free surface
    surface.shift(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.nx, p.ny, p.nz,
                  p.c, p.scale, p.body, domain.near(SURFACE, "surface"), scheme.radius, 0.21**2, 0.004, 0.01,
                  scheme.number, scheme.cut, 0.0, 0.0, -1.0, 0.1, 0.005, p.ax, p.ay, p.az, p.surface, p.n)
    at, z = near.fluid, p.z[near.fluid]
    assert p.az[at[np.abs(z - 0.55) < 0.01]] == pytest.approx(0.0, abs=1e-12)
    assert p.ax[at[np.abs(z - 0.55) < 0.01]] == pytest.approx(-0.0012)
    assert (p.surface[at[np.abs(z - 0.45) < 0.01]] == VICINITY).all()
    assert p.az[at[np.abs(z - 0.45) < 0.01]] == pytest.approx(0.0, abs=1e-12)
    assert p.az[at[np.abs(z - 0.15) < 0.01]] == pytest.approx(0.004), "away from a surface is allowed"
    assert (p.ax[at[z > 1.0]] == 0.0).all() and (p.az[at[z > 1.0]] == 0.0).all()


def shifted_density(domain, near, scheme, pull):
    """Number density of the fluid after a shift with the recovery `pull`, from 1.01 times that of the lattice."""
    p = domain.particles
    p.n[:], p.ax[:], p.ay[:], p.az[:] = 1.01 * scheme.number, 0.0, 0.0, 0.0
    surface.shift(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.nx, p.ny, p.nz,
                  p.c, p.scale, p.body, domain.near(SURFACE, "surface"), scheme.radius, 0.21**2, 0.004, 0.01,
                  scheme.number, scheme.cut, 0.0, 0.0, -1.0, pull, 0.005, p.ax, p.ay, p.az, p.surface, p.n)
    return p.n[near.fluid] / scheme.number


def test_density_goes_back_to_that_of_the_arrangement_where_no_surface_is_near(slab):
    domain, near, scheme = slab
    density, at_surface = shifted_density(domain, near, scheme, 0.1), domain.particles.surface[near.fluid] >= SURFACE
    assert density[at_surface] == pytest.approx(1.005) and at_surface.any(), "kept where the flow can have it"
    assert density[~at_surface] == pytest.approx(1.01), "all the others of the slab see a surface"
    every, size = lattice((8, 8, 8), 0.1)
    domain, near = listed(every, size, 0.31, (True, True, True))
    scheme = Lattice(3, 0.1, 3.1)
    domain.particles.n[:] = scheme.number
    domain.particles.c[:] = sweep(domain.particles, near, scheme)
    assert shifted_density(domain, near, scheme, 0.1) == pytest.approx(1.009, abs=1e-12)


def test_the_packing_makes_up_for_what_a_surface_cuts_off(slab):
    domain, near, scheme = slab
    p = domain.particles
    inside = near.fluid[(p.z[near.fluid] > 0.1) & (p.z[near.fluid] < 0.5)]
    assert p.c[inside].min() < 0.95
    for i in inside:
        row = near.index[near.start[i] : near.end[i]]
        away = np.stack([p.x[row] - p.x[i], p.y[row] - p.y[i], p.z[row] - p.z[i]], 1)
        r = np.sqrt((away**2).sum(1))
        weight = np.maximum(scheme.radius / r - 1.0, 0.0)
        slow = weight.sum() + scheme.cut * np.sqrt(((weight / r) @ away) @ ((weight / r) @ away))
        given = near.start[i], near.middle[i], near.end[i], near.index
        fast = surface.packing(i, *given, p.x, p.y, p.z, p.scale, scheme.radius, scheme.cut)
        assert fast == pytest.approx(slow, rel=1e-12)
        assert fast == pytest.approx(scheme.number, rel=0.05)


def test_the_cells_near_the_surface_hold_all_that_list_a_surface_particle(slab):
    domain, near, _ = slab
    p = domain.particles
    p.surface[p.x > p.x.mean()] = INTERNAL
    expected = [(p.surface[near.index[near.start[i] : near.middle[i]]] == SURFACE).any() for i in near.fluid]
    flagged = domain.near(SURFACE, "surface")[near.fluid]
    assert flagged[expected].all() and any(expected)
    assert not domain.near(77, "surface").any()


def test_shifts_are_cut_to_their_longest(slab):
    domain, near, scheme = slab
    p = domain.particles
    p.ax[:], p.ay[:], p.az[:] = 30.0, 40.0, 0.0
    surface.shift(near.fluid, near.start, near.middle, near.end, near.index, p.x, p.y, p.z, p.nx, p.ny, p.nz,
                  p.c, p.scale, p.body, domain.near(SURFACE, "surface"), scheme.radius, 0.21**2, 0.004, 0.01,
                  scheme.number, scheme.cut, 0.0, 0.0, -1.0, 0.1, 0.005, p.ax, p.ay, p.az, p.surface, p.n)
    moved = np.sqrt(p.ax**2 + p.ay**2 + p.az**2)[near.fluid]
    assert moved.max() == pytest.approx(0.01) and (p.kind[near.fluid] == FLUID).all()
