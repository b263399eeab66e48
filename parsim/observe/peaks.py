"""What has acted on bodies in all steps between two rows: nothing falls between."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.geometry.rotation import matrices
from parsim.observe.observer import columns
from parsim.observe.sensors import Load
from parsim.solid.bodies import from_case

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.simulation import Simulation

KINDS = ("water", "contact")
PARTS = {"fx": "N", "fy": "N", "fz": "N", "mx": "N m", "my": "N m", "mz": "N m"}


class Peaks:
    """Two rows for each body of a sensor: what water and contacts did since the row before, moments about its foot.

    The foot is as far under its centre as its lowest point is at the start. `span`: time since the row before.
    """

    name = "peaks"
    columns = columns(
        sensor="-",
        body="-",
        kind="-",
        span="s",
        **{f"{part}_mean": unit for part, unit in PARTS.items()},
        **{f"{part}_min": unit for part, unit in PARTS.items()},
        **{f"{part}_max": unit for part, unit in PARTS.items()},
        **{f"{part}_impulse": f"{unit} s" for part, unit in PARTS.items()},
    )

    def __init__(self, case: Case) -> None:
        sensors = [sensor for sensor in case.output.sensors if isinstance(sensor, Load)]
        self._seen = [
            (sensor.name, k)
            for sensor in sensors
            for k, body in enumerate(case.bodies)
            if (body.fixed if sensor.body is None else body.name == sensor.body)
        ]
        self._at = np.array([k for _, k in self._seen], int)
        self._foot = np.zeros(len(self._at))
        if self._seen:
            bodies = from_case(case)  # at the start, whenever a run goes on
            turn = matrices(bodies.quaternion)
            self._foot = np.array([bodies.shapes[k].reach(-turn[k, 2]) for k in self._at])
        self._clear()

    def _clear(self):
        count = len(self._at), len(KINDS), len(PARTS)
        self._span, self._impulse = 0.0, np.zeros(count)
        self._least, self._largest = np.full(count, np.inf), np.full(count, -np.inf)

    def see(self, s: Simulation) -> None:
        """Take in the step that was made: the loads are its mean ones, the same on all ranks."""
        if not self._seen or s.step_count == 0:
            return
        load = np.stack([s.bodies.shown(f"{kind}_load")[self._at] for kind in KINDS], axis=1)
        # from the centre to the foot: M + (0, 0, h) x F
        load[..., 3] -= self._foot[:, None] * load[..., 1]
        load[..., 4] += self._foot[:, None] * load[..., 0]
        self._span += s.dt
        # nan of those that have left: what acted before in the same row is told all the same
        self._impulse += np.nan_to_num(load) * s.dt
        np.fmin(self._least, load, out=self._least)
        np.fmax(self._largest, load, out=self._largest)

    def rows(self, s: Simulation) -> list[list[Any]]:
        """See `Observer`; begins anew."""
        if self._span == 0.0:
            return []
        parts = self._impulse / self._span, self._least, self._largest, self._impulse
        every = np.where(np.isfinite(np.tile(self._least, 4)), np.concatenate(parts, axis=-1), np.nan).tolist()
        found = [
            [sensor, s.bodies.names[k], kind, self._span, *row]
            for (sensor, k), both in zip(self._seen, every, strict=True)
            for kind, row in zip(KINDS, both, strict=True)
        ]
        self._clear()
        return found

    def kept(self) -> dict[str, Any]:
        """See `Follower`."""
        every = {"impulse": self._impulse, "least": self._least, "largest": self._largest}
        return {"span": self._span} | {name: values.tolist() for name, values in every.items()}

    def restore(self, kept: dict[str, Any]) -> None:
        """See `Follower`."""
        self._span, count = kept["span"], self._impulse.shape
        self._impulse, self._least, self._largest = (
            np.array(kept[name]).reshape(count) for name in ("impulse", "least", "largest")
        )
