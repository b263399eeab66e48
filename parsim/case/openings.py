"""What may be wrong with inlet and outlet of a case."""

import itertools

import numpy as np

from parsim.case.course import at_time, largest, least, wrong_course
from parsim.case.fill import water_at
from parsim.geometry.faces import SIDES
from parsim.solid.shapes.bed import BedShape

_PLACE = {"inlet": "x_min", "outlet": "x_max"}


def faults(case):
    """What is wrong with inlet and outlet of a completed case: messages."""
    found, faces = [], case.box.faces
    for name in itertools.chain(*SIDES):
        kind = getattr(faces, name).kind
        if _PLACE.get(kind, name) != name:
            found.append(f'box.faces.{name} = "{kind}": must be {_PLACE[kind]}; the water flows along x')
        elif kind in _PLACE and not (case.water.scheme.WET and case.water.fill):
            found.append(f'box.faces.{name} = "{kind}": there is no water, water.fill, to begin with')
        elif kind in _PLACE:
            found += [f"box.faces.{name}.{text}" for text in {"inlet": _inlet, "outlet": _outlet}[kind](case)]
    return found


def _inlet(case):
    side, middle = case.box.faces.x_min, 0.5 * (case.box.min[1] + case.box.max[1])
    standing = water_at(case.water.fill, case.box.min[0], middle)
    if standing is None:
        yield f"kind: no fill reaches the inlet, x = {case.box.min[0]!r} m; the water must begin there"
        return
    for key in ("discharge", "level"):
        course = getattr(side, key)
        if course is not None:
            yield from wrong_course(key, course)
            if least(course) < 0.0 and key == "discharge":
                yield f"discharge = {least(course):g}: must be 0 or more; it flows in"
    level = standing[1] if side.level is None else at_time(side.level, 0.0)
    floor, what = _ground(case, case.box.min[0])
    if side.level is not None and least(side.level) <= floor + case.spacing:
        yield f"level = {least(side.level):g}: must be more than a spacing above the {what}, {floor!r} m"
        return
    depth = level - case.box.min[2]
    width = case.width
    mean = largest(side.discharge) / (depth * width) if depth * width > 0.0 else 0.0  # the box is told of elsewhere
    if mean > case.speed:
        yield (
            f"discharge = {largest(side.discharge):g}: is {mean:.4g} m/s through {depth * width:.4g} m2, more than the "
            f"largest expected speed, {case.speed:.4g} m/s; give water.speed"
        )
    if side.profile is not None:
        yield from (f"profile.{text}" for text in side.profile.faults(depth))


def _outlet(case):
    side = case.box.faces.x_max
    given = [key for key in ("level", "rating", "normal") if getattr(side, key) is not None]
    if len(given) != 1:
        told = " and ".join(given) or "none"
        yield f"level, rating, normal: {told} given; must be exactly one"
        return
    (floor, what), top = _ground(case, case.box.max[0]), case.box.max[2]
    if side.level is not None:
        yield from wrong_course("level", side.level)
        low, high = least(side.level), largest(side.level)
        if low <= floor:
            yield f"level = {low:g}: must be above the {what}, {floor!r} m"
        if high > top:
            yield f"level = {high:g}: must be below the top of the box, {top!r} m"
    if side.rating is not None:
        rows = np.array(side.rating)
        for column, name in enumerate(("discharge", "level")):
            fall = np.flatnonzero(np.diff(rows[:, column]) <= 0.0)
            if fall.size:
                low, high = rows[fall[0] : fall[0] + 2, column]
                yield f"rating: {name} {high:g} after {low:g}: must grow from row to row"
        if rows[:, 1].min() <= floor:
            yield f"rating: level {rows[:, 1].min():g} m: must be above the {what}, {floor!r} m"


def _ground(case, x):
    """(height of the lowest ground at x, m; what it is)."""
    for body in case.bodies:
        if isinstance(body.shape, BedShape):
            y = np.linspace(case.box.min[1], case.box.max[1], max(round(case.box.size[1] / case.spacing), 1) + 1)
            return round(float(body.shape.heights.at(np.full(y.size, x), y).min()), 9), "bed"
    return case.box.min[2], "floor"
