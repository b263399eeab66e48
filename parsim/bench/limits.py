"""Single sweeps, timed, and what bounds them: the reading of the neighbours' fields, and the arithmetic."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from parsim.fluid.wcmps import sweeps as kernels
from parsim.fluid.wcmps import tables
from parsim.fluid.wcmps.fields import VISCOUS, isotropy
from parsim.machine.jit import prange, rows
from parsim.particles.state import FLUID
from parsim.particles.tables import Traceless, Vectors

if TYPE_CHECKING:
    from parsim.run.simulation import Simulation


@rows
def gathers(at, lists, place, velocity, n, p, out):
    """Nothing but the reading of eight fields of all neighbours: out (particles,) is their sum."""
    start, end, index = lists.start, lists.end, lists.index
    x, y, z = place
    u, v, w = velocity
    for row in prange(at.size):
        i = at[row]
        total = 0.0
        for t in range(np.uint64(start[i]), np.uint64(end[i])):
            j = index[t]
            total += ((x[j] + y[j]) + (z[j] + u[j])) + ((v[j] + w[j]) + (n[j] + p[j]))
        out[i] = total


@rows
def true_pairs(at, lists, place, radius2, out):
    """Number of listed neighbours within the support: out (particles,)."""
    start, end, index = lists.start, lists.end, lists.index
    x, y, z = place
    for row in prange(at.size):
        i = at[row]
        count = 0
        for t in range(np.uint64(start[i]), np.uint64(end[i])):
            j = index[t]
            dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
            count += dx * dx + dy * dy + dz * dz < radius2
        out[i] = count


def sweeps(simulation: Simulation, calls: int) -> dict[str, float]:
    """Nanoseconds per true pair of each sweep over the fluid, of its gathers alone, and of it with all data in cache.

    `listed` is the number of listed pairs over that of true ones.
    """
    domain, near, scheme = simulation.domain, simulation.near, simulation.scheme
    p, lattice = domain.particles, scheme.lattice
    at, lists, place, velocity = near.fluid, near.lists, p.place, p.velocity
    count = np.zeros(len(p))
    true_pairs(at, lists, place, lattice.radius**2, count)
    pairs = int(count.sum())
    listed = int((near.end - near.start)[near.fluid].sum())
    close = lists._replace(index=_neighbours_in_cache(near, p))
    momentum, continuity, scratch = _passes(p, at, lattice, scheme.close2)
    works = {
        "momentum": lambda: momentum(lists),
        "continuity": lambda: continuity(lists),
        "momentum_in_cache": lambda: momentum(close),
        "continuity_in_cache": lambda: continuity(close),
        "gathers": lambda: gathers(at, lists, place, velocity, p.n, p.p, scratch),
        "lists": lambda: near.build(domain, simulation.models.reach),
    }
    return {name: 1e9 * _least(work, calls) / pairs for name, work in works.items()} | {"listed": listed / pairs}


def _passes(p, at, lattice, close2):
    """The momentum and the continuity sweep as functions of the lists, and an array that is written over."""
    out = [np.zeros(len(p)) for _ in range(12)]
    one, two, three = (Vectors(*out[k : k + 3]) for k in (0, 3, 6))
    forces = tables.Forces(lattice.own, lattice.whole, close2, 1.0, 1.0, 1.0, 1.0, 1.0)
    growth = tables.Growth(
        lattice.number, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5 * lattice.spacing, float(lattice.dimensions)
    )

    def momentum(lists):
        kernels.momentum(
            at,
            lists,
            p.kinematics,
            tables.Pressures(p.p, p.scale, isotropy(p), p.surface),
            lattice.weight,
            forces,
            one,
            tables.Around(out[9], two, three),
        )

    def continuity(lists):
        change = tables.Change(out[0], two, three, Traceless(out[1], out[2], *out[9:]))
        kernels.continuity(
            at,
            lists,
            p.kinematics,
            tables.Density(p.n, p.scale, p.body),
            p.vectors(VISCOUS),
            lattice.weight,
            growth,
            change,
        )

    return momentum, continuity, out[0]


def _neighbours_in_cache(near, p):
    """Lists of the same lengths whose entries lie in a few hundred particles, never the row's own."""
    some = np.flatnonzero(p.kind == FLUID)[:257].astype(np.uint32)
    index = near.index.copy()
    index[:] = some[np.arange(index.size) % some.size]
    for i in near.fluid[:257]:
        row = index[near.start[i] : near.end[i]]
        row[row == i] = some[-1] if i != some[-1] else some[0]
    return index


def _least(work, calls):
    work()
    times = []
    for _ in range(calls):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times)
