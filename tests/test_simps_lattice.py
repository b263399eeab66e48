"""The lattice before the pressure equation: iterations for any number of particles, symmetry, the same pressures."""

import numpy as np
import pytest
from flows import fluid, merged, simulation, tank
from test_simps import BLOCKS, still

from parsim.fluid.simps.coarse import Coarse
from parsim.fluid.simps.multigrid import Multigrid
from parsim.fluid.simps.solver import Solver

SHAPES = {
    "plane": ((7, 1, 9), (False, False, False)),
    "rings": ((8, 6, 5), (True, True, False)),
    "odd rings": ((5, 7, 3), (True, True, True)),
    "thin": ((2, 3, 12), (False, True, False)),
    "one": ((1, 1, 1), (False, False, True)),
}


def square(rows, **scheme):
    """A tank as long as its water is deep, 2D, that deep in `rows` of particles."""
    return merged(tank(0.2, 0.3, 0.2 / rows, (0.2, 0.2)), {"water": {"scheme": {"kind": "simps", **scheme}}})


def cold(case, steps=2):
    """Iterations of a step that begins with no pressures, after some other steps."""
    s = simulation(case)
    for _ in range(steps):
        s.step()
    s.domain.particles.p[:] = 0.0
    s.step()
    return s.scheme.solver.iterations


def asked(case, steps=3):
    """The last that the solver was asked: flow, equation, its diagonal with the bodies in it, solver."""
    found, solve = {}, Solver.solve

    def look(self, flow, equation, mobility, factor, time):
        forces = solve(self, flow, equation, mobility, factor, time)
        diagonal = equation.diagonal.copy()
        if mobility:
            mobility.diagonal(factor, diagonal)
        found.update(flow=flow, equation=equation, diagonal=diagonal, mobility=mobility, factor=factor, solver=self)
        return forces

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Solver, "solve", look)
        s = simulation(case)
        for _ in range(steps):
            s.step()
    return found


def box(shape, ring):
    """A `Multigrid` of edges and holds at random, and its dense matrix."""
    rng, grid = np.random.default_rng(3), Multigrid(shape, ring)
    count = grid.size
    grid.edges[:, :count] = rng.uniform(0.5, 1.5, (3, count))
    grid.held[:count] = rng.uniform(0.0, 0.02, count)
    at, matrix = np.arange(count).reshape(shape), np.diag(grid.held[:count])
    for axis in range(3):
        edges = np.moveaxis(grid.edges[axis, :count].reshape(shape), axis, 0)
        if not ring[axis] or shape[axis] == 1:
            edges[-1] = 0.0
        one, two, c = at.ravel(), np.roll(at, -1, axis).ravel(), grid.edges[axis, :count]
        for i, j, sign in ((one, one, 1.0), (two, two, 1.0), (one, two, -1.0), (two, one, -1.0)):
            np.add.at(matrix, (i, j), sign * c)
    grid.prepare()
    return grid, matrix


@pytest.mark.parametrize("name", SHAPES)
def test_a_cycle_is_symmetric_and_close_to_the_inverse(name):
    grid, matrix = box(*SHAPES[name])
    columns, products = [], []
    for unit in np.eye(grid.size):
        values, product = grid.solve(unit)
        columns.append(values.copy())
        products.append(product)
    cycle = np.array(columns)
    assert np.abs(cycle - cycle.T).max() < 1e-12 * np.abs(cycle).max()
    assert products == pytest.approx(np.diag(cycle))
    found = np.linalg.eigvals(cycle @ matrix)
    assert np.abs(found.imag).max() < 1e-9
    assert found.real.min() > 0.35 and found.real.max() < 1.0 + 1e-9


def test_nodes_that_nothing_touches_stay_out():
    grid, _ = box((6, 1, 6), (False,) * 3)
    grid.edges[:, : grid.size].reshape(3, 6, 6)[:, 3:] = 0.0
    grid.edges[0, : grid.size].reshape(6, 6)[2:] = 0.0
    grid.held[: grid.size].reshape(6, 6)[3:] = 0.0
    grid.prepare()
    right = np.zeros((6, 6))
    right[:3] = 1.0
    values, product = grid.solve(right.ravel())
    assert np.isfinite(values).all() and product > 0.0


@pytest.mark.parametrize("across", [None, 0.08])
@pytest.mark.parametrize("periodic", ["", "x"])
def test_the_preconditioner_is_symmetric_and_positive(across, periodic):
    case = tank(0.2, 0.3, 0.01, (0.2, 0.1), across, periodic + ("y" if across and periodic else ""))
    a = asked(merged(case, {"water": {"scheme": {"kind": "simps"}}}))
    coarse, flow, at = a["solver"].coarse, a["flow"], a["flow"].near.fluid
    coarse.prepare(flow, a["equation"], a["diagonal"])
    rng = np.random.default_rng(7)

    def through(r):
        z = r / a["diagonal"][at]
        norm = np.sqrt((r * z).sum())
        left = z.copy()
        product = coarse.spread(flow.domain.whole(coarse.gather(r, norm)), left)
        assert product == pytest.approx((r * (left - z)).sum(), rel=1e-6)
        return left

    for _ in range(3):
        one, two = rng.normal(size=(2, at.size))
        a_two, a_one = one @ through(two), two @ through(one)
        assert a_one == pytest.approx(a_two, abs=1e-8 * np.sqrt((one @ through(one)) * (two @ through(two))))
        assert one @ through(one) > (one * one / a["diagonal"][at]).sum()
    even = through(np.ones(at.size))
    assert even @ np.ones(at.size) > 5.0 * (1.0 / a["diagonal"][at]).sum(), "the lattice sees what is smooth"


def test_iterations_do_not_grow_with_the_number_of_particles():
    """1e3, 1e4 and 4e4 particles; by the diagonal alone 56, 164 and about 330."""
    found = [cold(square(rows)) for rows in (32, 100, 200)]
    assert max(found) <= 1.3 * min(found) and max(found) <= 20
    assert cold(square(32, preconditioner="diagonal")) > 2.5 * found[0]


def test_iterations_are_few_in_three_dimensions_around_a_ring_and_with_light_bodies():
    deep = tank(0.3, 0.3, 0.02, (0.3, 0.2), 0.2, "xy")
    assert cold(merged(deep, {"water": {"scheme": {"kind": "simps"}}})) <= 20
    assert cold(still(0.005, bodies=BLOCKS)) <= 25


def test_pressures_are_those_of_the_diagonal_alone():
    found = []
    for name in ("lattice", "diagonal"):
        s = simulation(still(bodies=BLOCKS, preconditioner=name, tolerance=1e-9))
        for _ in range(4):
            s.step()
        p, at = fluid(s)
        found.append((p.p[at], s.bodies.velocity.copy()))
    assert found[0][0] == pytest.approx(found[1][0], abs=1e-5 * 9810.0 * 0.2)
    assert found[0][1] == pytest.approx(found[1][1], abs=1e-5)


def test_a_residual_out_of_bounds_is_no_number():
    a = asked(still())
    coarse, at = a["solver"].coarse, a["flow"].near.fluid
    coarse.prepare(a["flow"], a["equation"], a["diagonal"])
    for wrong in (1e30, np.nan):
        r = np.ones(at.size)
        r[3] = wrong
        coarse.gather(r, 1.0)
        assert np.isnan(r).all()


def test_a_box_of_water_bounds_the_lattice():
    case = simulation(square(32)).case
    s = simulation(square(32))
    s.step()
    coarse = s.scheme.solver.coarse
    assert isinstance(coarse, Coarse) and case.dimensions == 2
    count = coarse._frame.count
    assert count[1] == 1 and count[0] == count[2] == 32 // 4 + 1
