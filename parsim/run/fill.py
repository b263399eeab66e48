"""Where the water stands at the start: lattices in boxes, less bodies and gate, true to the volume of water.

Gaps narrower than the spacing hold no particle, and a body's underside need not lie on a lattice plane. Hence the
space that bodies take is measured finely, and as many lattice points are left out as fill it, those deepest inside
the bodies first, whole rows thinned evenly. Only what lies beside bodies is looked at.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.case.fill import level_over, profile_shares
from parsim.geometry.shuffle import scatter, swayed
from parsim.particles.lattice import Lattice, lattice_of
from parsim.particles.state import FLUID, Particles, make_id
from parsim.run.near_bodies import Beside

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from parsim.case.model import Case
    from parsim.domain.comm import Comm
    from parsim.fluid.scheme import Scheme
    from parsim.solid.bodies import Bodies

_FINE = 4  # measuring points per spacing and axis


def beside_bodies(points: Lattice, case: Case, bodies: Bodies) -> np.ndarray:
    """Numbers (n,) of the points of a Lattice that lie in bodies or within a spacing of them."""
    found = [np.zeros(0, np.int64)]
    for centre, radius in zip(bodies.position, bodies.radius, strict=True):
        reach = radius + 2.0 * case.spacing
        found.append(
            points.within(
                *((np.abs(row - centre[a]) < reach) | (a not in case.axes) for a, row in enumerate(points.rows))
            )
        )
    return np.unique(np.concatenate(found))


def taken_by_bodies(lattices: Sequence[Lattice], case: Case, bodies: Bodies, comm: Comm) -> np.ndarray:
    """Numbers (n,) of the points that are not water, since bodies and the gaps beside them take them.

    Numbers count the points of all `lattices`, one of each fill: the amount is right for all of them together. Each
    rank of `comm` measures its share of the points; all get the same.
    """
    numbers, places, spacings, first = [np.zeros(0, np.int64)], [np.zeros((0, 3))], [np.zeros((0, 3))], 0
    for points in lattices:
        found = beside_bodies(points, case, bodies)
        numbers.append(first + found)
        places.append(points.points(found))
        spacings.append(np.broadcast_to(points.spacing, (found.size, 3)))
        first += points.size
    number, place, spacing = (np.concatenate(parts) for parts in (numbers, places, spacings))
    if not number.size:
        return number
    nearest, taken = Beside(place, case, bodies).look(place)
    near = np.flatnonzero(nearest < case.spacing)
    mine = slice(near.size * comm.rank // comm.size, near.size * (comm.rank + 1) // comm.size)
    count, beside = np.zeros(near.size, np.int64), Beside(place[near[mine]], case, bodies)
    fine = (np.arange(_FINE) + 0.5) / _FINE - 0.5
    steps = [fine if a in case.axes else np.zeros(1) for a in range(3)]
    for offset in np.stack(np.meshgrid(*steps, indexing="ij"), -1).reshape(-1, 3):
        count[mine] += beside.look(place[near[mine]] + offset * spacing[near[mine]])[1]
    share = comm.sum_integers(count) / _FINE ** len(case.axes)
    depth = np.where(taken, np.minimum(nearest, -1e-9 * case.spacing), nearest)[near] / case.spacing
    # water left under one flat face comes out of it by itself, at an edge or in a gap it is flung out: that goes first
    depth -= np.where(depth < 0.0, np.abs(share - 0.5 + depth), 0.0)
    depth = np.round(depth, 6)  # points of one lattice plane are equally deep
    return number[near[np.lexsort((scatter(number[near]), depth))[: round(share.sum())]]]


def kept_out(points: Lattice, number: np.ndarray, place: np.ndarray, case: Case, bodies: Bodies) -> np.ndarray:
    """`place` (n, 3), m, of points of a Lattice that were moved; moved back where that led into bodies or the gate.

    None comes nearer than half a spacing to them that has not stood there before.
    """
    place, half = place.copy(), 0.5 * case.spacing
    near = np.flatnonzero(np.isin(number, beside_bodies(points, case, bodies)))
    even = points.points(number)
    if near.size:
        beside = Beside(even[near], case, bodies)
        before, after = (beside.look(at[near])[0] for at in (even, place))
        back = near[after < np.minimum(before, half)]
        place[back] = even[back]
    if case.gate is not None:
        before, after = (np.maximum(case.gate.min_x - at[:, 0], at[:, 0] - case.gate.max_x) for at in (even, place))
        back = after < np.minimum(before, half)
        place[back] = even[back]
    return place


def disordered(points: Lattice, number: np.ndarray, first: int, share: float, axes: Iterable[int]) -> np.ndarray:
    """Points (n, 3), m, of these numbers of a Lattice, each moved by up to `share` spacings along each of `axes`.

    The moves are a fixed shuffle of the particle's number, `first` + number; none leads beyond the outermost planes.
    """
    place = points.points(number)
    if share:
        for a in axes:
            move = swayed(3 * (first + number) + a)
            place[:, a] = np.clip(place[:, a] + share * points.spacing[a] * move, *points.rows[a][[0, -1]])
    return place


def columns(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Where the lattice planes across x of all fills are (n,), m, and how many points each has (n,)."""
    fills = [lattice_of(case, fill) for fill in case.water.fill]
    x = [points.rows[0] for points in fills]
    count = [np.full(points.rows[0].size, points.size // points.rows[0].size) for points in fills]
    return np.concatenate([np.zeros(0), *x]), np.concatenate([np.zeros(0), *count])


def water(
    case: Case,
    bodies: Bodies,
    scheme: Scheme,
    comm: Comm,
    here: Callable[[np.ndarray], np.ndarray] = lambda x: np.ones(x.size, bool),
) -> Particles:
    """The water at the start, in pressure balance: the particles at `here`(x), bool; called on all ranks together.

    Ids count the points of all fills, so that they are the same for any slab. Velocities are those of the fills, but
    for water that settles first: see `flow`.
    """
    lattices = [lattice_of(case, fill) for fill in case.water.fill]
    parts, number, taken = [], 0, taken_by_bodies(lattices, case, bodies, comm)
    for fill, points in zip(case.water.fill, lattices, strict=True):
        x, y, z = points.rows
        open_water = here(x)
        if case.gate is not None:
            open_water &= (x < case.gate.min_x) | (x > case.gate.max_x)
        mine = points.within(open_water, np.ones(y.size, bool), np.ones(z.size, bool))
        mine = mine[~np.isin(number + mine, taken)]
        place = points.points(mine)
        if case.water.disorder:
            moved = disordered(points, mine, number, case.water.disorder, case.axes)
            place = kept_out(points, mine, moved, case, bodies)
        parts.append(_particles(case, scheme, fill, place, number + mine))
        number += points.size
    fluid = Particles.join(parts) if parts else Particles(0, case.water.scheme.fields)
    if case.start >= 0.0:
        flow(case, fluid)
    return fluid


def _particles(case, scheme, fill, points, idents):
    depth = np.zeros(len(points))
    if case.water.pressure == "hydrostatic":
        depth = level_over(case.water.fill, fill, points[:, 0], points[:, 1]) - points[:, 2]
    pressure = case.water.density * -case.gravity[2] * depth
    return Particles(
        len(points),
        case.water.scheme.fields,
        id=make_id(FLUID, idents),
        kind=FLUID,
        x=points[:, 0],
        y=points[:, 1],
        z=points[:, 2],
        **scheme.at_rest(pressure),
    )


def flow(case: Case, p: Particles) -> None:
    """Give the fluid among the particles `p` the velocity of the fill it is from, at the height where it is."""
    first = 0
    for fill in case.water.fill:
        last = first + lattice_of(case, fill).size
        at = np.flatnonzero((p.kind == FLUID) & (p.id >= make_id(FLUID, first)) & (p.id < make_id(FLUID, last)))
        first = last
        if not any(fill.velocity):  # water at rest keeps what motion is left in it
            continue
        share = profile_shares(fill, p.z[at])
        for name, speed in zip(("u", "v", "w"), fill.velocity, strict=True):
            getattr(p, name)[at] = speed * share
