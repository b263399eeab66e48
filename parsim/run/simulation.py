"""The time loop: what happens in a step, when lists are rebuilt, when things are written, when the run stops."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.fluid.scheme import Flow
from parsim.machine.timers import Timers
from parsim.output.checkpoint import Snapshot
from parsim.particles.state import Particles
from parsim.run import guards
from parsim.run.fill import columns, flow, water
from parsim.run.setup import Models

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.domain.comm import Comm

_COUNTERS = ("time", "step_count", "dt", "speed", "rebuilds")
_MARGIN = 1.2  # how much faster than at its start a step may be before pairs at the edge of the support are missed


class Simulation:
    """One case in flight on this rank. `step` advances it; everything else looks at its attributes.

    time, s; step_count; dt, s, of the last step; speed, m/s, largest of the water and of body surfaces; active: fluid
    and awake boundary particles of all ranks; gone: on rank 0, rows of what has left the box and is not told of yet.
    """

    def __init__(self, case: Case, comm: Comm, snapshot: Snapshot | None = None) -> None:
        self.case, self.comm, self.timers = case, comm, Timers()
        models = self.models = Models(case, comm, self.timers)
        self.domain, self.near, self.scheme = models.domain, models.near, models.scheme
        self.solids = solids = models.solids
        self.bodies, self.contacts, self.gate = solids.bodies, solids.contacts, solids.gate
        self.time, self.step_count, self.dt, self.speed, self.rebuilds = case.start, 0, 0.0, 0.0, 0
        self._uneven = [0.0, 1.0, 0]  # sum, most and number of looks
        self.gone: list[tuple] = []
        self._weight = math.hypot(*case.gravity)
        self._damping = case.speed / case.depth if case.depth else 0.0
        if snapshot is None:
            self.domain.cut_evenly(*columns(case))
            self._rebuild(water(case, self.bodies, self.scheme, comm, self.domain.owns))
            self._balance(True)
            self._rebuild(self.fluid)  # with cuts that know the walls and bodies too
            self.rebuilds, self._uneven = 0, [0.0, 1.0, 0]
            self._look()
        else:
            self._restore(snapshot)

    @property
    def fluid(self) -> Particles:
        """This rank's fluid particles, without images: Particles, kept fields."""
        return self.domain.particles.take(self.near.fluid)

    @property
    def uneven(self) -> tuple[float, float]:
        """Largest work of a rank over the mean before each rebuild: the mean of that, and the most."""
        total, most, looks = self._uneven
        return total / looks if looks else 1.0, most

    def snapshot(self) -> Snapshot:
        """All that a restart needs, before a step that rebuilds; called on all ranks together."""
        (lost,) = self.domain.count(self.domain.lost)
        account = {"lost": lost, "uneven": list(self._uneven)}
        account |= {name: getattr(self, name) for name in _COUNTERS}
        return Snapshot(self.fluid, {name: part.kept() for name, part in self.solids.parts.items()}, account)

    def _restore(self, snapshot):
        """Go on from a snapshot: the rebuild that the step after it began with is made here."""
        for name in _COUNTERS:
            setattr(self, name, snapshot.account[name])
        self._uneven = list(snapshot.account["uneven"])
        self.domain.lost = snapshot.account["lost"] if self.comm.rank == 0 else 0
        for name, part in self.solids.parts.items():
            part.restore(snapshot.parts[name])
        self.domain.cut_evenly(snapshot.water.x, np.ones(len(snapshot.water)))
        self._rebuild(snapshot.water)

    def rebuilds_next(self) -> bool:
        """Whether the next step begins with a rebuild; the same on every rank."""
        return self._outrun(self._next_dt())

    def _next_dt(self):
        acceleration = max(self._weight, self.bodies.surface_acceleration())
        return min(self.scheme.time_step(self.speed, acceleration), self.contacts.limit())

    def step(self) -> None:
        """Advance water and bodies by one time step."""
        self.dt = dt = self._next_dt()
        if error := guards.collapsed(self, dt):
            raise error
        if self._outrun(dt):
            self._balance(self.rebuilds % self.case.run.balance_every == 0)
            self._rebuild(self.fluid)
        keep = max(1.0 - self._damping * dt, 0.0) if self.time < 0.0 else 1.0
        self.solids.pull.steer(self.flow(), self.bodies, self.scheme.lattice.volume, self.time, dt)
        self.scheme.step(self.flow(keep), self.solids, self.time, dt)
        self.solids.lead_out(self.domain.particles, dt)
        if self.time < 0.0 <= self.time + dt:
            flow(self.case, self.domain.particles)
        self.time += dt
        self.step_count += 1
        self.since += 1
        self.solids.pull.count(self.flow(), self.bodies, self.scheme.mass, self.time, dt)
        if self.solids.openings:
            self.solids.openings.look(self.flow(), self.time, dt)
        with self.domain.refreshing(*self.scheme.STATE):
            self._look()

    def flow(self, keep: float = 1.0) -> Flow:
        """The water as the scheme sees it; `keep`: see `Flow`."""
        pull, middle = self.solids.pull, self.time + 0.5 * self.dt
        felt = pull.at(middle), pull.moving.turning(middle)
        return Flow(self.domain.particles, self.near, self.domain, self.speed, keep, *felt)

    def _outrun(self, dt):
        """Whether the lists would miss pairs within this step; the same on every rank."""
        run = self.case.run
        travel = self.moved + _MARGIN * dt * self.speed
        opening = self.gate is not None and self.gate.closed(self.time) != self._closed
        return 2.0 * travel > run.skin * self.case.spacing or self.since >= run.rebuild_at_most or opening

    def _balance(self, move):
        with self.timers("rebuild"):
            self.domain.balance(self.near.work(self.domain), move)
        total, most, looks = self._uneven
        self._uneven = [total + self.domain.uneven, max(most, self.domain.uneven), looks + 1]

    def _rebuild(self, fluid):
        domain, near = self.domain, self.near
        left, fluid = self._take_out(), self._exchange(fluid)
        with self.timers("rebuild"):
            domain.rebuild(fluid, self.time)
        with self.timers("neighbours"):
            near.build(domain, self.models.reach)
            if self.gate:
                near.cut_by_gate(domain.particles, self.models.reach, self.gate, self.time)
                self._closed = self.gate.closed(self.time)
            self.solids.find(self.flow())
        with self.timers("sums"):
            numbers = near.fluid.size + near.boundary.size, near.fluid.size, len(domain.gone)
            self.active, self.fluid_count, gone = domain.count(*numbers)
        if gone or left:
            self._note_gone(left, gone > 0)
        p, at = domain.particles, near.fluid
        self._start = np.stack([p.x[at], p.y[at], p.z[at]])
        self.moved, self._solid_moved, self.since = 0.0, 0.0, 0
        self.rebuilds += 1

    def _exchange(self, fluid):
        """Take what has gone out of this rank's water, and give the first rank what has come in: the water then."""
        openings = self.solids.openings
        if openings.outlet:
            out = fluid.x >= openings.outlet.end
            openings.outlet.removed += self.domain.count(int(out.sum()))[0]
            fluid = fluid.take(~out)
        if openings.inlet:
            born = openings.inlet.emit(self.scheme.at_rest)
            fluid = Particles.join([fluid, born]) if self.comm.rank == 0 else fluid
        if openings:
            openings.passage.turn(self.time)
        return fluid

    def _take_out(self):
        """Take out the bodies that are wholly outside the grid, as the domain does with water: rows of `gone`."""
        grid = self.domain.grid
        endless = np.array(grid.periodic) | ~np.isin(range(3), self.case.axes)
        low, high = np.where(endless, -np.inf, grid.low), np.where(endless, np.inf, grid.high)
        at, rows = self.bodies.take_out(low, high, self.time)
        return [
            (self.step_count + 1, self.time, f"body {self.bodies.names[b]}", b, *row)
            for b, row in zip(at, rows, strict=True)
        ]

    def _note_gone(self, left, wet):
        """Collect, on rank 0, what the last rebuild has found outside the box; `wet`: water too, of any rank."""
        p = self.domain.gone
        rows = np.concatenate([np.zeros((0, 7)), *self.comm.stream(np.stack([p.id, p.x, p.y, p.z, p.u, p.v, p.w], 1))])
        rows = left + [(self.step_count + 1, self.time, "water", *row) for row in rows[np.argsort(rows[:, 0])]]
        self.gone.extend(rows if self.comm.rank == 0 else ())
        if self.case.run.outside == "stop" and (wet or not all(map(self._went_out, left))):
            raise guards.outside(self, rows)

    def _went_out(self, row):
        """Whether a body that has left, a row of `gone`, has done so through the outlet, as it may."""
        outlet = self.solids.openings.outlet
        return outlet is not None and row[4] > outlet.x

    def _look(self):
        """Largest speed, and how far anything has moved since the lists were built."""
        with self.timers("move"):
            fastest, moved = self.scheme.extremes(self.domain.particles, self.near, self._start)
        with self.timers("sums"):
            fastest, moved = map(float, self.domain.max(fastest, moved))
        soon = self.time + self.scheme.time_step(fastest)  # a gate that is about to rise counts
        solid = max(
            self.bodies.surface_speed(), self.solids.openings.speed, self.gate.velocity(soon) if self.gate else 0.0
        )
        if not max(fastest, solid) < self.scheme.sound:
            raise guards.runaway(self)
        self._solid_moved += self.dt * solid
        self.moved = max(moved, self._solid_moved)
        self.speed = max(fastest, solid)
