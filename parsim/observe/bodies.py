"""Where the bodies are and how they move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.observe.observer import columns

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation


class Bodies:
    """One row for each body."""

    name = "bodies"
    columns = columns(
        body="-",
        x="m",
        y="m",
        z="m",
        q0="-",
        q1="-",
        q2="-",
        q3="-",
        u="m/s",
        v="m/s",
        w="m/s",
        spin_x="rad/s",
        spin_y="rad/s",
        spin_z="rad/s",
    )

    def __init__(self, case: Case) -> None:
        pass

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`."""
        values = np.hstack([s.bodies.shown(name) for name in ("position", "quaternion", "velocity", "spin")])
        return [[name, *map(float, row)] for name, row in zip(s.bodies.names, values, strict=True)]
