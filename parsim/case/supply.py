"""Supplies of ice: the floes that will come in through the inlet of a case, drawn in their order. Lengths in m."""

import itertools
import math

from parsim.case import ice_faults
from parsim.case.course import at_time, least, times_of, wrong_course
from parsim.case.openings import inlet_of, level_at_start
from parsim.errors import InputError
from parsim.ice.draw import drawn
from parsim.ice.field import MOST

_MORE = 1.2  # floes are drawn for so much of what concentration and discharge lead to: the level may fall
_UNDER = 2.0  # spacings of water under a floe as it comes in


def read(case, given):
    """(a supply with what its files say, messages)."""
    supply, wrong = ice_faults.read(given, case.dimensions)
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


def _wanted(case, supply):
    """What it may have given until it ends."""
    ends = case.run.until if supply.ends is None else supply.ends
    if ends <= supply.begins:
        return 0.0
    asked, total = _asked(case, supply), 0.0
    courses = [case.box.faces.x_min.discharge, case.box.faces.x_min.level, supply.discharge]
    times = sorted(time for time in {supply.begins, ends, *times_of(*courses)} if supply.begins <= time <= ends)
    for first, last in itertools.pairwise(times):
        parts = [asked(time) for time in (first, 0.5 * (first + last), last)]
        total += (last - first) * (parts[0] + 4.0 * parts[1] + parts[2]) / 6.0  # Simpson: nearly straight in between
    return total * (_MORE if supply.discharge is None else 1.0)


def lasts_to(case, supply):
    """Until when, s, the floes that a supply has are enough; at most the end of the run."""
    have, low, high = supply.floes or 0, supply.begins, case.run.until
    if len(floes(case, supply)) <= have:
        return high
    for _ in range(20):
        middle = 0.5 * (low + high)
        enough = len(floes(case, supply.model_copy(update={"ends": middle}))) <= have
        low, high = (middle, high) if enough else (low, middle)
    return low


def _asked(case, supply):
    """The function of time, s, that gives its `rate` in the water that the case asks for, as if it never ended."""
    if supply.discharge is not None:
        return lambda time: at_time(supply.discharge, time)
    side, inlet, low = case.box.faces.x_min, inlet_of(case), _lowest(case)

    def asked(time):
        area, width, depth = inlet(low if side.level is None else at_time(side.level, time))
        share = _at_surface(case, depth)
        return supply.concentration * width * share * at_time(side.discharge, time) / area

    return asked


def _at_surface(case, depth):
    """The speed of the uppermost water that comes in, over the mean."""
    profile = case.box.faces.x_min.profile
    return 1.0 if profile is None else float(profile.at(max(depth - 0.5 * case.spacing, 0.0), depth))


def _lowest(case):
    """To what level the water at the inlet may fall, m: to that of the outlet, but not below half of its depth."""
    start, out = level_at_start(case), case.box.faces.x_max
    asked = [least(out.level)] if out.kind == "outlet" and out.level is not None else []
    depth = inlet_of(case)(start)[2]
    return max(min([start, *asked]), start - 0.5 * depth)


def _least_level(case):
    """The least level of the water that comes in, m: where it is that of the water inside, at the start."""
    level = case.box.faces.x_min.level
    return level_at_start(case) if level is None else least(level)


def _wrong(case, supply):
    """What is wrong with a supply before anything is drawn: messages that begin with the key."""
    if case.box.faces.x_min.kind != "inlet":
        yield f'name = "{supply.name}": floes come in through an inlet; box.faces.x_min must be of the kind "inlet"'
        return
    area, _, depth = (0.0,) * 3 if case.spacing is None else inlet_of(case)(_least_level(case))
    if area <= 0.0:
        yield f'name = "{supply.name}": there is no {"spacing" if case.spacing is None else "water at the inlet"}'
        return
    profile = case.box.faces.x_min.profile
    if profile is not None and ([*profile.faults(depth)] or _at_surface(case, depth) <= 0.0):
        yield f'name = "{supply.name}": the water has no speed at the surface; box.faces.x_min.profile is wrong'
        return
    if (supply.concentration is None) == (supply.discharge is None):
        told = "none" if supply.discharge is None else "both"
        yield f"concentration, discharge: {told} given; must be exactly one"
        return
    if supply.discharge is not None:
        yield from wrong_course("discharge", supply.discharge)
        if (lowest := least(supply.discharge)) < 0.0:
            yield f"discharge = {lowest:g}: must be 0 or more; ice comes in"
    if supply.begins >= case.run.until:
        yield f"begins = {supply.begins!r}: must be before the end of the run, run.until = {case.run.until!r} s"
    if supply.ends is not None and supply.ends <= supply.begins:
        yield f"ends = {supply.ends!r}: must be after begins = {supply.begins!r} s"
    if supply.floes is not None:
        yield from ice_faults.missing(case, supply)
        return
    yield from ice_faults.common(case, supply)


def _check(case, supply, found):
    """Refuse floes that are too thin for particles, too thick for the inlet or too wide."""
    ice_faults.check_thickness(case, found)
    (_, _, depth), thickest = inlet_of(case)(_least_level(case)), max(floe.thickness for floe in found)
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
