"""Water that goes out: a zone beyond the side where it goes on with the water before it, under given pressure.

Beyond the side, over the depth of the support, the pressure is that of water at rest with the level there; the
particles go on as they came, faster and slower with the water before the side, not backward, and are taken out at its
end. So the water inside feels a level and nothing else. A wave from inside shows in the Riemann invariant that runs
out, V + 2 sqrt(g h); the level gives way to it such that the one that runs in is that of water without waves, which has
the mean speed and the level asked for.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from parsim.case.course import at_time
from parsim.case.openings import normal_level, section_of, standing_at
from parsim.geometry.faces import walled_sides
from parsim.particles.state import FLUID

if TYPE_CHECKING:
    from collections.abc import Callable

    from parsim.case.model import Case
    from parsim.particles.state import Particles

_TRAVELS = 5.0  # H / V, over which the discharge is averaged
_SWINGS = 4.0  # lengths of the box over sqrt(g H), over which the speed is averaged that waves are waves on
_AHEAD = 0.25  # depths that the water looked at is before the outlet: what is seen there comes so much later
_LAG = 0.1  # sqrt(H / g), of the velocity before the side that the zone follows: sound is not to shake it


class Outlet:
    """The outlet of a case at x_max. level, m: of the water beyond it now; discharge, m3/s (2D: m2/s), its mean.

    end, m: where the zone beyond it ends; removed: particles taken out there so far.
    """

    def __init__(self, case: Case, layers: int) -> None:
        self._side, self._case = case.box.faces.x_max, case
        self.x = case.box.max[0]
        self.end = self.x + layers * case.spacing
        self._length = case.box.size[0]
        self._floor, self._gravity = case.box.min[2], -case.gravity[2]
        self._section = section_of(case, self.x - 0.5 * case.spacing)
        self._beside = sum(axis == 1 for axis, _, _ in walled_sides(case))
        self._head = case.water.density * self._gravity
        self.discharge = self._mean = self._edge = math.nan
        self._gain = self._rise = 0.0
        standing = standing_at(case, self.x - 0.5 * case.spacing)
        self.level = standing[1] if standing else self._floor
        if self._side.level is not None:
            self.level = at_time(self._side.level, case.start)
        self.removed = 0
        self._near = self._at = np.zeros(0, np.int64)
        self._speed, self._true, self._real = np.zeros(0), np.zeros(0, bool), slice(0, 0)

    def follow(self, level: float, speed: float, edge: float, time: float, dt: float) -> None:
        """Set the level of the next step by what was seen inside over dt, s: mean level, m, and speed, m/s.

        edge, m/s: the mean speed right before the side.
        """
        area, _, _ = self._section(level if math.isfinite(level) else self._floor)
        depth, speed = max(self._depth(level), self._case.spacing), speed if math.isfinite(speed) else 0.0
        wave, flow = math.sqrt(self._gravity * depth), speed * area
        if math.isnan(self._mean):
            self._mean, self.discharge = speed, flow
        lag = _TRAVELS * depth / max(abs(speed), 0.1 * wave)
        self.discharge += min(dt / lag, 1.0) * (flow - self.discharge)
        self._mean += min(dt * wave / (_SWINGS * self._length), 1.0) * (speed - self._mean)
        self._pass_on(edge, min(dt / (_LAG * math.sqrt(depth / self._gravity)), 1.0))
        level = self._asked(time)
        asked = self._depth(level)
        kept = 0.25 * (speed + 2.0 * wave - self._mean) + 0.5 * math.sqrt(self._gravity * asked)
        rise = self._side.absorb * (kept * kept / self._gravity - asked)
        travel = _AHEAD * depth / (wave + max(speed, 0.0))
        self._rise += min(dt / travel, 1.0) * (rise - self._rise)
        self.level = max(level + self._rise, self._floor)

    def _depth(self, level):
        """Mean depth, m, of the water before the side over what stands there."""
        area, width, _ = self._section(level if math.isfinite(level) else self._floor)
        return area / width if width > 0.0 else 0.0

    @property
    def speed(self) -> float:
        """Of the water right before the side, a mean over a short time, m/s; 0 where it flows back."""
        return max(self._edge, 0.0) if math.isfinite(self._edge) else 0.0

    def _pass_on(self, edge, share):
        """Let the zone go faster or slower with the water before it, a `share` of what is wanting in this step."""
        if not math.isfinite(edge):
            self._gain = 0.0
            return
        before = edge if math.isnan(self._edge) else self._edge
        self._edge = before + share * (edge - before)
        self._gain = self._edge - before

    def _asked(self, time):
        """The level without waves, m."""
        side = self._side
        if side.level is not None:
            return at_time(side.level, time)
        flow = max(self.discharge, 0.0)
        if side.rating is not None:
            return at_time(side.rating, flow)
        return normal_level(flow, side.normal.manning, side.normal.slope, self._section, self._beside, self._floor)

    def find(self, p: Particles, own: slice) -> None:
        """Note which of this rank's particles `p` may be in the zone before the lists are built anew."""
        self._near = np.flatnonzero((p.kind == FLUID) & (p.x > self.x - 2.0 * self._case.spacing))
        self._real = own

    def hold(self, p: Particles, at_rest: Callable[[np.ndarray], dict[str, np.ndarray]]) -> None:
        """Give the water in the zone its pressure, and note what velocity it goes on with."""
        at = self._at = self._near[p.x[self._near] > self.x]
        p.p[at] = self._head * np.maximum(self.level - p.z[at], 0.0)
        for name, values in at_rest(p.p[at]).items():
            getattr(p, name)[at] = values
        self._speed, self._true = p.u[at] + self._gain, p.image[at] == 0

    def release(self, p: Particles) -> None:
        """Give the water in the zone the velocity that it goes on with, downstream."""
        at = self._at
        p.u[at] = np.maximum(self._speed, 0.0)
        p.v[at] = p.w[at] = 0.0

    def turned(self) -> np.ndarray:
        """Of this rank's water in the zone in the last step which was kept from going back: bool (n,)."""
        own, at = self._real, self._at
        return self._speed[(at >= own.start) & (at < own.stop) & self._true] < 0.0

    def kept(self) -> dict[str, np.ndarray]:
        """What a restart needs."""
        held = [self.level, self.discharge, self._mean, self._edge, self._gain, self._rise, float(self.removed)]
        return {"outlet": np.array(held)}

    def restore(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        *held, removed = map(float, kept["outlet"])
        self.level, self.discharge, self._mean, self._edge, self._gain, self._rise = held
        self.removed = int(removed)
