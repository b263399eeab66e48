"""The water at the start: which fills are one water, how fast it is, and checks. Lengths in m, speeds in m/s."""

import math

import numpy as np

from parsim.case import places
from parsim.geometry.faces import repeats

TOUCH = 1e-9  # m: a smaller overlap or gap is rounding
_MISSED = 0.005  # share of the water asked for that may be missing, or too much, without a word


def water_at(fills, x, y):
    """Bottom and level of the highest water at a place, of fills that touch as one water; None where there is none."""
    here = [f for f in fills if f.min[0] <= x <= f.max[0] and f.min[1] <= y <= f.max[1]]
    if not here:
        return None
    highest, *lower = sorted(here, key=lambda fill: -fill.max[2])
    bottom = highest.min[2]
    for fill in lower:
        if abs(fill.max[2] - bottom) <= TOUCH:
            bottom = fill.min[2]
    return bottom, highest.max[2]


def level_over(fills, fill, x, y):
    """Level (n,) of the water over points x, y (n,) of `fill`, which goes on in the fills that touch it from above."""
    level = np.full(x.size, fill.max[2])
    for upper in sorted(fills, key=lambda fill: fill.min[2]):
        on = np.abs(level - upper.min[2]) <= TOUCH
        for axis, place in enumerate((x, y)):
            on &= (place >= upper.min[axis]) & (place <= upper.max[axis])
        level[on] = upper.max[2]
    return level


def corners(case, fill):
    """Lowest and highest corner (3,), m, of the particles of a fill: at an outlet it goes on over the zone beyond."""
    high, end = fill.max, case.box.max[0]
    if case.box.faces.x_max.kind == "outlet" and high[0] >= end - TOUCH:
        high = (end + case.layers * case.spacing, *high[1:])
    return fill.min, high


def profile_shares(fill, z):
    """The velocity at heights z (n,) over the mean of the fill: (n,)."""
    if fill.profile is None:
        return np.ones(z.size)
    return fill.profile.at(z - fill.min[2], fill.max[2] - fill.min[2])


def faults(case):
    """What is wrong with the fills of a completed case: a list of messages."""
    found = []
    for i, fill in enumerate(case.water.fill):
        texts = [*_place(case, fill), *_profile(fill)] or list(_speed(case, fill))
        found += [f"water.fill.{i}.{text}" for text in texts]
    return found + _overlaps(case.water.fill)


def doubts(case):
    """What is allowed but doubtful in the fills of a checked case: a list of messages."""
    return [
        f"water.fill.{i}{text}"
        for i, fill in enumerate(case.water.fill)
        for text in (*_motion(case, fill), *_thin(case, fill), *_amount(case, fill))
    ]


def _place(case, fill):
    low, high = case.box.min, case.box.max
    for axis, name in enumerate("xyz"):
        if not fill.min[axis] < fill.max[axis]:
            yield f"max = {list(fill.max)}: empty, {name} must be greater than that of min = {list(fill.min)}"
        for key, value in (("min", fill.min[axis]), ("max", fill.max[axis])):
            if not low[axis] - TOUCH <= value <= high[axis] + TOUCH:
                yield f"{key} = {list(getattr(fill, key))}: {name} is outside the box, {low[axis]!r} to {high[axis]!r}"
    if case.dimensions == 2 and (fill.min[1], fill.max[1]) != (0.0, 1.0):
        yield f"min, max: y = {fill.min[1]!r} to {fill.max[1]!r}: must be 0 to 1 in a 2D case"
    if case.dimensions == 2 and fill.velocity[1]:
        yield f"velocity = {list(fill.velocity)}: y must be 0 in a 2D case"


def _profile(fill):
    """What is wrong with a profile in the depth of its fill."""
    if fill.profile is not None:
        yield from (f"profile.{text}" for text in fill.profile.faults(fill.max[2] - fill.min[2]))


def _shares(fill):
    """The shares of the mean velocity at 1000 heights, even over the depth."""
    return profile_shares(fill, fill.min[2] + (np.arange(1000) + 0.5) / 1000 * (fill.max[2] - fill.min[2]))


def _fastest(fill):
    """The largest speed of a fill."""
    return math.hypot(*fill.velocity) * float(np.abs(_shares(fill)).max())


def _speed(case, fill):
    fastest, sound = _fastest(fill), case.sound_speed
    if fastest >= sound > 0:
        yield (
            f"velocity = {list(fill.velocity)}: reaches {fastest:.4g} m/s, must be less than the speed of sound in the "
            f"model, {sound:.4g} m/s = water.scheme.sound x water.speed; give water.speed, the largest expected speed"
        )


def _overlaps(fills):
    boxes = [places.upright(fill.min, fill.max) for fill in fills]
    return [
        f"water.fill.{j}: overlaps water.fill.{i}"
        for i, j, shift in places.near_pairs(boxes)
        if places.overlap(boxes[i], boxes[j]) > TOUCH
    ]


def _motion(case, fill):
    """Doubts about the velocity of a fill and its profile."""
    if any(fill.velocity) and (fastest := _fastest(fill)) > case.speed * (1.0 + 1e-6):
        yield (
            f".velocity = {list(fill.velocity)}: reaches {fastest:.4g} m/s, more than the largest expected speed, "
            f"{case.speed:.4g} m/s; give water.speed, or the water is compressed too much"
        )
    if fill.profile is not None and not any(fill.velocity):
        yield ".profile: has no effect, for velocity, which is its mean, is [0.0, 0.0, 0.0]"
    elif fill.profile is not None and fill.profile.kind == "table" and abs((mean := _shares(fill).mean()) - 1.0) > 0.01:
        yield f".profile.shares: their mean over the depth is {mean:.4g}, so is that of the fill over its velocity"


def _thin(case, fill):
    """Doubts about a fill with fewer particles across than the support has, on axes along which no other touches it."""
    for axis in case.axes:
        length, name = fill.max[axis] - fill.min[axis], "xyz"[axis]
        endless = repeats(case)[axis] and length >= case.box.size[axis] - TOUCH
        alone = not any(_touches(fill, other, axis) for other in case.water.fill)
        if length < case.water.scheme.support * case.spacing - TOUCH and alone and not endless:
            yield (
                f": {max(1, round(length / case.spacing))} particles along {name}, {length:.6g} m; fewer than the "
                f"support, {case.water.scheme.support:g}, give coarse pressures and levels"
            )


def _touches(fill, other, axis):
    """Whether two fills share a part of the faces that look along an axis."""
    faces = abs(fill.max[axis] - other.min[axis]) <= TOUCH or abs(other.max[axis] - fill.min[axis]) <= TOUCH
    return faces and all(
        min(fill.max[a], other.max[a]) - max(fill.min[a], other.min[a]) > TOUCH for a in range(3) if a != axis
    )


def _amount(case, fill):
    """Doubts about a fill that is no whole number of particles across: these are not the water asked for."""
    edges, rows = {}, []
    for axis in case.axes:
        low, high = fill.min[axis], fill.max[axis]
        edges["xyz"[axis]], count = high - low, max(1, round((high - low) / case.spacing))
        if axis == 0 and case.gate:
            least, most = case.gate.min_x, case.gate.max_x
            edges["x"] -= max(0.0, min(high, most) - max(low, least))
            first, last = (count * (place - low) / (high - low) - 0.5 for place in (least, most))  # among the rows
            count -= max(0, math.floor(min(last, count - 1)) - math.ceil(max(first, 0.0)) + 1)
        rows.append(count)
    asked, placed = math.prod(edges.values()), math.prod(rows) * case.spacing ** len(case.axes)
    if asked > 0.0 and abs(placed / asked - 1.0) > _MISSED:
        parts = zip(edges.items(), rows, strict=True)
        off = [f"{name} = {edge:.6g}" for (name, edge), count in parts if abs(edge / case.spacing - count) > 1e-6]
        yield (
            f": {asked:.4g} m3 of water asked for, {placed:.4g} m3 placed ({placed / asked - 1.0:+.1%}): spacing = "
            f"{case.spacing!r} does not divide its {', '.join(off)} m{' without the gate' if case.gate else ''}"
        )
