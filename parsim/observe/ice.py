"""The account of floes that come in and go out."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Ice:
    """One row of a case with supplies of ice: free bodies let in, out and inside, by number and volume.

    balance: volume inside at the start and let in, less that out and inside: zero. coming: of those let in, how many
    are not inside the inlet yet; due: how many ought to be in and are not; blocked: time in which one found no room to
    come in, all supplies together; displaced: water that was left out where ice came in.
    """

    name = "ice"
    columns = columns(
        let_in="-",
        out="-",
        inside="-",
        volume_in="m3",
        volume_out="m3",
        volume_inside="m3",
        balance="m3",
        coming="-",
        due="-",
        blocked="s",
        displaced="m3",
    )

    def __init__(self, case: Case) -> None:
        self._volumes = np.array([body.shape.volume for body in case.bodies])
        self._ice = np.array([not body.fixed for body in case.bodies], bool)
        self._supplied = np.array([body.enters for body in case.bodies], bool)

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        openings, b = s.solids.openings, s.bodies
        queues, inlet = openings.passage.queues, openings.inlet
        if not queues or inlet is None:
            return []
        let_in = self._supplied & (b.entered < math.inf)
        there, out = self._ice & ~b.gone, self._ice & (b.left < math.inf)
        groups = [self._volumes[which] for which in (let_in, out, there)]
        start = self._volumes[self._ice & ~self._supplied]
        balance = math.fsum([*start, *groups[0], *(-groups[1]), *(-groups[2])])
        coming = let_in & np.isfinite(b.lead) & (b.position[:, 0] < inlet.x + b.radius)
        return [
            [
                *(len(group) for group in groups),
                *(math.fsum(group) for group in groups),
                balance,
                int(coming.sum()),
                sum(queue.lag for queue in queues),
                math.fsum(queue.blocked for queue in queues),
                inlet.displaced,
            ]
        ]
