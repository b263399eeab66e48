"""The measures of a river applied to a finished run whose case has a table `measure`."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.case.model import parse
from parsim.geometry.faces import period, repeats
from parsim.river import ice, jam, profiles, water
from parsim.river.columns import columns_of
from parsim.river.piers import Peaks
from parsim.river.planes import discharge, passed, stored
from parsim.river.raster import cuts_of

if TYPE_CHECKING:
    from parsim.output.reader import Run


class Fields(NamedTuple):
    """Of each frame and column (frames, nx, ny), NaN where there is nothing; time (frames,), s. Water: bottom, top and
    piezometric level, m, velocity, m/s. Ice: concentration; solid and jam thickness, m; low and high, its INNER
    heights, m; speed, m/s."""

    time: np.ndarray
    bottom: np.ndarray
    top: np.ndarray
    level: np.ndarray
    velocity: np.ndarray
    concentration: np.ndarray
    solid: np.ndarray
    jam: np.ndarray
    low: np.ndarray
    high: np.ndarray
    speed: np.ndarray


class Tracks(NamedTuple):
    """Of each row from 0 s on and body (T, nb, ...), NaN where one is not there: time (T,), s; x, m, without jumps at
    sides that repeat; home, m, the same in the box; y and z, m; speed along x, m/s; quaternion (T, nb, 4)."""

    time: np.ndarray
    x: np.ndarray
    home: np.ndarray
    y: np.ndarray
    z: np.ndarray
    speed: np.ndarray
    quaternion: np.ndarray


class River:
    """A run measured; raises InputError for a mesh that is gone. Ice is what is not fixed."""

    def __init__(self, run: Run) -> None:
        case = self.case = parse(run.case)
        self.run, self.measure, self.planar = run, case.measure, case.dimensions == 2
        self.gravity = -case.gravity[2]
        self.reach = self.measure.reach or (case.box.min[0], case.box.max[0])
        edge = self.measure.grid or 2.0 * case.spacing
        self.columns = columns_of(case.box.min, case.box.max, edge, repeats(case)[:2], self.planar)
        self.period = (float(period(case)[0]), float(period(case)[1]))
        self.loose = np.array([not body.fixed for body in case.bodies], bool)
        self.ground = np.array([body.shape.kind == "bed" for body in case.bodies], bool)
        self.volume = np.array([body.shape.volume for body in case.bodies])
        thick = np.array([2.0 * body.shape.thinnest(self.planar) for body in case.bodies])
        self.size = _sizes(self.volume, thick, self.planar)
        self.floe = middle(thick[self.loose], self.volume[self.loose])
        self.window = water.window(case.depth, self.gravity)
        self._read: dict[str, dict[str, np.ndarray]] = {}

    @property
    def piers(self) -> list[int]:
        """Numbers of the bodies that are piers."""
        named, cover = self.measure.piers, self.measure.cover
        return [
            k
            for k, body in enumerate(self.case.bodies)
            if (body.fixed and not self.ground[k] and body.name != cover if named is None else body.name in named)
        ]

    def floor(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Heights (n,), m, of the floor of the box, or of the ground on it, at places x, y (n,), m."""
        found = np.full(len(x), float(self.case.box.min[2]))
        for k in np.flatnonzero(self.ground):
            found = np.maximum(found, self.case.bodies[k].shape.heights.at(x, y))
        return found

    @property
    def within(self) -> np.ndarray:
        """Which columns along x have their middle in the reach, one at least: (nx,) bool."""
        x, (begin, end) = self.columns.x, self.reach
        here = (x >= begin) & (x <= end)
        here[np.abs(x - 0.5 * (begin + end)).argmin()] = True
        return here

    @cached_property
    def fields(self) -> Fields:
        """`Fields` of all frames."""
        frames = [self._frame(k) for k in range(len(self.run.times("water")))]
        empty = [np.zeros((0, *self.columns.shape))] * (len(Fields._fields) - 1)
        each = [np.array(values) for values in zip(*frames, strict=True)] if frames else [np.zeros(0), *empty]
        return Fields(*each)

    def _frame(self, number):
        frame = self.run.water(number)
        wet = water.water_of(frame, self.columns, self.case.spacing, self.case.water.density * self.gravity)
        if frame["step"] == 0:  # there are no pressures yet
            wet = wet._replace(level=np.full(self.columns.shape, np.nan))
        if not self.loose.any():
            nothing, none = np.zeros(self.columns.shape), np.full(self.columns.shape, np.nan)
            return frame["time"], *wet, nothing, nothing, none, none, none, none
        bodies = self.run.bodies(number)
        floes = self.loose[bodies["body"]]
        cuts = cuts_of(bodies["points"], bodies["quads"][floes], bodies["body"][floes], self.columns)
        inner = ice.heights(cuts, self.columns)
        return (
            frame["time"],
            *wet,
            ice.concentration(cuts, self.columns),
            ice.solid_thickness(cuts, self.columns),
            ice.jam_thickness(inner, self.floe),
            *np.moveaxis(inner, -1, 0),
            ice.speed(cuts, bodies["velocity"][:, 0], self.columns),
        )

    def mean(self, name: str, end: float) -> np.ndarray:
        """A field (nx, ny) as its mean over the window of levels that ends at a time, s."""
        return profiles.mean_between(self.fields.time, getattr(self.fields, name), end - self.window, end)

    @cached_property
    def before(self) -> tuple[float, float]:
        """Begin and end, s, of the time before ice changes the level."""
        return self.measure.before or (0.0, self.window)

    def tilt(self, end: float) -> float:
        """What drives the flow along x over its weight, in the window that ends at a time, s: the slope of a tilted
        channel, and the force of one that holds a discharge."""
        driven = self._rows("channel")
        if not driven:
            return self.case.gravity[0] / self.gravity
        slope = profiles.mean_between(driven["time"], driven["energy_slope"], end - self.window, end)
        return float(slope)

    def _rows(self, name):
        """A series by its columns, empty where the run has not written it or it has no rows."""
        if name not in self._read:
            series = self.run.series(name) if name in self.run.series_names else {}
            self._read[name] = series if len(series.get("step", ())) else {}
        return self._read[name]

    def rise(self, end: float) -> np.ndarray:
        """How much higher the level is over the width (nx,), m, in the window that ends at a time, s, than before."""
        time, level = self.fields.time, self.fields.level
        if (told := np.isfinite(level).any(axis=(1, 2))).any():  # the frame of the start has no pressures
            time, level = time[told], level[told]
        earlier = profiles.mean_between(time, level, *self.before)
        return profiles.across(self.mean("level", end)).mean - profiles.across(earlier).mean

    def heads(self, end: float) -> np.ndarray:
        """Energy heads (nx,), m, in the window that ends at a time, s."""
        level, velocity, top, bottom = (self.mean(name, end) for name in ("level", "velocity", "top", "bottom"))
        velocity = profiles.through(velocity, top - bottom)
        return profiles.head(profiles.across(level).mean, velocity, self.gravity)

    def along(self, end: float) -> dict[str, np.ndarray]:
        """Profiles along x in the window that ends at a time, s: {name: values (nx,)}."""
        found = {"x": self.columns.x}
        names = {"level": "level", "velocity": "velocity", "solid_thickness": "solid", "jam_thickness": "jam"}
        for name, field in names.items():
            profile = profiles.across(self.mean(field, end))
            parts = zip(("", "_10", "_50", "_90"), profile, strict=True)
            found |= {f"{name}{part}": values for part, values in parts}
        others = {"bed": "bottom", "water_top": "top", "concentration": "concentration", "ice_speed": "speed",
                  "ice_low": "low", "ice_high": "high"}  # fmt: skip
        found |= {name: profiles.across(self.mean(field, end)).mean for name, field in others.items()}
        voids = ice.porosity(self.fields.solid, self.fields.jam)
        voids = profiles.mean_between(self.fields.time, voids, end - self.window, end)
        found["porosity"] = profiles.across(voids).mean
        found["layers"] = ice.layers(found["solid_thickness"], self.floe)
        return found | {"rise": self.rise(end), "head": self.heads(end)}

    def reach_means(self, end: float) -> dict[str, float]:
        """What holds for the reach as a whole in the window that ends at a time, s."""
        along, here, between = self.along(end), self.within, self.measure.head_loss
        x, heads = along["x"], along["head"]
        names = ("rise", "velocity", "concentration", "solid_thickness", "jam_thickness", "ice_speed")
        tilt = self.tilt(end)
        found = {"energy_slope": profiles.energy_slope(x[here], heads[here], tilt)}
        found["head_loss"] = profiles.head_loss(x, heads, between, tilt) if between else float("nan")
        return found | {name: profiles.mean_of(along[name][here]) for name in names}

    @cached_property
    def tracks(self) -> Tracks:
        """`Tracks` of all bodies by the series of bodies, without the rows in which they settle."""
        series, names = self.run.series("bodies"), {name: k for k, name in enumerate(self.run.body_names)}
        series = {name: values[series["time"] >= 0.0] for name, values in series.items()}
        time, row = np.unique(series["time"], return_inverse=True)
        body = np.array([names[name] for name in series["body"].tolist()], int)
        found = np.full((8, len(time), len(names)), np.nan)
        for k, name in enumerate(("x", "y", "z", "u", "q0", "q1", "q2", "q3")):
            found[k, row, body] = series[name]
        x, low = found[0], self.case.box.min[0]
        home = low + (x - low) % self.period[0] if np.isfinite(self.period[0]) else x
        return Tracks(time, x, home, found[1], found[2], found[3], np.moveaxis(found[4:], 0, -1))

    def passed(self, plane: float) -> np.ndarray:
        """Ice that has passed a plane, m, by each row of the tracks (T,), m3."""
        at, x, lost = self.loose, self.tracks.x.copy(), self._rows("lost")
        for k in np.flatnonzero(np.char.startswith(lost["what"], "body ")) if lost else ():
            row = np.searchsorted(self.tracks.time, lost["time"][k])
            x[row : row + 1, int(lost["id"][k])] = lost["x"][k]  # where it left, beyond planes since the row before
        first = np.isfinite(x).argmax(axis=0)
        came = np.flatnonzero(first > 0)
        x[first[came] - 1, came] = self.case.box.min[0]  # beyond planes since it came in
        return passed(x[:, at], self.volume[at], plane, self.period[0])

    def discharge(self, plane: float) -> np.ndarray:
        """Ice through a plane, m, at each row of the tracks (T,), m3/s: mean over the time that makes a jam."""
        return discharge(self.tracks.time, self.passed(plane), self.wait)

    def stored(self, reach: tuple[float, float] = (-np.inf, np.inf)) -> np.ndarray:
        """Ice in a reach, m, at each row of the tracks (T,), m3; of the whole box if none is named."""
        return stored(self.tracks.home[:, self.loose], self.volume[self.loose], reach)

    @cached_property
    def drift(self) -> float:
        """Mean speed of the water in the reach before ice changes the level, m/s."""
        velocity = profiles.mean_between(self.fields.time, self.fields.velocity, *self.before)
        here = velocity[self.within]
        return float(np.nanmean(here)) if np.isfinite(here).any() else 0.0

    @property
    def wait(self) -> float:
        """Time, s, over which ice must stand to have jammed; inf without a flow."""
        return jam.window(self.length, self.drift)

    @property
    def length(self) -> float:
        """Median size of the floes, m, by volume."""
        return middle(self.size[self.loose], self.volume[self.loose])

    def peaks(self, body: str, kind: str, part: str) -> Peaks | None:
        """What acted on a body from 0 s on, "water" or "contact", of "fx" to "mz"; None where no sensor has told."""
        series = self._rows("peaks")
        if not series:
            return None
        settled = series["time"] - series["span"] >= -1e-9
        here = (series["body"] == body) & (series["kind"] == kind) & settled
        if not here.any():
            return None
        sensor = series["sensor"][here][0]  # another one tells the same
        here &= series["sensor"] == sensor
        names = ("time", "span", f"{part}_impulse", f"{part}_min", f"{part}_max")
        return Peaks(*(series[name][here] for name in names))


@lru_cache(maxsize=1)
def river_of(run: Run) -> River:
    """The `River` of a run, made once for all that ask in turn."""
    return River(run)


def _sizes(volume, thick, planar):
    """Diameters of the discs (2D: lengths) as large in plan as bodies (n,), m, by volume, m3, and thickness, m; no body
    is less in plan than the ball in it that is as thick."""
    area = volume / thick
    return np.maximum(area if planar else np.sqrt(4.0 / np.pi * area), thick)


def middle(values: np.ndarray, weight: np.ndarray) -> float:
    """Median of values (n,) by weight (n,); NaN of none."""
    if not len(values):
        return float("nan")
    order = np.argsort(values)
    return float(values[order][np.searchsorted(np.cumsum(weight[order]), 0.5 * weight.sum())])
