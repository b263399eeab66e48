"""Checks of fields and supplies of ice of a case, before and after their floes are drawn. Lengths in m."""

import itertools
import math

import numpy as np

from parsim.case.contacts import unknown_material
from parsim.case.fill import TOUCH, water_at
from parsim.errors import InputError
from parsim.ice.field import fits
from parsim.solid.shapes import BoxShape, CylinderShape, PrismShape

_LONGEST = 56  # letters of a field's name: those of its floes have a number besides


def floes_of(case, field):
    """The bodies that are the floes of a field, those that there are."""
    names = {f"{field.name}_{number}" for number in range(1, (field.floes or 0) + 1)}
    return [body for body in case.bodies if body.name in names]


def names(case):
    """Names of fields differ, and leave room for a number."""
    every = *case.ice.fields, *case.ice.supplies
    names = [given.name for given in every]
    faults = [
        f'ice: name = "{name}" is given more than once; names must differ'
        for name in sorted({name for name in names if names.count(name) > 1})
    ]
    return faults + [
        f"{given.KEY}.{given.name}.name: {len(given.name)} letters; at most {_LONGEST}, its floes have a number besides"
        for given in every
        if len(given.name) > _LONGEST
    ]


def read(field, dimensions):
    """(the field with what its files say, messages about its laws)."""
    update, wrong = {}, []
    for key in ("size", "thickness", "aspect"):
        law = getattr(field, key)
        if law is None:
            continue
        try:
            update[key] = law = law.completed()
        except InputError as error:
            wrong += [f"{key}: {text}" for text in error.messages]
            continue
        wrong += [f"{key}.{text}" for text in law.faults(dimensions)]
        if key != "size" and getattr(law, "weight", None) == "area" and "weight" in law.model_fields_set:
            wrong.append(f'{key}.weight = "area": is for size, with which the area goes; must be "number"')
        elif key != "size" and hasattr(law, "weight"):
            update[key] = law.model_copy(update={"weight": "number"})
        if key == "aspect" and not wrong and (least := min(getattr(law, "values", (law.at(0.0),)))) < 1.0:
            wrong.append(f"aspect: reaches down to {least:.6g}; must be at least 1, length over width")
    return field.model_copy(update=update), wrong


def wrong(case, field):
    """What is wrong with a field before anything is drawn: messages that begin with the key."""
    planar, box = case.dimensions == 2, case.box
    if not len(field.min) == len(field.max) == case.dimensions - 1:
        what = "1 entry, x, in a 2D case" if planar else "2 entries, x and y"
        yield f"min = {list(field.min)}, max = {list(field.max)}: must have {what} each"
        return
    if field.floes is not None:
        yield from missing(case, field)
        return
    for axis, (low, high) in enumerate(zip(field.min, field.max, strict=True)):
        if not low < high:
            yield f"max = {list(field.max)}: empty, {'xy'[axis]} must be greater than that of min = {list(field.min)}"
            return
        for key, value in (("min", low), ("max", high)):
            if not box.min[axis] - TOUCH <= value <= box.max[axis] + TOUCH:
                yield (
                    f"{key} = {list(getattr(field, key))}: {'xy'[axis]} is outside the box, {box.min[axis]!r} to "
                    f"{box.max[axis]!r}"
                )
    if planar and field.velocity[1]:
        yield f"velocity = {list(field.velocity)}: y must be 0 in a 2D case"
    if math.hypot(*field.velocity) >= case.sound_speed > 0.0:
        yield (
            f"velocity = {list(field.velocity)}: must be slower than the sound of the model, {case.sound_speed:.6g} "
            "m/s, which is water.scheme.sound times water.speed"
        )
    yield from common(case, field)
    if case.spacing is None or isinstance(water := water_under(case, field), str):
        yield water if case.spacing is not None else "min, max: there is no spacing, and no water to float in"


def missing(case, given):
    """Whether the bodies that a completed field or supply says are its floes are there."""
    if (there := len(floes_of(case, given))) != given.floes:
        yield (
            f"floes = {given.floes}: there are {there} bodies {given.name}_1 to {given.name}_{given.floes}; leave "
            "floes out, it is written when bodies are made of it"
        )


def common(case, given):
    """What is wrong with what fields and supplies have in common."""
    planar = case.dimensions == 2
    if planar and given.shape != "box":
        yield f'shape = "{given.shape}": must be "box" in a 2D case'
    if given.aspect is not None and (planar or given.shape == "disc"):
        yield f"aspect: {'floes of a 2D case' if planar else 'discs'} have none; leave it out"
    if given.material not in case.materials:
        yield f'material = "{given.material}": {unknown_material(given.material, case.materials)}'
    if given.density >= case.water.density:
        yield (
            f"density = {given.density!r}: does not float; must be below that of the water, "
            f"{case.water.density!r} kg/m3"
        )


def water_under(case, field):
    """(bottom, level) of the water under a field, a message where it is not all water at one level."""
    cuts = []
    for axis in range(len(field.min)):
        low, high = field.min[axis], field.max[axis]
        ends = {end for fill in case.water.fill for end in (fill.min[axis], fill.max[axis]) if low < end < high}
        cuts.append(sorted({low, high, *ends}))
    middles = [[0.5 * (a + b) for a, b in itertools.pairwise(ends)] for ends in cuts]
    bottoms, levels = [], []
    for x, y in itertools.product(middles[0], middles[1] if middles[1:] else [0.5]):
        water = water_at(case.water.fill, x, y)
        if water is None:
            return f"min, max: no water beneath at x = {x:.6g}, y = {y:.6g}; the rectangle must be over water.fill"
        bottoms.append(water[0])
        levels.append(water[1])
    if max(levels) - min(levels) > TOUCH:
        return f"min, max: the water beneath is at levels from {min(levels)!r} to {max(levels)!r}; must be at one"
    return max(bottoms), max(levels)


def check_sizes(case, field, floes, region):
    """Refuse floes that are too thin for particles, and those that have no room in an empty rectangle."""
    if (small := field.concentration * rectangle(field)) < 0.5 * floes[0].area:
        raise InputError(
            f"concentration = {field.concentration!r}: asks for {small:.6g} m2, less than half of the first floe, "
            f"{floes[0].area:.6g} m2; make the floes smaller or the rectangle larger"
        )
    check_thickness(case, floes)
    if any(low >= high for low, high in zip(*region, strict=True)):
        raise InputError("min, max: nothing of the rectangle is left between the sides of the box and their gaps")
    large = [floe for floe in floes if not (case.dimensions == 2 or fits(floe, region))]
    large += [floe for floe in floes if case.dimensions == 2 and floe.size > region.high[0] - region.low[0]]
    if large:
        most = max(floe.size for floe in large)
        room = " by ".join(f"{high - low:.6g}" for low, high in zip(*region, strict=True))
        raise InputError(
            f"size: {len(large)} of {len(floes)} floes do not fit into the rectangle, the largest of {most:.6g} m into "
            f"{room} m; limit the sizes or enlarge it"
        )


def check_thickness(case, floes):
    """Refuse floes that are too thin for particles."""
    widths = [2.0 * shape_of(case, floe).thinnest(case.dimensions == 2) for floe in floes]
    thin = [width for width in widths if round(width / case.spacing) < 2]
    if thin and case.water.scheme.WET:
        raise InputError(
            f"size, thickness: {len(thin)} of {len(floes)} floes are thinner than two particles at spacing = "
            f"{case.spacing!r}, the thinnest {min(thin):.6g} m; must be at least 1.5 spacings"
        )


def rectangle(field):
    """Area of the rectangle, m2; in 2D its length, m, by the metre across."""
    return math.prod(high - low for low, high in zip(field.min, field.max, strict=True))


def shape_of(case, floe):
    """The shape of a body that a floe is."""
    if floe.shape == "disc":
        return CylinderShape(kind="cylinder", diameter=floe.size, height=floe.thickness)
    if floe.shape == "box" or case.dimensions == 2:
        edges = np.ptp(floe.outline, axis=0).tolist()
        return BoxShape(size=(*edges, floe.thickness))
    return PrismShape(kind="prism", points=tuple(map(tuple, floe.outline.tolist())), height=floe.thickness)
