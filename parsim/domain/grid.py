"""The grid of cells of a case, and how many ranks can share it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.errors import InputError
from parsim.geometry.faces import repeats
from parsim.particles.cells import HALO, REACH, Grid

if TYPE_CHECKING:
    from parsim.case.model import Case


def check_ranks(case: Case, ranks: int) -> None:
    """Raise InputError when the box has too few layers of cells for this many ranks, or repeats too soon."""
    grid = grid_of(case)
    layers, cells = grid.layers, grid.count - 2 * grid.pad
    short = [axis for axis in case.axes if grid.periodic[axis] and cells[axis] < REACH]
    if short and (case.water.scheme.WET or short[0] == 0):  # else a particle would see but one of its images
        raise InputError(
            f"box.min, box.max: {'xyz'[axis]} repeats after {case.box.size[axis]:g} m; must be {case.reach:.6g} m or "
            "more, the radius of the neighbour lists"
            for axis in short
        )
    if layers < HALO * ranks:
        raise InputError(
            f"{ranks} ranks: the box has {layers} layers of cells along x and a rank needs at least "
            f"{HALO}; use at most {layers // HALO} ranks"
        )


def grid_of(case: Case) -> Grid:
    """The global grid: the box, and beyond its walls and open sides the depth of the wall particles."""
    beyond, reach = case.layers * case.spacing, case.reach
    periodic = repeats(case)
    low = [c if p else c - beyond for c, p in zip(case.box.min, periodic, strict=True)]
    high = [c if p else c + beyond for c, p in zip(case.box.max, periodic, strict=True)]
    if case.dimensions == 2:  # one cell across
        low[1], high[1] = 0.5 - reach / (2 * REACH), 0.5 + reach / (2 * REACH)
    return Grid(low, high, reach, periodic)
