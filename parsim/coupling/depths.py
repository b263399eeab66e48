"""How deep the water is, column by column, and where ice lies on it: what the length of eddies depends on.

Columns are two spacings wide. Their bottom is the floor, or what is fixed and stands on it; their top the highest
water, or the underside of the lowest other body, which covers them if it rubs. Seen anew at every rebuild.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.fluid.turbulence import Depths
from parsim.particles.state import BODY, DETACHED

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.fluid.scheme import Flow
    from parsim.solid.bodies import Bodies

_EDGE = 2.0  # spacings
_STANDS = 1.0  # spacings over the floor up to which the lowest point of what stands on it may be


class Columns:
    """The columns of a case, `depths` of them: see `turbulence.Depths`."""

    def __init__(self, case: Case, bodies: Bodies) -> None:
        low, size, self._half = case.box.min, case.box.size, 0.5 * case.spacing
        edge, self._end = _EDGE * case.spacing, case.box.max[0]
        nx, ny = (max(math.ceil(size[a] / edge - 1e-9), 1) if a in case.axes else 1 for a in (0, 1))
        self._floor, count, friction = low[2], nx * ny, case.water.friction
        self._rub = friction is not None and friction.bodies
        lowest = bodies.position[:, 2] - bodies.reaches()[:, 2] if len(bodies) else np.zeros(0)
        self._ground = bodies.fixed & (lowest <= self._floor + _STANDS * case.spacing)
        none = np.full(count, -math.inf)
        self.depths = Depths(low[0], low[1], edge, nx, ny, none, none, np.zeros(count, bool))

    def find(self, flow: Flow) -> None:
        """Look at this rank's particles, and share what is found."""
        p, own, d = flow.particles, flow.domain.own, self.depths
        kind, body, z = p.kind[own], p.body[own], p.z[own]
        i = np.clip(((p.x[own] - d.x) / d.edge).astype(np.int64), 0, d.nx - 1)
        j = np.clip(((p.y[own] - d.y) / d.edge).astype(np.int64), 0, d.ny - 1)
        column, found = i * d.ny + j, np.full((3, len(d.bottom)), -math.inf)
        water = np.zeros(len(p), bool)
        water[flow.near.fluid] = True
        water = water[own] & (p.surface[own] < DETACHED)
        inside = (p.x[own] >= d.x) & (p.x[own] < self._end)  # not what is yet to come in, or goes out
        solid = (kind == BODY) & (p.image[own] == 0) & inside
        ground = solid & self._ground[np.where(solid, body, 0)] if len(self._ground) else solid
        sets = (water, z + self._half), (ground, z + self._half), (solid & ~ground, self._half - z)
        for row, (which, height) in zip(found, sets, strict=True):
            np.maximum.at(row, column[which], height[which])
        surface, bottom, under = flow.domain.comm.max(found.ravel()).reshape(found.shape)
        bottom = np.maximum(bottom, self._floor)
        surface = np.maximum(surface, bottom + self._half)  # where there is no water there are no eddies either
        below = (-under > bottom) & (-under < surface + 2.0 * self._half)  # not what hangs in the air
        self.depths = d._replace(bottom=bottom, top=np.where(below, -under, surface), covered=below & self._rub)
