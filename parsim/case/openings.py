"""What may be wrong with inlet and outlet of a case."""

import functools
import itertools
import math

import numpy as np

from parsim.case import places
from parsim.case.bodies import placed
from parsim.case.course import at_time, highest, least, times_of, wrong_course
from parsim.case.fill import water_at
from parsim.geometry.faces import SIDES, walled_sides
from parsim.solid.shapes.bed import BedShape

_PLACE = {"inlet": "x_min", "outlet": "x_max"}
_LOOKS = 101  # places across at which water is looked for
_MOST = 500  # columns, and rows of them, in which an inlet is looked at


def faults(case):
    """What is wrong with inlet and outlet of a completed case: messages."""
    found, faces = [], case.box.faces
    for name in itertools.chain(*SIDES):
        kind = getattr(faces, name).kind
        if _PLACE.get(kind, name) != name:
            found.append(f'box.faces.{name} = "{kind}": must be {_PLACE[kind]}; the water flows along x')
        elif kind in _PLACE and not (case.water.scheme.WET and case.water.fill):
            found.append(f'box.faces.{name} = "{kind}": there is no water, water.fill, to begin with')
        elif kind in _PLACE and case.gravity[2] >= 0.0:
            found.append(f"box.faces.{name}.kind: gravity = {list(case.gravity)}: must go along -z beside an {kind}")
        elif kind in _PLACE:
            found += [f"box.faces.{name}.{text}" for text in {"inlet": _inlet, "outlet": _outlet}[kind](case)]
    return found


def _inlet(case):
    side, standing = case.box.faces.x_min, standing_at(case, case.box.min[0])
    if standing is None:
        yield f"kind: no fill reaches the inlet, x = {case.box.min[0]!r} m; the water must begin there"
        return
    for key in ("discharge", "level"):
        course = getattr(side, key)
        if course is not None:
            yield from wrong_course(key, course)
            if least(course) < 0.0 and key == "discharge":
                yield f"discharge = {least(course):g}: must be 0 or more; it flows in"
    floor, what = _ground(case, case.box.min[0])
    if side.level is not None:
        if least(side.level) <= floor + case.spacing:
            yield f"level = {least(side.level):g}: must be more than a spacing above the {what}, {floor!r} m"
            return
        yield from _over_the_top(case, "level", highest(side.level))
    yield from _fast(case)
    if side.profile is not None:
        depth = (standing[1] if side.level is None else at_time(side.level, 0.0)) - case.box.min[2]
        wrong = side.profile.faults(depth) or _backward(side.profile)
        yield from (f"profile.{text}" for text in wrong)


def doubts(case):
    """What is allowed but doubtful in inlet and outlet: messages."""
    come, gone = case.box.faces.x_min, case.box.faces.x_max
    most = highest(come.discharge) if come.kind == "inlet" else 0.0
    if come.kind == "inlet" and come.profile is not None:
        mean, _, _, depth = _fastest(case)
        fast = mean * float(np.max(come.profile.at(np.linspace(0.0, 1.0, 101) * depth, depth)))
        if fast > case.speed:
            yield (
                f"box.faces.x_min.profile: comes in at up to {fast:.4g} m/s, more than the largest expected speed, "
                f"{case.speed:.4g} m/s; give water.speed"
            )
    for supply in case.ice.supplies if come.kind == "inlet" else ():
        if supply.discharge is not None and highest(supply.discharge) > most:
            yield (
                f"ice.supplies.{supply.name}.discharge: up to {highest(supply.discharge):g}, more than of "
                f"the water, {most:g}"
            )
    if gone.kind == "outlet" and gone.rating is not None and gone.rating[-1][0] < most:
        yield (
            f"box.faces.x_max.rating: ends at {gone.rating[-1][0]:g}, and up to {most:g} come in; beyond its end the "
            "level stays what it is there"
        )


def _fastest(case):
    """Of the water that comes in fastest: mean speed, m/s, discharge, area, and greatest depth, m."""
    side, inlet, fastest = case.box.faces.x_min, inlet_of(case), (0.0, 0.0, 0.0, case.spacing)
    start = level_at_start(case)
    for time in (0.0, *times_of(side.discharge, side.level)):
        level = start if side.level is None else at_time(side.level, time)
        (area, _, depth), discharge = inlet(level), at_time(side.discharge, time)
        if area > 0.0:  # else the box is told of elsewhere
            fastest = max(fastest, (discharge / area, discharge, area, depth))
    return fastest


def _fast(case):
    """Whether the water comes in faster than is expected, at any time."""
    mean, discharge, area, _ = _fastest(case)
    if mean > case.speed:
        yield (
            f"discharge = {discharge:g}: is {mean:.4g} m/s through {area:.4g} m2, more than the largest expected "
            f"speed, {case.speed:.4g} m/s; give water.speed"
        )


def _over_the_top(case, key, level):
    if level > case.box.max[2]:
        yield f"{key} = {level:g}: must be below the top of the box, {case.box.max[2]!r} m"


def _backward(profile):
    """What is wrong with a profile of water that comes in, which another one of a fill may have."""
    shares = getattr(profile, "shares", (1.0,))
    if min(shares) < 0.0:
        return [f"shares = {list(shares)}: must be 0 or more; it flows in"]
    return [] if max(shares) > 0.0 else [f"shares = {list(shares)}: must not all be 0; it flows in"]


def level_at_start(case):
    """Level of the water that stands at the inlet at the start, m; that of the floor where there is none."""
    standing = standing_at(case, case.box.min[0] + 0.5 * case.spacing)
    return standing[1] if standing else case.box.min[2]


def standing_at(case, x):
    """Bottom and level, m, of the water that stands at x amid the box, else of the highest beside; None without."""
    low, high = case.box.min[1], case.box.max[1]
    if amid := water_at(case.water.fill, x, 0.5 * (low + high)):
        return amid
    beside = (water_at(case.water.fill, x, y) for y in np.linspace(low, high, _LOOKS).tolist())
    return max(filter(None, beside), key=lambda water: water[1], default=None)


def section_of(case, x):
    """The function of a level, m, that gives the section of the water at x, m, over what is fixed and stands there.

    Its area, m2 (2D: m), the width of its surface, m (2D: 1), and its greatest depth, m, in columns a spacing wide, or
    wider in a large box.
    """
    low = case.box.min
    y, z = (low[a] + (np.arange(n) + 0.5) * case.box.size[a] / n for a, n in ((a, _columns(case, a)) for a in (1, 2)))
    points = np.stack([part.ravel() for part in np.meshgrid(x, y, z, indexing="ij")], axis=1)
    solid = np.zeros(len(points), bool)
    for place in (places.of_body(body) for body in placed(case) if body.fixed):
        if place.low()[0] <= points[0, 0] <= place.high()[0]:
            solid |= places.clearance(place, points) <= 0.0
    stands = np.minimum.accumulate(solid.reshape(y.size, z.size), axis=1).mean(axis=1) * case.box.size[2]

    @functools.lru_cache(maxsize=16)
    def at(level):
        depth = np.maximum(level - low[2] - stands, 0.0)
        return float(depth.mean()) * case.width, float((depth > 0.0).mean()) * case.width, float(depth.max())

    return at


def inlet_of(case):
    """The section of the water that comes in: see `section_of`."""
    return section_of(case, case.box.min[0] + 0.5 * case.spacing)


def normal_level(discharge, manning, slope, section, walls, floor):
    """Level, m, of uniform flow by Manning in a section, see `section_of`, with so many walls beside.

    The wetted perimeter is the width of the surface and the mean depth at each wall.
    """
    if discharge <= 0.0:
        return floor

    def flow(level):
        area, width, _ = section(level)
        if area <= 0.0:
            return 0.0
        return area * (area / (width + walls * area / width)) ** (2.0 / 3.0) * math.sqrt(slope) / manning

    low, high = 0.0, (manning * discharge / (section(math.inf)[1] * math.sqrt(slope))) ** 0.6
    while flow(floor + high) < discharge:
        low, high = high, 2.0 * high
    while high - low > 1e-9 * high:
        depth = 0.5 * (low + high)
        low, high = (depth, high) if flow(floor + depth) < discharge else (low, depth)
    return floor + 0.5 * (low + high)


def _columns(case, axis):
    """How many columns a section is looked at in across, or how many rows up."""
    return 1 if axis not in case.axes else min(max(round(case.box.size[axis] / case.spacing), 1), _MOST)


def _outlet(case):
    side = case.box.faces.x_max
    given = [key for key in ("level", "rating", "normal") if getattr(side, key) is not None]
    if len(given) != 1:
        told = " and ".join(given) or "none"
        yield f"level, rating, normal: {told} given; must be exactly one"
        return
    floor, what = _ground(case, case.box.max[0])
    if side.level is not None:
        yield from wrong_course("level", side.level)
        low, high = least(side.level), highest(side.level)
        if low <= floor:
            yield f"level = {low:g}: must be above the {what}, {floor!r} m"
        yield from _over_the_top(case, "level", high)
    if side.rating is not None:
        rows = np.array(side.rating)
        for column, name in enumerate(("discharge", "level")):
            fall = np.flatnonzero(np.diff(rows[:, column]) <= 0.0)
            if fall.size:
                low, high = rows[fall[0] : fall[0] + 2, column]
                yield f"rating: {name} {high:g} after {low:g}: must grow from row to row"
        if rows[:, 1].min() <= floor:
            yield f"rating: level {rows[:, 1].min():g} m: must be above the {what}, {floor!r} m"
        yield from _over_the_top(case, "rating: level", rows[:, 1].max())
    if side.normal is not None and case.box.faces.x_min.kind == "inlet":
        section = section_of(case, case.box.max[0] - 0.5 * case.spacing)
        walls, most = sum(axis == 1 for axis, _, _ in walled_sides(case)), highest(case.box.faces.x_min.discharge)
        level = normal_level(most, side.normal.manning, side.normal.slope, section, walls, case.box.min[2])
        if level > case.box.max[2]:
            yield (
                f"normal: uniform flow of what comes in, {most:g}, has its level at {level:.4g} m; must be below the "
                f"top of the box, {case.box.max[2]!r} m"
            )


def _ground(case, x):
    """(height of the lowest ground at x, m; what it is)."""
    for body in case.bodies:
        if isinstance(body.shape, BedShape):
            y = np.linspace(case.box.min[1], case.box.max[1], max(round(case.box.size[1] / case.spacing), 1) + 1)
            return round(float(body.shape.heights.at(np.full(y.size, x), y).min()), 9), "bed"
    return case.box.min[2], "floor"
