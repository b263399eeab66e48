"""How many particles there are, and how many are where none may be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.geometry.faces import images, planes_of_walls
from parsim.geometry.rotation import matrices, to_body
from parsim.machine.jit import kernel
from parsim.observe.observer import columns
from parsim.particles.state import SURFACE
from parsim.solid.shapes.forms import reordered
from parsim.solid.shapes.kernels import distance

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Counts:
    """One row: numbers of particles, and the volume of the water by its density."""

    name = "counts"
    columns = columns(
        fluid="-",
        active="-",
        all="-",
        in_walls="-",
        in_bodies="-",
        in_gate="-",
        lost="-",
        surface="-",
        volume="m3",
        bodies_left="-",
    )

    def __init__(self, case: Case) -> None:
        self._case, self._walls, self._slack = case, planes_of_walls(case), 0.25 * case.spacing

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        p, at, count = s.domain.particles, s.near.fluid, np.zeros(3, np.int64)
        gate = (s.gate.min_x, s.gate.max_x, s.gate.barrier(s.time)) if s.gate else (0.0, 0.0, np.inf)
        places, of = images(self._case, s.bodies.position, s.bodies.radius)
        order = np.argsort(places[:, 0], kind="stable")
        bodies = (
            places[order],
            matrices(s.bodies.quaternion[of[order]]),
            reordered(s.bodies.forms, of[order]),
            s.bodies.radius.max(initial=0.0),
        )
        misplaced(at, p.place, self._walls, bodies, gate, self._slack, count)
        fluid, *rest = s.domain.count(at.size, *count, s.domain.lost, count_surface(at, p.surface))
        every = fluid + len(s.solids.walls) + len(s.solids.samples)
        (full,) = s.domain.sum((1.0 / s.scheme.compression(p, at))[:, None], 1.0)  # of m / rho, not of N
        return [
            [fluid, s.active, every, *rest, float(full) * s.scheme.lattice.volume, int((s.bodies.left < np.inf).sum())]
        ]


@kernel
def misplaced(at, place, walls, bodies, gate, slack, count):
    """Count fluid particles deeper than `slack`, m, in walls, bodies and gate into count (3,).

    walls: see `geometry.faces.planes_of_walls`; bodies in the order of their x: centre (b, 3), turn (b, 3, 3),
    forms, and the largest radius; gate: its low and high x, and where it ends below, m.
    """
    x, y, z = place
    centre, turn, forms, radius = bodies
    along = centre[:, 0].copy()
    low, high, barrier = gate
    for i in at:
        r, behind = (x[i], y[i], z[i]), False
        for w in range(len(walls)):
            within = True
            for a in range(3):
                within = within and walls[w, 4 + a] <= r[a] <= walls[w, 7 + a]
            height = walls[w, 0] * r[0] + walls[w, 1] * r[1] + walls[w, 2] * r[2] - walls[w, 3]
            behind = behind or (within and height < -slack)
        count[0] += behind
        b = np.searchsorted(along, r[0] - radius)
        while b < along.size and along[b] <= r[0] + radius:
            dx, dy, dz = r[0] - centre[b, 0], r[1] - centre[b, 1], r[2] - centre[b, 2]
            local = to_body(turn[b].ravel(), dx, dy, dz)
            count[1] += distance(forms, b, local)[0] < -slack
            b += 1
        count[2] += low + slack < r[0] < high - slack and r[2] > barrier + slack


@kernel
def count_surface(at, surface):
    """Number of particles at the surface, detached or shut in, among `at`."""
    total = 0
    for i in at:
        total += surface[i] >= SURFACE
    return total
