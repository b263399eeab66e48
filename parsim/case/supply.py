"""Supplies of ice: the floes that will come in through the inlet of a case, drawn in their order. Lengths in m."""

import itertools
import math

from parsim.case import ice_faults
from parsim.case.course import at_time, least, wrong_course
from parsim.case.fill import water_at
from parsim.errors import InputError
from parsim.ice.draw import drawn
from parsim.ice.field import MOST

_MORE = 1.2  # floes are drawn for so much of what concentration and discharge lead to: the level may fall
_UNDER = 2.0  # spacings of water under a floe as it comes in


def read(case, given):
    """(a supply with what its files say, messages)."""
    supply, wrong = ice_faults.read(given)
    return supply, wrong or [*_wrong(case, supply)]


def floes(case, supply):
    """The floes of a supply in the order in which they come, as many as can until it ends. Raises InputError."""
    wanted, found, total = _wanted(case, supply), [], 0.0
    for floe in drawn(supply.seed, supply.stream, supply.laws(case.dimensions)):
        found.append(floe)
        total += amount(supply, floe.area, floe.thickness)
        if total > wanted:
            break
        if len(found) == MOST:
            raise InputError(f"size: more than {MOST} floes come in; make them larger or the supply smaller")
    _check(case, supply, found)
    return found


def amount(supply, area, thickness):
    """What a floe counts of what a supply gives: its area, m2, or its volume, m3."""
    return area if supply.discharge is None else area * thickness


def rate(supply, time, width, speed):
    """What a supply is to give at a time: m2/s through an inlet of this width whose surface has this speed, or m3/s."""
    if not supply.begins <= time < (math.inf if supply.ends is None else supply.ends):
        return 0.0
    return supply.concentration * width * speed if supply.discharge is None else at_time(supply.discharge, time)


def _depth(case):
    """Depth of the water at the inlet at the start, m."""
    x, y = case.box.min[0] + 0.5 * case.spacing, 0.5 * (case.box.min[1] + case.box.max[1])
    water = water_at(case.water.fill, x, y)
    return water[1] - case.box.min[2] if water else 0.0


def _wanted(case, supply):
    """What it may have given until it ends."""
    inlet, depth, width = case.box.faces.x_min, _depth(case), case.width
    share = 1.0 if inlet.profile is None else float(inlet.profile.at(depth, depth))
    ends = case.run.until if supply.ends is None else supply.ends
    if ends <= supply.begins:
        return 0.0
    times = [supply.begins, ends]
    for course in (inlet.discharge, supply.discharge):
        times += [] if isinstance(course, float | None) else [time for time, _ in course]
    times = sorted(time for time in {*times} if supply.begins <= time <= ends)
    total = 0.0
    for first, last in itertools.pairwise(times):
        middle = 0.5 * (first + last)  # straight in between
        speed = share * at_time(inlet.discharge, middle) / (width * depth)
        total += (last - first) * rate(supply, middle, width, speed)
    return total * (_MORE if supply.discharge is None else 1.0)


def _wrong(case, supply):
    """What is wrong with a supply before anything is drawn: messages that begin with the key."""
    if case.box.faces.x_min.kind != "inlet":
        yield f'name = "{supply.name}": floes come in through an inlet; box.faces.x_min must be of the kind "inlet"'
        return
    if _depth(case) * case.width <= 0.0:
        yield f'name = "{supply.name}": there is no water at the inlet'
        return
    if (supply.concentration is None) == (supply.discharge is None):
        told = "none" if supply.discharge is None else "both"
        yield f"concentration, discharge: {told} given; must be exactly one"
        return
    if supply.discharge is not None:
        yield from wrong_course("discharge", supply.discharge)
        if (lowest := least(supply.discharge)) < 0.0:
            yield f"discharge = {lowest:g}: must be 0 or more; ice comes in"
    if supply.ends is not None and supply.ends <= supply.begins:
        yield f"ends = {supply.ends!r}: must be after begins = {supply.begins!r} s"
    if supply.floes is not None:
        yield from ice_faults.missing(case, supply)
        return
    yield from ice_faults.common(case, supply)


def _check(case, supply, found):
    """Refuse floes that are too thin for particles, too thick for the inlet or too wide."""
    ice_faults.check_thickness(case, found)
    depth, thickest = _depth(case), max(floe.thickness for floe in found)
    draught = supply.density / case.water.density * thickest
    if draught > depth - _UNDER * case.spacing:
        raise InputError(
            f"thickness: reaches {thickest:.6g} m, a draught of {draught:.6g} m; water must come in under it, "
            f"{_UNDER:g} spacings at least, and the inlet is {depth:.6g} m deep"
        )
    if (most := max(floe.size for floe in found)) > case.box.size[0]:
        raise InputError(f"size: reaches {most:.6g} m; must be at most the length of the box, {case.box.size[0]:.6g} m")
    if case.dimensions == 2:
        return
    room = case.box.size[1] - 2.0 * supply.apart(case)
    wide = [floe.size for floe in found if _least_width(floe) > room]
    if wide:
        raise InputError(
            f"size: {len(wide)} of {len(found)} floes are wider than the inlet, the largest of {max(wide):.6g} m; it "
            f"has room for {room:.6g} m"
        )


def _least_width(floe):
    """Width across of a floe that is turned lengthwise, m."""
    return floe.size if floe.round else float(floe.outline[:, 1].max() - floe.outline[:, 1].min())
