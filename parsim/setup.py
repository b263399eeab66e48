"""From a case to particles, bodies and models: the only place where models are built."""

import math

import numpy as np

from parsim.boundary.gate import Gate, GateSamples
from parsim.boundary.wall import Walls
from parsim.case_fill import level_over, profile_shares
from parsim.cells import HALO, REACH, Grid
from parsim.coupling import BodySamples
from parsim.domain import Domain
from parsim.errors import InputError
from parsim.films import Films
from parsim.fluid.wcmps import WCMPS
from parsim.neighbours import Neighbours
from parsim.shapes import Lattice, disordered, kept_out, taken_by_bodies
from parsim.solid.bodies import from_case
from parsim.solid.contacts import Contacts
from parsim.state import FLUID, Particles, make_id

_ROOM = 1.03  # length of the neighbour rows over that of the full lattice


def check_ranks(case, ranks):
    """Raise InputError when the box has too few layers of cells for this many ranks."""
    layers = grid_of(case, _layers(case), _reach(case)).layers
    if layers < HALO * ranks:
        raise InputError(f"{ranks} ranks: the box has {layers} layers of cells along x and a rank needs at least "
                         f"{HALO}; use at most {layers // HALO} ranks")


def _layers(case):
    """Layers of boundary particles that fill the support."""
    return math.ceil(case.water.support)


def _reach(case):
    """Radius of the neighbour lists, m."""
    return (case.water.support + case.run.skin) * case.spacing


class Models:
    """The models of one case, as attributes: scheme, bodies, contacts, gate, samples, films, domain, near."""

    def __init__(self, case, comm, timers):
        layers, self.reach = _layers(case), _reach(case)
        self.scheme = WCMPS(case, timers)
        self.bodies = from_case(case)
        self.contacts = Contacts(self.bodies, case)
        self.samples = BodySamples(case, self.bodies, layers)
        self.films = Films(case, self.bodies, self.samples, self.scheme.lattice)
        self.walls = Walls(case, layers)
        self.gate = Gate(case) if case.gate is not None else None
        self.gate_samples = GateSamples(case, self.gate, layers) if self.gate else None
        sources = [s for s in (self.samples, self.gate_samples, self.walls) if s is not None]
        self.domain = Domain(grid_of(case, layers, self.reach), comm, sources, timers=timers)
        share = (1.0 + case.run.skin / case.water.support) ** case.dimensions
        self.near = Neighbours(self.scheme.lattice.count * share * _ROOM)


def grid_of(case, layers, reach):
    """The global grid: the box, and beyond its walls and open sides the depth of the wall particles."""
    beyond = layers * case.spacing
    periodic = [getattr(case.box.faces, f"{axis}_min") == "periodic" for axis in "xyz"]
    low = [c if p else c - beyond for c, p in zip(case.box.min, periodic, strict=True)]
    high = [c if p else c + beyond for c, p in zip(case.box.max, periodic, strict=True)]
    if case.dimensions == 2:  # one cell across
        periodic[1], low[1], high[1] = False, 0.5 - reach / (2 * REACH), 0.5 + reach / (2 * REACH)
    return Grid(low, high, reach, periodic)


def columns(case):
    """Where the lattice planes across x of all fills are (n,), m, and how many points each has (n,)."""
    fills = [Lattice(fill.min, fill.max, case.spacing, case.axes) for fill in case.water.fill]
    x = [points.rows[0] for points in fills]
    count = [np.full(points.rows[0].size, points.size // points.rows[0].size) for points in fills]
    return np.concatenate([np.zeros(0), *x]), np.concatenate([np.zeros(0), *count])


def water(case, bodies, scheme, here=lambda x: np.ones(x.size, bool)):
    """The water at the start, in pressure balance: the particles at `here`(x), bool.

    Ids count the points of all fills, so that they are the same for any slab. Velocities are those of the fills, but
    for water that settles first: see `flow`.
    """
    lattices = [Lattice(fill.min, fill.max, case.spacing, case.axes) for fill in case.water.fill]
    parts, number, taken = [], 0, taken_by_bodies(lattices, case, bodies)
    for fill, points in zip(case.water.fill, lattices, strict=True):
        x, y, z = points.rows
        open_water = here(x)
        if case.gate is not None:
            open_water &= (x < case.gate.min_x) | (x > case.gate.max_x)
        mine = points.within(open_water, np.ones(y.size, bool), np.ones(z.size, bool))
        mine = mine[~np.isin(number + mine, taken)]
        place = kept_out(points, mine, disordered(points, mine, number, case.water.disorder, case.axes), case, bodies)
        parts.append(_particles(case, scheme, fill, place, number + mine))
        number += points.size
    fluid = Particles.join(parts) if parts else Particles()
    if case.start >= 0.0:
        flow(case, fluid)
    return fluid


def _particles(case, scheme, fill, points, idents):
    depth = np.zeros(len(points))
    if case.water.pressure == "hydrostatic":
        depth = level_over(case.water.fill, fill, points[:, 0], points[:, 1]) - points[:, 2]
    pressure = case.water.density * -case.gravity[2] * depth
    return Particles(
        len(points), id=make_id(FLUID, idents), kind=FLUID, x=points[:, 0], y=points[:, 1], z=points[:, 2],
        n=scheme.number_at(pressure),
    )


def flow(case, p):
    """Give the fluid among the particles `p` the velocity of the fill it is from, at the height where it is."""
    first = 0
    for fill in case.water.fill:
        last = first + Lattice(fill.min, fill.max, case.spacing, case.axes).size
        at = np.flatnonzero((p.kind == FLUID) & (p.id >= make_id(FLUID, first)) & (p.id < make_id(FLUID, last)))
        first = last
        if not any(fill.velocity):  # water at rest keeps what motion is left in it
            continue
        share = profile_shares(fill, p.z[at])
        for name, speed in zip(("u", "v", "w"), fill.velocity, strict=True):
            getattr(p, name)[at] = speed * share
