"""What pulls water and bodies alike: gravity, what comes of a box that moves, and the force that keeps a discharge."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.case.course import at_time
from parsim.case.scales import gravity_at, scales
from parsim.coupling.moving import Moving
from parsim.geometry.faces import repeats
from parsim.particles.tables import Vectors

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.fluid.scheme import Flow
    from parsim.solid.bodies import Bodies

_INTEGRAL = 4.0  # times of relaxation in which the integral part acts: it then answers without swinging


class Pull:
    """Acceleration of all that is free, m/s2, at a time.

    discharge, m3/s, of the water through the channel at the last step, mean over its length; drive, m/s2, what is added
    to gravity along x: a controller with a proportional and an integral part in exact sums, the same on all ranks;
    work, J, done so far along x in a channel, by the motion of the box, or by gravity along axes that repeat, along
    which nothing falls. moving: how the box moves.
    """

    def __init__(self, case: Case) -> None:
        self._case, self._channel = case, case.channel
        self.discharge, self.drive, self.work, self._integral, self._power = np.nan, 0.0, 0.0, 0.0, np.nan
        self.moving, scale = Moving(case), scales(case)
        self._tilted = [axis for axis in range(3) if repeats(case)[axis] and case.gravity[axis] != 0.0]
        if self._channel is not None or self.moving:
            self._tilted = []
        self._watt = scale.energy / scale.time
        self._units = np.array([scale.length / scale.time, 1.0])

    def __bool__(self) -> bool:
        return self._channel is not None or bool(self.moving or self._tilted)

    def at(self, time: float) -> tuple[float, float, float]:
        """Acceleration along x, y, z, m/s2."""
        x, y, z = self.moving.gravity(time) if self.moving else gravity_at(self._case, time)
        return x + self.drive, y, z

    def steer(self, flow: Flow, bodies: Bodies, volume: float, time: float, dt: float) -> None:
        """Set the drive of the step that begins at `time`, s; `volume` of a particle, m3. Not while it settles."""
        if np.isnan(self._power):
            self._power = self._now(flow, bodies, self._case.water.density * volume, time)
        if self._channel is None or time < 0.0:
            return
        p, at = flow.particles, flow.near.fluid
        sums = flow.domain.sum(np.stack([p.u[at], np.ones(at.size)], axis=1), self._units)
        speed, number = sums.tolist()
        if number == 0.0:
            self.discharge, self.drive = 0.0, 0.0
            return
        length = self._case.box.size[0]
        self.discharge = speed * volume / length
        lag = (at_time(self._channel.discharge, time) - self.discharge) * length / (number * volume)  # m/s
        self.drive = lag / self._channel.relaxation + self._integral
        pulled = self._case.water.density * speed * volume  # kg m/s
        pulled += float((bodies.mass * bodies.velocity[:, 0])[~(bodies.held(time) | bodies.gone)].sum())
        self.work += dt * pulled * self.at(time)[0]
        self._integral += dt * lag / (_INTEGRAL * self._channel.relaxation * self._channel.relaxation)

    def count(self, flow: Flow, bodies: Bodies, mass: float, time: float, dt: float) -> None:
        """Count the work of a box that moves, or is tilted, in a step of dt, s, that ended at `time`, s; `mass` of a
        particle, kg."""
        power = self._now(flow, bodies, mass, time)
        self.work += 0.5 * dt * (self._power + power)
        self._power = power

    def _now(self, flow, bodies, mass, time):
        """The power, W, of what `count` counts."""
        if not (self.moving or self._tilted):
            return 0.0
        p, at, free = flow.particles, flow.near.fluid, ~(bodies.held(time) | bodies.gone)
        place, velocity = (Vectors(*(part[at] for part in parts)) for parts in (p.place, p.velocity))
        if self.moving:
            power, on = self.moving.power(time, place, velocity), self.moving.power_on(time, bodies)
        else:
            gravity = gravity_at(self._case, time)
            power = sum(gravity[axis] * velocity[axis] for axis in self._tilted)
            on = bodies.mass * sum(gravity[axis] * bodies.velocity[:, axis] for axis in self._tilted)
        return float(flow.domain.sum(mass * power[:, None], self._watt)[0]) + float(on[free].sum())

    def kept(self) -> dict[str, np.ndarray]:
        """What a restart needs."""
        return {"drive": np.array([self.discharge, self.drive, self.work, self._integral, self._power])}

    def restore(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        self.discharge, self.drive, self.work, self._integral, self._power = map(float, kept["drive"])
