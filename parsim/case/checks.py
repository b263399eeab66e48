"""Checks of a case beyond the types of its keys, and the completion of what depends on several keys."""

import math
from fractions import Fraction

import numpy as np

from parsim.case import bed, bodies, channel, contacts, friction, ice, measure, motion, openings, places, repeats
from parsim.case import fill as fills
from parsim.errors import InputError
from parsim.fluid import DRY


def checked(case, messages):
    """`case` completed. Raises InputError with `messages` and everything else that is wrong."""
    case, of_bed = case.with_bed()
    case, faults = _completed(case)
    faults += of_bed
    if case.spacing is None:
        missing = "spacing: missing; particle spacing l0, m; required where there is water"
        raise InputError([*messages, *faults, missing])
    of_bodies = (
        bodies.names,
        contacts.faults,
        bodies.bodies,
        bodies.speeds,
        bodies.overlaps,
        bodies.joints,
        bed.faults,
        bodies.gate,
        bodies.sensors,
    )
    of_water = _water, _scheme, fills.faults, friction.faults, channel.faults, openings.faults, _speed
    for check in (_spacing, _box, _faces, *of_water, _ramp, motion.faults, measure.faults, *of_bodies):
        faults += check(case)
    if messages or faults:
        raise InputError([*messages, *faults])
    return case


def doubts(case):
    """What is allowed but doubtful: a list of messages, one for all bodies of one kind."""
    drawn = *case.ice.fields, *case.ice.supplies  # of which `ice.doubts` tells
    thin, floes = {}, {body.name for given in drawn for body in ice.floes_of(case, given)}
    for body in case.bodies if case.water.scheme.WET else ():
        if body.name not in floes and (across := bodies.particles_across(case, body)) < 4:
            thin.setdefault((across, bodies.thinnest(case, body)), []).append(body.name)
    told = [
        f"bodies.{names[0]}{f' and {len(names) - 1} more' if names[1:] else ''}: {across} particles across the "
        f"thinnest side, {side!r} m; four or more give usable loads"
        for (across, side), names in thin.items()
    ]
    return (
        told
        + [
            f"output.sensors.{name}: stands at or between bodies, walls or gate that leave no gap of a spacing, "
            f"{case.spacing!r} m; until they move it reads the water under them"
            for name in bodies.blocked_gauges(case)
        ]
        + [
            f"bodies.{name}: leaves a passage of {gap:.3g} m, {gap / case.spacing:.2g} spacings, to {other}; "
            f"water passes as it should through {bodies.PASSAGE:g} spacings or more"
            for name, other, gap in bodies.narrow_passages(case)
        ]
        + [f"output.sensors.{sensor.name}.{text}" for sensor in case.output.sensors for text in sensor.doubts(case)]
        + [*ice.doubts(case)]
        + case.water.scheme.doubts()
        + [*case.contacts.law.doubts(case.dimensions == 2), *contacts.doubts(case)]
        + fills.doubts(case)
        + [*friction.doubts(case), *bed.doubts(case), *openings.doubts(case)]
    )


def _completed(case):
    """(`case` with the values filled in that depend on other keys, messages)."""
    if case.gate and case.gate.bottom is None:
        case = case.model_copy(update={"gate": case.gate.model_copy(update={"bottom": case.box.min[2]})})
    floated, faults = _all_floated(case, repeats.every(case))
    case, wrong = ice.with_floes(case.model_copy(update={"bodies": floated}))
    floes, unfloated = _all_floated(case, case.bodies[len(floated) :])
    faults += [*wrong, *unfloated]
    middle = (case.box.min[1] + case.box.max[1]) / 2
    sensors = tuple(
        s.model_copy(update={"y": middle}) if hasattr(s, "y") and (s.y is None or case.dimensions == 2) else s
        for s in case.output.sensors
    )
    output = case.output.model_copy(update={"sensors": sensors})
    update = {"bodies": (*floated, *floes), "channel": channel.completed(case), "output": output}
    if not case.water.fill and not {"scheme", "speed"} & case.water.model_fields_set:
        update["water"] = case.water.model_copy(update={"scheme": DRY})
    if case.spacing is None and not update.get("water", case.water).scheme.WET:
        update["spacing"] = 0.5 * min((bodies.thinnest(case, body) for body in case.bodies), default=max(case.box.size))
    if case.wall_material is None:
        update["wall_material"] = next(iter(case.materials), None)
    return case.model_copy(update=update), faults


def _all_floated(case, given):
    """(`given` bodies, those that float at their heights, messages)."""
    floated, faults = [], []
    for body in given:
        try:
            shape = body.shape.completed()
        except InputError as error:
            faults += [f"bodies.{body.name}.shape: {text}" for text in error.messages]
            continue
        body = body if shape is body.shape else body.model_copy(update={"shape": shape})
        try:
            floated.append(_floated(case, body) if body.position[2] == "float" else body)
        except ValueError as error:
            floated.append(body)
            faults.append(f'bodies.{body.name}.position = "float" as z: {error}')
    return tuple(floated), faults


def _floated(case, body):
    """`body` at the height where it floats level, by Archimedes."""
    x, y, _ = body.position
    water = fills.water_at(case.water.fill, x, y)
    if water is None:
        raise ValueError(f"no fill under its centre x = {x!r}, y = {y!r}")
    if (body.density is None) == (body.mass is None):
        raise ValueError("needs its density or its mass")
    (bottom, level), density = water, case.density_of(body)
    if density >= case.water.density:
        raise ValueError(f"density {density:.6g} kg/m3 does not float; must be below that of the water")
    place = places.of_body(body.model_copy(update={"position": (x, y, 0.0)}))
    height = body.shape.afloat(density / case.water.density, place.axes[2])
    draught = place.along(np.array([0.0, 0.0, -1.0])) - height
    if draught > level - bottom:
        text = f"draught {draught:.6g} m is more than the depth of water there, {level - bottom:.6g} m"
        raise ValueError(text + body.shape.hint(case.box.size))
    return body.model_copy(update={"position": (x, y, float(level + height))})


def _spacing(case):
    """The spacing divides every edge of the box along which things move, where there are particles."""
    if not case.water.scheme.WET:
        return []
    edges = {"xyz"[axis]: case.box.size[axis] for axis in case.axes if case.box.size[axis] > 0}
    wrong = [name for name, edge in edges.items() if not _divides(case.spacing, edge)]
    if not wrong:
        return []
    listed = ", ".join(f"{name} = {edges[name]:.10g}" for name in wrong)
    return [f"spacing = {case.spacing!r}: does not divide box {listed} m; {_nearest_spacings(case)}"]


def _water(case):
    """A scheme without water has none to move."""
    if case.water.fill and not case.water.scheme.WET:
        return ['water.scheme.kind = "none": there is water, water.fill; leave the scheme out, or the fill']
    return []


def _scheme(case):
    """What the scheme of the water does not know."""
    return case.water.scheme.faults(case)


def _divides(spacing, edge):
    count = edge / spacing
    return count > 0.5 and abs(count - round(count)) <= 1e-6 * count


def _nearest_spacings(case):
    """The nearest spacings that divide every edge, in words."""
    low, high = case.box.min, case.box.max
    edges = [Fraction(repr(high[axis])) - Fraction(repr(low[axis])) for axis in case.axes]
    common = Fraction(math.gcd(*(_over(edge, edges) for edge in edges)), _denominator(edges))
    count = common / Fraction(repr(case.spacing))
    if count < Fraction(1, 10):
        return "the edges of the box have no usable common measure: change an edge"
    counts = sorted({max(1, math.ceil(count)), max(1, math.floor(count))}, reverse=True)
    return "nearest spacings that do: " + ", ".join(repr(float(common / k)) for k in counts)


def _denominator(edges):
    return math.lcm(*(edge.denominator for edge in edges))


def _over(edge, edges):
    return abs(int(edge * _denominator(edges)))


def _box(case):
    low, high = case.box.min, case.box.max
    faults = [
        f"box.max = {list(high)}: {name} must be greater than that of box.min = {list(low)}"
        for axis, name in enumerate("xyz")
        if not low[axis] < high[axis]
    ]
    if case.dimensions == 2 and (low[1], high[1]) != (0.0, 1.0):
        faults.append(f"box.min, box.max: y = {low[1]!r} to {high[1]!r}: must be 0 to 1 in a 2D case")
    return faults


def _faces(case):
    faces, faults = case.box.faces, []
    for name in "xyz":
        low, high = getattr(faces, f"{name}_min"), getattr(faces, f"{name}_max")
        if low.repeats != high.repeats:
            faults.append(
                f'box.faces.{name}_min = "{low.kind}", box.faces.{name}_max = "{high.kind}": both or none must be '
                '"periodic"'
            )
    given = faces.y_min.kind, faces.y_max.kind
    if case.dimensions == 2 and given != ("wall", "wall"):
        faults.append(f'box.faces.y_min, y_max = "{given[0]}", "{given[1]}": a 2D case has none; leave them out')
    return faults


def _ramp(case):
    if case.gravity_ramp > 0.0 and case.water.fill:
        return [f"gravity_ramp = {case.gravity_ramp!r}: water has its weight from the start; see run.settle"]
    return []


def _speed(case):
    if case.water.speed is None and case.sound_speed <= 0:
        lacking = "gravity" if case.water.fill else "fill"
        return [f"water.speed: missing; the largest expected speed, m/s, is required in a case without {lacking}"]
    return []
