"""Water that comes in: a conveyor of samples on the lattice of the inlet, which become water as they pass the side.

A *place* is a site of the lattice in y and z. Its k-th particle stands at x = x_in + travel - (k + 1/2) l0, whatever
was before: position, moment and id of each follow from the travel of its place, which is all that is kept, and no
particle enters before the last has left. To the water, samples before the side are a boundary that moves with it: their
pressure is that of the water that they see. A wave from inside shows in level and speed there; the discharge can give
way to it by so much that none runs back, and is what is asked for on the average.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.boundary.wall_samples import lattice_axis
from parsim.case.course import at_time
from parsim.case.openings import level_at_start
from parsim.case.places import clearance
from parsim.particles.lattice import lattice_of
from parsim.particles.state import FLUID, INLET, Particles, make_id

if TYPE_CHECKING:
    from collections.abc import Callable

    from parsim.case.model import Case
    from parsim.case.places import Place as Solid
    from parsim.domain.slab import Slab

_LAG = 2.0  # sqrt(H / g), of the level that the inlet follows
_TRAVELS = 5.0  # H / V, over which level and speed are averaged that waves are waves on
_AHEAD = 1.0  # depths that the water looked at is before the inlet: what is seen there comes so much later
_SLACK = 0.25  # spacings by which the level must pass the middle of a row to wake it or send it to sleep


class Inlet:
    """The inlet of a case at x_min. level, m: of the water that comes in; discharge, m3/s (2D: m2/s), as asked now.

    speed (places,), m/s; travel (places,), m; first (places,), particles that each has given to the water so far;
    solid (places,): what is fixed stands there, and the samples are a wall; covered (places,): ice comes in there, and
    no water; displaced, m3: water that did not come in for it so far; surface_speed, m/s: of the uppermost water that
    comes in; surface_width, m: of the part of the inlet that has water (2D: 1).
    """

    def __init__(self, case: Case, layers: int, fixed: list[Solid]) -> None:
        self._side, self._case, self._layers, l0 = case.box.faces.x_min, case, layers, case.spacing
        self.x, self._floor = case.box.min[0], case.box.min[2]
        across, beyond = lattice_axis(case, 1, 0)
        up = np.arange(self._floor + 0.5 * l0, case.box.max[2], l0)
        y, z = np.meshgrid(across[beyond == 0], up, indexing="ij")
        self._y, self._z, self._shape = y.ravel(), z.ravel(), y.shape
        self._area = l0 if case.dimensions == 2 else l0 * l0
        self._lag = _LAG * np.sqrt(case.depth / -case.gravity[2])
        self._id = sum(lattice_of(case, fill).size for fill in case.water.fill)
        self.level, self.discharge = level_at_start(case), 0.0
        self._mean, self._drift, self._gone, self._owed = self.level, math.nan, 0.0, 0.0
        count = self._y.size
        self.travel, self.speed = np.zeros(count), np.zeros(count)
        self.first, self.awake = np.zeros(count, np.int64), np.zeros(count, bool)
        self.covered, self.displaced, self._lost = np.zeros(count, bool), 0.0, 0.0
        self._solids: list[Solid] = []
        self.solid = ~self._clear(np.full(count, self.x + 0.5 * l0), np.arange(count), fixed)
        low = np.minimum.accumulate(self.solid.reshape(y.shape), axis=1).sum(axis=1)  # how many from the floor on
        self._bottom = self._floor + l0 * np.repeat(low, up.size)
        self._at, self._of, self._behind = np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0)
        self._wake()
        self.follow(math.nan, math.nan, case.start, 0.0)

    def follow(self, level: float, speed: float, time: float, dt: float) -> None:
        """Follow what was seen inside over dt, s, level, m, and speed, m/s; set the speeds of the step at `time`, s."""
        if self._side.level is not None:
            self.level = at_time(self._side.level, time)
        elif np.isfinite(level):
            self.level += min(dt / self._lag, 1.0) * (level - self.level)
        self.discharge = at_time(self._side.discharge, time) if time >= 0.0 else 0.0
        if self._side.absorb > 0.0 and time >= 0.0 and np.isfinite(level):
            self._give_way(level, speed, dt)
        self._flow()

    def _give_way(self, level, speed, dt):
        """Let a wave out: dV = -sqrt(g / h) dh, with the depth over what stands there.

        Of what is seen, only the wave that runs out counts, by the invariant V - 2 sqrt(g h), when it has come here: an
        answer to the inlet's own waves would feed them. What would have to go out through the inlet is owed, and does
        not come in later.
        """
        over, gravity = self._mean - self._bottom.reshape(self._shape)[:, 0], -self._case.gravity[2]
        wet = over > self._case.spacing
        depth = float(over[wet].mean()) if wet.any() else self._case.spacing
        area = depth * self._case.width * max(float(wet.mean()), 1.0 / wet.size)
        wave, drift = math.sqrt(gravity * depth), speed if math.isnan(self._drift) else self._drift
        lag = _TRAVELS * depth / max(self.discharge / area, 0.1 * wave)
        self._mean += min(dt / lag, 1.0) * (level - self._mean)
        self._drift = drift + min(dt / lag, 1.0) * (speed - drift)
        out = 0.5 * (wave / depth * (level - self._mean) - (speed - self._drift)) * area
        travel = _AHEAD * depth / max(wave - speed, 0.1 * wave)
        self._gone += min(dt / travel, 1.0) * (self._side.absorb * out - self._gone)
        left = self.discharge - self._gone
        paid = min(self._owed / lag, max(left, 0.0))
        self._owed += dt * (max(-left, 0.0) - paid)
        self.discharge = max(left, 0.0) - paid  # nothing goes out here

    def _flow(self):
        """Set the speeds, by the discharge. Floes weigh what they displace: where one comes in, water is left out."""
        share = self._shares()
        total = math.fsum(share) * self._area
        speed = share * (self.discharge / total) if total > 0.0 else share
        self.surface_speed = float(speed[np.argmax(np.where(self.awake, self._z, -math.inf))])
        self.surface_width = self._case.width * float(self.awake.reshape(self._shape).any(axis=1).mean())
        self.speed = np.where(self.covered, 0.0, speed)
        self._lost = (math.fsum(speed) - math.fsum(self.speed)) * self._area

    def cover(self, solids: list[Solid]) -> None:
        """Let no water come in where one of the solids does."""
        self._solids, before, every = solids, self._gives, np.arange(self._z.size)
        nearest = self._clear(self._place(every, 0, 0.0), every, solids)
        edge = self._clear(np.full(every.size, self.x - 0.5 * self._case.spacing), every, solids)
        self.covered = ~np.where(self.covered, edge, nearest)
        self._begin(self._gives & ~before)
        self._flow()

    @property
    def _gives(self):
        """Which places give water: (places,) bool."""
        return self.awake & ~self.covered

    def _clear(self, x, place, solids):
        """Whether water at x (n,), m, of some places is not in one of the solids: (n,) bool.

        On the average it is then half a spacing off, and as much is left out as the solids take.
        """
        points = np.stack([x, self._y[place], self._z[place]], axis=1)
        free = np.ones(len(points), bool)
        for solid in solids:
            free &= clearance(solid, points) > 0.0
        return free

    def _shares(self):
        shares, profile = np.ones(self._z.size), self._side.profile
        for bottom in np.unique(self._bottom).tolist() if profile else ():
            over, depth = self._bottom == bottom, max(self.level - bottom, self._case.spacing)
            shares[over] = profile.at(self._z[over] - bottom, depth)
        return np.where(self.awake, shares, 0.0)

    def _wake(self):
        """Wake the places that the level has reached, send to sleep those that it has left."""
        top, slack = self._z + 0.5 * self._case.spacing, _SLACK * self._case.spacing
        before, given = self.awake, self._gives
        self.awake = np.where(before, top < self.level + 0.5 * self._case.spacing + slack, top <= self.level + slack)
        self.awake &= ~self.solid
        self._begin(self._gives & ~given)

    def _begin(self, woken):
        """Let places that give water from now on do so from half a spacing before the side."""
        self.travel[woken] = self.first[woken] * self._case.spacing

    def emit(self, at_rest: Callable[[np.ndarray], dict[str, np.ndarray]]) -> Particles:
        """What has passed the side since it was asked last, as water in balance: Particles, the same on all ranks."""
        l0 = self._case.spacing
        last = np.where(self._gives, np.floor(self.travel / l0 + 0.5).astype(np.int64), self.first)
        count = np.maximum(last - self.first, 0)
        place = np.repeat(np.arange(count.size), count)
        number = self.first[place] + np.arange(place.size) - np.repeat(np.cumsum(count) - count, count)
        head = np.maximum(self.level - self._z[place], 0.0)
        pressure = self._case.water.density * -self._case.gravity[2] * head
        born = Particles(
            place.size,
            self._case.water.scheme.fields,
            id=make_id(FLUID, self._id + number * self._z.size + place),
            kind=FLUID,
            x=self.x + self.travel[place] - (number + 0.5) * l0,
            y=self._y[place],
            z=self._z[place],
            u=self.speed[place],
            **at_rest(pressure),
        )
        self.first += count
        self._wake()
        return born

    def samples(self, slab: Slab, time: float) -> Particles:
        """The samples of the slab, `layers` deep, nearest first: Particles with layer and place as `sample`."""
        place = np.flatnonzero(self._gives | self.solid)
        layer, place = (each.ravel() for each in np.meshgrid(np.arange(self._layers), place, indexing="ij"))
        number = layer * self._z.size + place
        x = self._place(place, layer, 0.0)
        at = np.flatnonzero((slab.cells(x, self._y[place], self._z[place]) >= 0) & self._clear(x, place, self._solids))
        return Particles(
            at.size,
            id=make_id(INLET, number[at]),
            kind=INLET,
            sample=number[at],
            x=x[at],
            y=self._y[place[at]],
            z=self._z[place[at]],
            u=self.speed[place[at]],
        )

    def _place(self, place, layer, ahead):
        behind = (self.first[place] + layer + 0.5) * self._case.spacing
        return self.x + self.travel[place] + ahead * self.speed[place] - behind

    def find(self, p: Particles) -> None:
        """Note where the samples are among the particles `p` of this rank."""
        self._at = np.flatnonzero(p.kind == INLET)
        self._of = p.sample[self._at] % self._z.size
        self._behind = p.sample[self._at] // self._z.size

    def place(self, p: Particles, ahead: float) -> None:
        """Bring the samples among `p` to where they are `ahead` s from now."""
        p.x[self._at] = self._place(self._of, self._behind, ahead)
        p.u[self._at] = self.speed[self._of]

    def advance(self, dt: float) -> None:
        """Let all places travel over dt, s."""
        self.travel += dt * self.speed
        self.displaced += dt * self._lost

    @property
    def emitted(self) -> int:
        """Particles that it has given to the water so far."""
        return int(self.first.sum())

    def kept(self) -> dict[str, np.ndarray]:
        """What a restart needs."""
        return {
            "travel": self.travel.copy(),
            "first": self.first.copy(),
            "awake": self.awake.astype(np.int64),
            "covered": self.covered.astype(np.int64),
            "inlet": np.array([self.level, self.discharge, self.displaced]),
            "waves": np.array([self._mean, self._drift, self._gone, self._owed]),
        }

    def restore(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        self.travel, self.first = (np.array(kept[name]) for name in ("travel", "first"))
        self.awake, self.covered = np.array(kept["awake"], bool), np.array(kept["covered"], bool)
        self.level, self.discharge, self.displaced = map(float, kept["inlet"])
        self._mean, self._drift, self._gone, self._owed = map(float, kept["waves"])
        self._flow()
