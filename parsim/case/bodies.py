"""Checks of a case's bodies, gate and sensors. Each takes a completed case and returns messages."""

import math

import numpy as np

from parsim.case import places
from parsim.case.fill import TOUCH, water_at
from parsim.errors import nearest, suggestion
from parsim.geometry.faces import names_of_walls, period, repeats, walled_sides
from parsim.observe.sensors import Gauge, Levelling, Load

PASSAGE = 3.0  # spacings: through less, water flows too slowly (2D, levels 0.2 m apart)


def thinnest(case, body):
    """Least width of a body, m."""
    return 2.0 * body.shape.thinnest(case.dimensions == 2)


def particles_across(case, body):
    """Number of particles across the thinnest side of a body."""
    return round(thinnest(case, body) / case.spacing)


def placed(case):
    """The bodies that have a place: one that cannot float has none, one that is yet to come in neither."""
    return [body for body in case.bodies if body.position[2] != "float" and not body.enters]


def names(case):
    """Names are unique."""
    faults = []
    for key, entries in (("bodies", case.bodies), ("output.sensors", case.output.sensors)):
        given = [entry.name for entry in entries]
        doubled = sorted({name for name in given if given.count(name) > 1}) if len(set(given)) < len(given) else []
        faults += [f'{key}: name = "{name}" is given more than once; names must differ' for name in doubled]
    return faults


def bodies(case):
    """Each body by itself: mass, size, place, and in 2D what a plane allows."""
    return [f"bodies.{body.name}.{text}" for body in case.bodies for text in _body(case, body)]


def _body(case, body):
    if (body.density is None) == (body.mass is None):
        given = "none is" if body.mass is None else f"density = {body.density!r} and mass = {body.mass!r} are"
        yield f"density, mass: exactly one must be given, {given}"
    if case.water.scheme.WET and particles_across(case, body) < 2:
        yield (
            f"{body.shape.told()}: thinner than two particles at spacing = {case.spacing!r}; "
            f"its thinnest side {thinnest(case, body)!r} m must be at least 1.5 spacings"
        )
    if body.fixed and any((*body.velocity, *body.spin)):
        yield f"fixed = true: velocity = {list(body.velocity)} and spin = {list(body.spin)} must then be zero"
    if body.released is not None and any((*body.velocity, *body.spin)):
        yield (
            f"released = {body.released!r}: velocity = {list(body.velocity)} and spin = {list(body.spin)} must then be "
            "zero; it begins at rest"
        )
    yield from body.shape.faults(case.dimensions == 2)
    if case.dimensions == 2:
        yield from _planar(body)
    if body.position[2] != "float" and not body.enters:
        yield from _outside(case, body)


def _planar(body):
    if body.position[1] != 0.5:
        yield f"position = {list(body.position)}: y must be 0.5 in a 2D case"
    if body.velocity[1]:
        yield f"velocity = {list(body.velocity)}: y must be 0 in a 2D case"
    for key, value in (("angles", body.angles), ("spin", body.spin)):
        if value[0] or value[2]:
            yield f"{key} = {list(value)}: x and z must be 0 in a 2D case; bodies turn about y only"


def _outside(case, body):
    place = places.of_body(body)
    low, high, around = place.low(), place.high(), repeats(case)
    for axis in case.axes:
        name, least, most = "xyz"[axis], case.box.min[axis], case.box.max[axis]
        near = 0.5 * case.spacing if case.water.scheme.WET else 0.0
        if around[axis] and near and (low[axis] < least + near - TOUCH or high[axis] > most - near + TOUCH):
            yield (
                f"position = {list(body.position)}: reaches the periodic side; it may cross it later, but must begin "
                f"half a spacing off it: it reaches from {name} = {low[axis]:.6g} to {high[axis]:.6g}"
            )
            continue
        if around[axis] and high[axis] - low[axis] > most - least + TOUCH:
            yield (
                f"{body.shape.told()}: reaches over {high[axis] - low[axis]:.6g} m along {name}, where the box repeats "
                f"after {most - least:.6g} m; must be less"
            )
            continue
        if around[axis]:
            low[axis] = high[axis] = body.position[axis]
        if low[axis] < least - TOUCH or high[axis] > most + TOUCH:
            yield (
                f"position = {list(body.position)}: outside the box, reaches from {name} = {low[axis]:.6g} to "
                f"{high[axis]:.6g}; allowed {least!r} to {most!r}{body.shape.hint(case.box.size)}"
            )


def speeds(case):
    """Nothing solid starts or is driven as fast as the sound of the model."""
    if case.sound_speed <= 0.0:
        return []
    found = [(f"bodies.{body.name}.velocity, spin", _fastest(case, body)) for body in case.bodies]
    if case.gate:
        found.append(("gate.speed", case.gate.speed))
    known = {body.name: body for body in case.bodies if body.position[2] != "float"}
    for i, joint in enumerate(case.joints):
        if joint.DRIVES and (body := known.get(joint.body)):
            radius = body.shape.radius(case.dimensions == 2)
            found.append((f"joints.{i}", joint.fastest(np.array(body.position, float), radius)))
    return [
        f"{key}: {speed:.6g} m/s; must be less than the speed of sound of the model, {case.sound_speed:.6g} m/s, "
        "which is water.scheme.sound times water.speed"
        for key, speed in found
        if not speed < case.sound_speed
    ]


def _fastest(case, body):
    """Bound of the speed of any point of a body at the start, m/s."""
    radius = body.shape.radius(case.dimensions == 2)
    return math.hypot(*body.velocity) + math.hypot(*body.spin) * radius


def overlaps(case):
    """No body is inside another or inside the gate; fixed ones may be in each other, as piers in a bed."""
    present = placed(case)
    boxes = [places.of_body(body) for body in present]
    faults = []
    for i, j, shift in places.near_pairs(boxes, period(case)):
        if (present[i].fixed and present[j].fixed) or places.apart(boxes[i], boxes[j], shift):
            continue
        depth = places.overlap(boxes[i], boxes[j], shift)
        if depth > TOUCH:
            faults.append(f"bodies.{present[j].name}: overlaps bodies.{present[i].name} by {depth:.3g} m")
    for body, box in zip(present, boxes, strict=True) if case.gate else ():
        depth = places.overlap(box, gate_box(case))
        if depth > TOUCH:
            faults.append(
                f"bodies.{body.name}: is in the gate, x = {case.gate.min_x!r} to {case.gate.max_x!r}, by {depth:.3g} m"
            )
    return faults


def joints(case):
    """Every joint ties a body that there is, and what is tied to two of them can follow both."""
    known, taken, faults = {body.name: body for body in case.bodies if not body.enters}, {}, []
    for i, joint in enumerate(case.joints):
        key = f"joints.{i}"
        if joint.body not in known:
            allowed = ", ".join(list(known)[:8]) or "none, there are no bodies"
            faults.append(
                f'{key}.body = "{joint.body}": no such body; allowed: {allowed}'
                f"{', ...' if len(known) > 8 else ''}{suggestion(nearest(joint.body, known))}"
            )
            continue
        faults += [f"{key}.{text}" for text in joint.faults(known[joint.body], case.dimensions == 2)]
        if joint.kind != "spring":
            faults += [f"{key}: {text}" for text in _clashes(joint, taken.setdefault(joint.body, []))]
            taken[joint.body].append(joint)
    return faults


def _clashes(joint, others):
    """Why a body cannot follow this joint besides `others`: messages."""
    for other in others:
        kinds = {joint.kind, other.kind}
        turns = all(name.startswith("turn") for one in (joint, other) for name in getattr(one, "locked", ()))
        if kinds != {"lock"} and not (kinds == {"lock", "pendulum"} and turns):
            yield f'bodies.{joint.body} has a joint of kind "{other.kind}" already; a pendulum may lock turns besides'


def gate_box(case):
    """Where the gate is at the start; it reaches above the box."""
    gate, low, high = case.gate, case.box.min, case.box.max
    bottom = gate.bottom + gate.speed * max(0.0, case.start - gate.opens)
    return places.upright((gate.min_x, low[1], bottom), (gate.max_x, high[1], max(high[2], bottom) + 1.0))


def gate(case):
    """The gate is a plate within the tank, between walls."""
    if case.gate is None:
        return []
    plate, low, high, faults = case.gate, case.box.min, case.box.max, []
    if not plate.min_x < plate.max_x:
        faults.append(f"gate.max_x = {plate.max_x!r}: must be greater than gate.min_x = {plate.min_x!r}")
    for key, value, axis in (("min_x", plate.min_x, 0), ("max_x", plate.max_x, 0), ("bottom", plate.bottom, 2)):
        if not low[axis] <= value <= high[axis]:
            faults.append(f"gate.{key} = {value!r}: outside the tank; must be {low[axis]!r} to {high[axis]!r}")
    needed = ("x_min", "x_max", "z_min") + (("y_min", "y_max") if case.dimensions == 3 else ())
    wrong = [f'{face} = "{kind}"' for face in needed if (kind := getattr(case.box.faces, face).kind) != "wall"]
    if wrong:
        faults.append(f'gate: needs walls around it, but box.faces has {", ".join(wrong)}; must be "wall"')
    return faults


def sensors(case):
    """Sensors stand in the box, on walls and bodies that exist."""
    names, out = [body.name for body in placed(case)], []
    for sensor in case.output.sensors:
        key = f"output.sensors.{sensor.name}"
        out += [
            f"{key}.{axis} = {value!r}: outside the box; must be {case.box.min[k]!r} to {case.box.max[k]!r}"
            for k, axis in enumerate("xyz")
            if (value := getattr(sensor, axis, None)) is not None and not case.box.min[k] <= value <= case.box.max[k]
        ]
        out += [f"{key}.{text}" for text in sensor.faults(case)] if isinstance(sensor, Levelling) else []
        wall, body = getattr(sensor, "wall", None), getattr(sensor, "body", None)
        if wall is not None and wall not in names_of_walls(case):
            out.append(f'{key}.wall = "{wall}": is no wall of this case')
        elif wall is not None:
            out += [f"{key}.{fault}" for fault in _patch(case, sensor)]
        if body is not None and body not in names:
            hint = suggestion(nearest(body, names))
            out.append(f'{key}.body = "{body}": no such body; allowed: {", ".join(names[:9]) or "none"}{hint}')
        if isinstance(sensor, Load) and body is None and not any(one.fixed for one in case.bodies):
            out.append(f"{key}: there is no fixed body whose loads it could tell; name one as its body")
    return out


def _patch(case, sensor):
    """What is wrong with the corners of a part of a wall, along the axes in which walls reach."""
    for axis in case.axes:
        low, high = (getattr(sensor, end) and getattr(sensor, end)[axis] for end in ("min", "max"))
        if axis == "xyz".index(sensor.wall[0]):
            continue
        low, high = case.box.min[axis] if low is None else low, case.box.max[axis] if high is None else high
        if not max(low, case.box.min[axis]) < min(high, case.box.max[axis]):
            yield f"min, max: from {'xyz'[axis]} = {low!r} to {high!r} there is nothing of the wall"


def narrow_passages(case):
    """(name, what is beside it, gap, m) of the passages of less than PASSAGE spacings beside bodies that are fixed."""
    fixed, widest = [body for body in placed(case) if body.fixed], PASSAGE * case.spacing
    boxes = [places.of_body(body) for body in fixed]
    grown = [box.grown(0.5 * widest) for box in boxes]
    gaps = [
        (
            i,
            f"box.faces.{'xyz'[axis]}_{'min' if sign < 0 else 'max'}",
            sign * (level - box.centre[axis]) - box.reach[axis],
        )
        for i, box in enumerate(boxes)
        for axis, sign, level in walled_sides(case)
    ]
    gaps += [
        (i, f"bodies.{fixed[j].name}", -places.overlap(boxes[i], boxes[j], shift))
        for i, j, shift in places.near_pairs(grown, period(case))
    ]
    return [(fixed[i].name, other, gap) for i, other, gap in gaps if TOUCH < gap < widest - TOUCH]


def blocked_gauges(case):
    """Names of the gauges that bodies, walls and gate leave no room to read the water level at the start."""
    solids = [places.of_body(body) for body in placed(case)] + ([gate_box(case)] if case.gate else [])
    return [s.name for s in case.output.sensors if isinstance(s, Gauge) and not _readable(case, s, solids)]


def _readable(case, gauge, solids):
    """Whether a particle at the level could stand within the reach of a gauge, or there is no water at it."""
    water = water_at(case.water.fill, gauge.x, gauge.y)
    if water is None:
        return True
    # particles stand half a spacing from what is solid
    half, steps = 0.5 * case.spacing, case.spacing * np.linspace(-Gauge.REACH, Gauge.REACH, 61)
    x, y = np.meshgrid(gauge.x + steps, gauge.y + steps if case.dimensions == 3 else gauge.y)
    within = (x - gauge.x) ** 2 + (y - gauge.y) ** 2 <= (Gauge.REACH * case.spacing) ** 2
    points = np.stack([x[within], y[within], np.full(within.sum(), water[1])], axis=1)
    free = np.ones(len(points), bool)
    for axis in case.axes[:-1]:
        for side, place, sign in (("min", case.box.min[axis], 1.0), ("max", case.box.max[axis], -1.0)):
            wall = getattr(case.box.faces, f"{'xyz'[axis]}_{side}").holds_water
            free &= sign * (points[:, axis] - place) >= (half if wall else 0.0) - TOUCH
    spot = np.array([gauge.x, gauge.y, water[1]])
    for solid in solids:
        if np.any(np.abs(solid.centre - spot) > solid.reach + 2.0 * Gauge.REACH * case.spacing):
            continue
        free &= places.clearance(solid, points) >= half - TOUCH
    return bool(free.any())
