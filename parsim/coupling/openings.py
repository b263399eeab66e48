"""Where water comes in and goes out of a box: what they see of the water inside, and their account."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.boundary.inlet import Inlet
from parsim.boundary.outlet import Outlet
from parsim.case.places import Place
from parsim.case.scales import scales
from parsim.coupling.passage import Passage
from parsim.geometry.rotation import matrices
from parsim.particles.state import DETACHED

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.fluid.scheme import Flow
    from parsim.particles.state import Particles
    from parsim.solid.bodies import Bodies

_INLET = 0.5, 1.5  # depths from the inlet, between which its level is looked for
_OUTLET = 0.0, 0.5  # the same of the outlet; from further off a wave would be answered before it is there
_EDGE = 0.0, 4.0  # spacings before the outlet, whose water the zone beyond it goes along with
_INSIDE, _OUTSIDE, _BEFORE, _BACK = range(4)  # rows of the sums: inlet, outlet, right before it, kept from going back


class Openings:
    """Inlet at x_min and outlet at x_max of a case, each None where the side is another; exact account of particles.

    passage: of bodies through them; clipped: share of the water beyond the outlet that was kept from going back, its
    mean so far.
    """

    def __init__(self, case: Case, layers: int, bodies: Bodies) -> None:
        faces, scale = case.box.faces, scales(case)
        self.inlet = Inlet(case, layers, _fixed(bodies)) if faces.x_min.kind == "inlet" else None
        self.outlet = Outlet(case, layers) if faces.x_max.kind == "outlet" else None
        self.passage = Passage(case, bodies, self.inlet, self.outlet)
        self._depth, self._spacing = case.depth, case.spacing
        self._head = case.water.density * -case.gravity[2]
        self._units = np.array([scale.length, scale.length / scale.time, 1.0])
        self._back = np.zeros(2)

    def __bool__(self) -> bool:
        return self.inlet is not None or self.outlet is not None

    @property
    def clipped(self) -> float:
        """See the class."""
        back, every = self._back
        return float(back / every) if every else 0.0

    def look(self, flow: Flow, time: float, dt: float) -> None:
        """Look at the water inside after a step of dt, s; `time`, s, is when the next begins. Not while it settles."""
        if time < 0.0:
            return
        p, own = flow.particles, flow.near.fluid
        values, rows = [np.zeros((0, 3))], [np.zeros(0, np.int64)]
        looks = [(_INSIDE, p.x[own] - self.inlet.x, _INLET, self._depth)] if self.inlet else []
        if self.outlet:
            away = self.outlet.x - p.x[own]
            looks += [(_OUTSIDE, away, _OUTLET, self._depth), (_BEFORE, away, _EDGE, self._spacing)]
        for row, away, (near, far), unit in looks:
            at = own[(away > near * unit) & (away < far * unit) & (p.surface[own] < DETACHED)]
            values.append(np.stack([p.z[at] + p.p[at] / self._head, p.u[at], np.ones(at.size)], axis=1))
            rows.append(np.full(at.size, row))
        if self.outlet:
            turned = self.outlet.turned().astype(float)
            values.append(np.stack([turned, np.zeros(turned.size), np.ones(turned.size)], axis=1))
            rows.append(np.full(turned.size, _BACK))
        sums = flow.domain.sum(np.concatenate(values), self._units, np.concatenate(rows), 4)
        with np.errstate(invalid="ignore"):
            level, speed = sums[:, 0] / sums[:, 2], sums[:, 1] / sums[:, 2]
        self._back += sums[_BACK, [0, 2]]
        if self.inlet:
            self.inlet.follow(float(level[_INSIDE]), float(speed[_INSIDE]), time, dt)
        if self.outlet:
            seen = float(level[_OUTSIDE]), float(speed[_OUTSIDE]), float(speed[_BEFORE])
            self.outlet.follow(*seen, time, dt)
        self.passage.advance(time, dt)

    def find(self, p: Particles, own: slice) -> None:
        """Note where samples and zone are among the particles `p` after a rebuild; `own` are those of this rank."""
        if self.inlet:
            self.inlet.find(p)
        if self.outlet:
            self.outlet.find(p, own)

    @property
    def speed(self) -> float:
        """Of the fastest water that comes in, m/s."""
        return float(self.inlet.speed.max()) if self.inlet else 0.0

    def place(self, p: Particles, ahead: float) -> None:
        """Bring the samples of the inlet to where they are `ahead` s from now."""
        if self.inlet:
            self.inlet.place(p, ahead)

    def advance(self, p: Particles, dt: float) -> None:
        """Let the inlet travel over dt, s, and place its samples."""
        if self.inlet:
            self.inlet.advance(dt)
            self.inlet.place(p, 0.0)

    def kept(self) -> dict[str, np.ndarray]:
        """What a restart needs."""
        kept = {"back": self._back.copy()} | self.passage.kept()
        for each in (self.inlet, self.outlet):
            kept |= each.kept() if each else {}
        return kept

    def restore(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        self._back = np.array(kept["back"], float)
        self.passage.restore(kept)
        for each in (self.inlet, self.outlet):
            if each:
                each.restore(kept)


def _fixed(bodies):
    """Where the fixed bodies are."""
    turn = matrices(bodies.quaternion)
    return [Place(bodies.position[b], turn[b], bodies.shapes[b]) for b in np.flatnonzero(bodies.fixed)]
