"""Bodies that pass inlet and outlet: led with the water there, so that they neither fall in nor tip over the end.

A floe of a supply comes in from beyond the inlet at its draught, as fast as the surface of the water that comes in,
which is left out where the floe is; once it is inside it is let go. It waits while another one is in its way, or where
it is to come in: how long is a result. Where a body is pushed back into the inlet no water comes in either. What floats
over the outlet is led on with the water there until it is outside.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.case import supply
from parsim.case.ice_faults import floes_of
from parsim.case.openings import level_at_start
from parsim.case.places import Place
from parsim.case.plans import plan_of
from parsim.geometry.faces import period
from parsim.geometry.rotation import from_angles, matrices, turned
from parsim.ice.draw import evenly
from parsim.ice.outlines import Outlines, gaps, joined, moved, outlines

if TYPE_CHECKING:
    from parsim.boundary.inlet import Inlet
    from parsim.boundary.outlet import Outlet
    from parsim.case.ice import IceSupply
    from parsim.case.model import Case
    from parsim.solid.bodies import Bodies

_TRIES = 50  # poses that are looked at for a floe, the last of them lengthwise: so all fit through the inlet
_POSES = 3  # part of a floe's counter of draws
_INSIDE = 1.0  # spacings inside the inlet at which a floe is let go
_BRAKE = 2.0  # spacings in which one that is led comes to a stop: the water is not to feel a blow
_NEAR = 0.25  # spacings from what is in its way at which it stands
_ROUNDING = 1e-3  # spacings by which an outline may be wider than its floe
_STEP = 0.25  # spacings of the height over which fixed bodies are seen: they are looked at anew as the level changes it


class _Near(NamedTuple):
    """What is near the inlet: outlines in plan, of which body each is (n,), and its speed along x (n,), m/s."""

    plan: Outlines
    row: np.ndarray
    speed: np.ndarray

    def joined(self, other: _Near) -> _Near:
        """Both."""
        parts = (np.concatenate(pair) for pair in zip(self[1:], other[1:], strict=True))
        return _Near(joined(self.plan, other.plan), *parts)


class _Queue:
    """The floes of one supply. wanted, given: area or volume so far; blocked, s: in which one found no way in."""

    def __init__(self, case: Case, given: IceSupply) -> None:
        number = {body.name: row for row, body in enumerate(case.bodies)}
        bodies = floes_of(case, given)
        self.supply, self.rows = given, [number[body.name] for body in bodies]
        self.height = [float(body.position[2]) for body in bodies]
        volumes = [body.shape.volume for body in bodies]
        thick = [2.0 * body.shape.half[2] for body in bodies]
        self.amounts = [supply.amount(given, v / t, t) for v, t in zip(volumes, thick, strict=True)]
        self.next, self.wanted, self.given, self.blocked, self.waits = 0, 0.0, 0.0, 0.0, False
        self.shapes = [body.shape for body in bodies]

    @property
    def due(self) -> bool:
        """Whether it lags by the next floe."""
        return self.next < len(self.rows) and self.wanted - self.given >= self.amounts[self.next]

    @property
    def lag(self) -> int:
        """How many floes ought to have come in and have not."""
        owed = max(self.wanted - self.given, 0.0)  # rounding may leave less
        ahead = np.cumsum([0.0, *self.amounts[self.next :]])
        count = int(np.searchsorted(ahead, owed, side="right")) - 1
        beyond = owed - ahead[-1] if count == len(ahead) - 1 else 0.0  # where more is wanted than was drawn
        return count + int(beyond / np.mean(self.amounts))


class Passage:
    """The bodies that pass inlet and outlet of a case, either None where there is none. Alike on all ranks."""

    def __init__(self, case: Case, bodies: Bodies, inlet: Inlet | None, outlet: Outlet | None) -> None:
        self._case, self._bodies, self._inlet, self._outlet = case, bodies, inlet, outlet
        self.queues = [_Queue(case, given) for given in case.ice.supplies]
        self._period = np.array(period(case))
        self._length = np.where(np.isfinite(self._period), self._period, 0.0)
        self._level = level_at_start(case)
        driven = {joint.body for joint in case.joints}
        self._free = np.array([not body.fixed and body.name not in driven for body in case.bodies], bool)
        self._goal = np.zeros(len(bodies))  # of the speed of what is led, m/s
        thick = [(q.supply.density / case.water.density, 2.0 * s.half[2]) for q in self.queues for s in q.shapes]
        under = max((share * t for share, t in thick), default=0.0)
        over = max(((1.0 - share) * t for share, t in thick), default=0.0)
        self._band = under + 0.5 * case.spacing, over + 0.5 * case.spacing  # m about the level, in which floes come in
        largest = max((bodies.radius[row] for queue in self.queues for row in queue.rows), default=0.0)
        self._end = case.box.min[0] + 2.0 * largest + 2.0 * _BRAKE * case.spacing  # m along x, of what is near
        self._still: dict[int, tuple[float, _Near]] = {}  # fixed bodies as they have been seen, and over which height

    def advance(self, time: float, dt: float) -> None:
        """Count what supplies are to give in a step of dt at a time, s, and go on with the water there."""
        if time < 0.0:
            return
        for queue in self.queues:
            queue.wanted += dt * supply.rate(queue.supply, time, self._inlet.surface_width, self._inlet.surface_speed)
            queue.blocked += dt if queue.waits else 0.0
        b = self._bodies
        led = np.flatnonzero(np.isfinite(b.lead))
        if len(led):
            water = self._inlet.surface_speed if self._inlet else 0.0, self._outlet.speed if self._outlet else 0.0
            fast = np.maximum(abs(b.lead[led]), max(water))  # what is led comes to a stop in water that stands, too
            most = dt * fast * fast / (2.0 * _BRAKE * self._case.spacing)
            b.lead[led] += np.clip(self._goal[led] - b.lead[led], -most, most)

    def turn(self, time: float) -> None:
        """Let bodies come in, wait, go on and be let go, before lists are built anew at a time, s."""
        b = self._bodies
        if not len(b):
            return
        led, beyond = np.isfinite(b.lead), b.position[:, 0] > (self._outlet.x if self._outlet else math.inf)
        if self._outlet:
            leaving = beyond & self._free & ~b.gone
            b.lead[leaving & ~led] = np.maximum(b.velocity[leaving & ~led, 0], 0.0)
            self._goal[leaving] = self._outlet.speed
        if not self._inlet:
            return
        tail = b.position[:, 0] - b.reaches()[:, 0]
        back = np.flatnonzero(~b.fixed & ~b.gone & ~led & (tail < self._inlet.x)).tolist()  # where nothing leads it
        if not self.queues:
            if back or self._inlet.covered.any():
                self._inlet.cover([self._place(row) for row in back])
            return
        coming = np.flatnonzero(led & ~beyond)
        through = tail[coming] >= self._inlet.x + _INSIDE * self._case.spacing
        b.lead[coming[through]] = math.nan
        coming = coming[~through].tolist()
        due = [queue for queue in self.queues if queue.due] if time >= 0.0 else []
        near = self._near() if coming or due else None
        for row in coming:
            stops = self._stopped(self._seen(row).plan, near, near.row != row)
            self._goal[row] = 0.0 if stops else self._inlet.surface_speed
        for queue in self.queues:
            queue.waits = False
        for queue in due:
            while queue.due and not queue.waits:
                queue.waits = not self._enters(queue, near, time)
                if not queue.waits:
                    coming.append(queue.rows[queue.next - 1])
                    near = near.joined(self._seen(coming[-1]))
        self._inlet.cover([self._place(row) for row in coming + back])

    def _near(self):
        """What is there near the inlet at the height of floes that come in."""
        b, found = self._bodies, _Near(outlines([], []), np.zeros(0, int), np.zeros(0))
        for row in np.flatnonzero(~b.gone & (b.position[:, 0] - b.radius < self._end)):
            there = self._place(row)
            if there.low()[2] - self._band[1] < self._inlet.level < there.high()[2] + self._band[0]:
                found = found.joined(self._seen(row))
        return found

    def _seen(self, row):
        """A body as it is seen near the inlet; across sides that repeat where its place leads back into the box."""
        step, b, box = _STEP * self._case.spacing, self._bodies, self._case.box
        bottom = step * math.floor((self._inlet.level - self._band[0]) / step)
        if row in self._still and self._still[row][0] == bottom:
            return self._still[row][1]
        around = self._length * np.floor((b.position[row] - box.min) / self._period)
        plan = plan_of(self._place(row, around), bottom, self._end)
        _, low, _, high = plan.extents()
        for shift in (self._length[1], -self._length[1]) if self._length[1] else ():
            beyond = plan.take(np.flatnonzero(low < box.min[1] if shift > 0.0 else high > box.max[1]))
            plan = joined(plan, beyond._replace(y=beyond.y + shift, cy=beyond.cy + shift))
        count = len(plan.cx)
        found = _Near(plan, np.full(count, row), np.full(count, b.velocity[row, 0]))
        if b.fixed[row]:
            self._still[row] = bottom, found
        return found

    def _place(self, row, around=0.0):
        b = self._bodies
        return Place(b.position[row] - around, matrices(b.quaternion[row : row + 1])[0], b.shapes[row])

    def _stopped(self, own, near, which):
        """Whether something slower among `which` is in the way of a floe that comes in, so near that it has to stop."""
        l0, speed, at = self._case.spacing, self._inlet.surface_speed, np.flatnonzero(which)
        if not at.size or speed <= 0.0:
            return False
        own, others = own.take(np.zeros(at.size, int)), near.plan.take(at)
        ahead = (_BRAKE + _NEAR) * l0 * np.clip(1.0 - near.speed[at] / speed, 0.0, 1.0)
        then = gaps(own._replace(x=own.x + ahead[:, None], cx=own.cx + ahead), others).apart
        return bool(((then < _NEAR * l0) & (then < gaps(own, others).apart)).any())

    def _enters(self, queue, near, time):
        """Let the next floe of a queue come in where there is room before the inlet; whether there is."""
        b, k, case = self._bodies, queue.next, self._case
        row, gap, every = queue.rows[k], queue.supply.apart(case), np.ones(len(near.row), bool)
        key = queue.supply.seed, queue.supply.stream, k + 1
        own_turn = matrices(np.array([queue.shapes[k].turn], float))[0]
        flat = plan_of(Place(np.zeros(3), own_turn, queue.shapes[k]), -math.inf)
        dice = evenly(key, _POSES, 2 * _TRIES)
        for across, around in zip(dice[::2], [*dice[1:-1:2], 0.0], strict=True):
            turn = 0.0 if case.dimensions == 2 else 2.0 * math.pi * around
            at, heading = np.zeros(1), (np.array([math.cos(turn)]), np.array([math.sin(turn)]))
            _, low, front, high = (float(end[0]) for end in moved(flat, at, at, *heading).extents())
            left, right = case.box.min[1] + gap - low, case.box.max[1] - gap - high
            if case.dimensions == 3 and left > right + _ROUNDING * case.spacing:
                continue
            x = self._inlet.x - gap - front
            y = 0.5 if case.dimensions == 2 else left + across * (right - left)
            own = moved(flat, np.array([x]), np.array([y]), *heading)
            apart = gaps(own.take(np.zeros(len(near.row), int)), near.plan).apart
            if (apart < gap).any() or self._stopped(own, near, every):
                continue
            place = np.array([x, y, queue.height[k] + self._inlet.level - self._level])
            quaternion = turned(from_angles((0.0, 0.0, math.degrees(turn))), queue.shapes[k].turn)
            b.bring_in(row, place, quaternion, time)
            b.lead[row] = b.velocity[row, 0] = self._goal[row] = self._inlet.surface_speed
            queue.next, queue.given = k + 1, queue.given + queue.amounts[k]
            return True
        return False

    def kept(self) -> dict[str, np.ndarray]:
        """What a restart needs."""
        rows = [[q.next, q.wanted, q.given, q.blocked, float(q.waits)] for q in self.queues]
        return {"queues": np.array(rows, float).reshape(-1, 5)}

    def restore(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        for queue, row in zip(self.queues, np.array(kept["queues"]), strict=True):
            number, queue.wanted, queue.given, queue.blocked, waits = map(float, row)
            queue.next, queue.waits = int(number), bool(waits)
