"""Cells, domain and neighbour lists against plain all-pairs search."""

import numpy as np
import pytest
from clouds import cloud, lattice, listed

from parsim.domain.balance import even_cuts, uneven
from parsim.particles.cells import HALO, LAYERS, REACH, Grid, Stack, occupied, sort_by_cell, sort_key, spread
from parsim.particles.sight import cut_rows, hidden
from parsim.particles.state import COMMON, FLUID, GATE_DOWN, GATE_UP, Particles
from parsim.particles.tables import Lists, Vectors


def test_sort_is_by_cell_then_id():
    rng = np.random.default_rng(1)
    cell, ident = rng.integers(0, 7, 200), rng.permutation(200)
    order, first = sort_by_cell(cell, ident, 7)
    assert order.tolist() == np.lexsort((ident, cell)).tolist()
    assert first.tolist() == np.searchsorted(np.sort(cell), np.arange(8)).tolist()


def test_points_on_the_sides_of_cells_belong_to_the_upper_cell():
    grid = Grid([0, 0, 0], [1.0, 1.0, 1.0], 0.5, (False, False, False))
    assert grid.edge.tolist() == [0.25] * 3
    x = np.array([0.0, 0.25, 0.5, 0.75, np.nextafter(0.5, 0), 1.0, -0.1])
    assert grid.layer(x).tolist() == [LAYERS * k for k in (0, 1, 2, 3)] + [2 * LAYERS - 1, 4 * LAYERS - 1, 0]
    assert grid.cell(np.zeros(7, np.int64), x, 0 * x).tolist() == [4 * k for k in (0, 1, 2, 3, 1, 3, 0)]
    assert grid.cell(np.full(7, 2), 0 * x, x).tolist() == [32 + k for k in (0, 1, 2, 3, 1, 3, 0)]


@pytest.mark.parametrize("begin, end", [(0, 32), (3, 21), (8, 29), (5, 40)])
def test_a_stack_keeps_halos_and_owned_layers_in_pieces_of_their_own(begin, end):
    stack = Stack(begin, end)
    owner = np.repeat([0, 1, 2], [HALO, end - begin, HALO])
    column = np.arange(begin - HALO, end + HALO) // LAYERS
    parts = sorted(set(zip(column, owner, strict=True)))
    assert stack.piece.tolist() == [parts.index(part) for part in zip(column, owner, strict=True)]
    assert stack.column.tolist() == [part[0] - column[0] for part in parts]
    assert [parts[k][1] for k in range(*stack.own.indices(99))] == [1] * (stack.own.stop - stack.own.start)
    for k in range(stack.pieces.size - 1):
        assert (stack.column[stack.pieces[k] : stack.pieces[k + 1]] == k).all()
    assert stack.pieces[-1] == len(parts)


def test_a_part_of_a_cell_is_sorted_like_the_whole():
    rng = np.random.default_rng(3)
    layer, ident = rng.integers(LAYERS, 2 * LAYERS, 40), rng.permutation(40)
    order, _ = sort_by_cell(np.zeros(40, np.int64), sort_key(layer, ident), 1)
    part = layer < LAYERS + 3
    below, _ = sort_by_cell(np.zeros(part.sum(), np.int64), sort_key(layer[part], ident[part]), 1)
    assert ident[order][: part.sum()].tolist() == ident[part][below].tolist()


def test_periodic_edges_divide_the_period_and_leave_room_for_images():
    grid = Grid([0, 0, 0], [1.0, 1.0, 0.9], 0.37, (True, False, True))
    assert grid.layers == 5 * LAYERS and grid.count.tolist() == [5, 5, 4 + 2 * REACH]
    assert grid.edge[2] * 4 == pytest.approx(0.9)


def test_marks_spread_as_a_cube():
    marks = np.zeros((5, 6, 7), np.uint8)
    marks[2, 0, 3] = 1
    grown = spread(marks, 2)
    assert grown[:, :3, 1:6].all() and grown.sum() == 5 * 3 * 5


def test_occupied_finds_the_cells_of_particles():
    assert occupied(np.array([3, 1, 3]), 5).tolist() == [0, 1, 0, 1, 0]


def naive(p, i, radius, size, periodic):
    """Sorted ids of the fluid and the boundary neighbours of particle i by looking at everything."""
    offset = np.stack([p.x - p.x[i], p.y - p.y[i], p.z - p.z[i]])
    for axis in range(3):
        if periodic[axis]:
            offset[axis] -= np.rint(offset[axis] / size[axis]) * size[axis]
    close = ((offset**2).sum(axis=0) < radius**2) & (np.arange(len(p)) != i)
    return sorted(p.id[close & (p.kind == FLUID)]), sorted(p.id[close & (p.kind != FLUID)])


@pytest.mark.parametrize("periodic", [(False, False, False), (True, False, False), (True, True, True)])
def test_lists_hold_what_a_plain_search_finds(periodic):
    size, radius = np.array([1.3, 0.9, 0.7]), 0.2
    every = cloud(500, size, seed=4, walls=200)
    domain, near = listed(every, size, radius, periodic)
    p, number = domain.particles, {ident: k for k, ident in enumerate(every.id)}
    assert sorted(p.id[near.fluid]) == sorted(every.id[every.kind == FLUID])
    for i in near.fluid:
        fluid, walls = naive(every, number[p.id[i]], radius, size, periodic)
        assert sorted(p.id[near.index[near.start[i] : near.middle[i]]]) == fluid
        assert sorted(p.id[near.index[near.middle[i] : near.end[i]]]) == walls
    for i in near.boundary:
        assert near.end[i] == near.middle[i]
        assert (
            sorted(p.id[near.index[near.start[i] : near.middle[i]]])
            == naive(every, number[p.id[i]], radius, size, periodic)[0]
        )


def test_a_row_comes_in_the_order_of_memory():
    every, size = lattice((8, 8, 8), 0.1, jitter=0.3)
    domain, near = listed(every, size, 0.25, (False, True, True))
    for i in near.fluid:
        row = near.index[near.start[i] : near.middle[i]].astype(int)
        assert (np.diff(row) > 0).all()


def test_refresh_brings_fields_to_images_and_halos():
    every, size = lattice((8, 6, 6), 0.1, jitter=0.3)
    domain, near = listed(every, size, 0.25, (True, True, True))
    p = domain.particles
    p.x[near.fluid] += 0.01
    p.n[near.fluid] = p.id[near.fluid] + 0.5
    domain.refresh("x", "n")
    assert (p.n == p.id + 0.5).all()
    moved = every.x[np.argsort(every.id)][p.id] + 0.01
    assert np.abs((p.x - moved) / size[0] - np.rint((p.x - moved) / size[0])).max() < 1e-12


def blocked(a, b, low, high, barrier):
    """Whether a fine walk along the segment meets the plate."""
    t = np.linspace(0, 1, 20001)
    x, z = a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])
    return bool(((x >= low) & (x <= high) & (z >= barrier)).any())


def test_the_gate_hides_what_a_walk_along_the_segment_meets():
    rng = np.random.default_rng(5)
    for _ in range(300):
        a, b = rng.uniform(0, 1, 2), rng.uniform(0, 1, 2)
        assert hidden(*a, *b, 0.45, 0.55, 0.5) == blocked(a, b, 0.45, 0.55, 0.5)
    assert hidden(0.4, 0.2, 0.6, 0.2, 0.45, 0.55, -np.inf)
    assert not hidden(0.4, 0.2, 0.44, 0.9, 0.45, 0.55, -np.inf)


def test_each_side_of_the_gate_meets_its_own_samples_only():
    x = np.array([0.4, 0.6, 0.5, 0.5, 0.5, 0.62, 0.38])
    z = np.array([0.8, 0.8, 0.1, 0.7, 0.7, 0.8, 0.8])
    kind = np.array([FLUID, FLUID, FLUID, GATE_UP, GATE_DOWN, GATE_UP, GATE_DOWN], np.uint8)
    index = np.array([1, 2, 3, 4, 5, 6, 0, 2, 3, 4, 5, 6, 0, 1, 3, 4, 5, 6], np.uint32)
    start, middle, end = np.array([0, 6, 12]), np.array([2, 8, 14]), np.array([6, 12, 18])
    cut_rows(np.arange(3), Vectors(x, x, z), kind, (0.45, 0.55, 0.5), Lists(start, middle, end, index))
    rows = [[list(index[start[i] : middle[i]]), list(index[middle[i] : end[i]])] for i in range(3)]
    assert rows[0] == [[2], [3, 5]]  # upstream: the sample behind the plate is its own, the other side's is not
    assert rows[1] == [[2], [4, 6]]
    assert rows[2][0] == [0, 1] and rows[2][1] == [4]  # below the edge: what is inside the plate, once


def test_cuts_split_the_work_evenly_and_leave_room_for_halos():
    work = np.array([0, 0, 5, 5, 5, 5, 1, 1, 1, 1, 1, 1]).repeat(HALO)
    assert even_cuts(work, 2).tolist() == [0, round(4.6 * HALO), 12 * HALO]
    assert even_cuts(np.arange(3 * HALO) == 0, 3).tolist() == [0, HALO, 2 * HALO, 3 * HALO]
    assert uneven(work, np.array([0, 6 * HALO, 12 * HALO])) == pytest.approx(20 / 13)
    assert (np.diff(even_cuts(np.ones(8 * HALO + 1, np.int64), 8)) >= HALO).all()


def test_pack_and_unpack_keep_every_kept_field():
    every = cloud(17, np.ones(3), seed=9, walls=3)
    back = Particles.unpack(every.pack(), every.fields)
    assert all((getattr(back, name) == getattr(every, name)).all() for name in ("id", "kind", "x", "n", "scale"))
    assert len(Particles.unpack(Particles(0).pack(), COMMON)) == 0
