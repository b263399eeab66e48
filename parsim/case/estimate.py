"""What a case will cost, from its lattice alone: particles, memory, steps, time, disk. Nothing is built for it."""

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np

from parsim.case import places
from parsim.case.ice_faults import floes_of
from parsim.geometry.faces import walled_sides
from parsim.particles.state import water_bytes

RATE = 500_000  # active particle-steps per second and core; `parsim bench` tells that of this machine
LIST_ROOM = 1.2  # bytes of the neighbour rows over those of the full lattice
_SHAPES = 200  # shapes of bodies that are looked at, at most
_CROWDED = 0.5  # concentration of ice whose discharge is given
_PROBES = 12  # per edge of a body, to see how much of it is in the water
RANK_BYTES = 300e6  # Python, Numba and its machine code
_FRAME_BYTES, _BODY_BYTES = 90, 2000  # in a frame: of a particle, of a body
_ROW_BYTES, _BODY_ROW_BYTES, _SENSOR_ROW_BYTES = 600, 900, 110  # of all series, of each body in them, of a sensor's row


@dataclass(frozen=True)
class Estimate:
    """Particles by kind, the active ones, bytes of these with their lists, steps of the run and the time of one, s."""

    water: int
    wall: int
    body: int
    gate: int
    active: int
    bytes: float
    steps: int
    time_step: float


def estimate(case):
    """The cost of a case. Active are water, bodies, and walls and gate up to the highest level of the fill."""
    if not case.water.scheme.WET:
        dt = time_step(case)
        return Estimate(0, 0, 0, 0, 0, 0.0, math.ceil((case.run.until - case.start) / dt), dt)
    layers = case.layers
    wet = min(1.0, (case.depth / case.spacing + layers) / (case.box.size[2] / case.spacing))
    water, gate = round(_water(case)), _gate(case, layers)
    bodies = _there(case)
    alike = Counter(body.shape for body in bodies)
    sampling = case.spacing, layers * case.spacing, case.dimensions == 2
    some = list(alike.items())[:: math.ceil(len(alike) / _SHAPES) or 1]  # the others are taken to be like them
    body = sum(number * shape.number_of_samples(*sampling) for shape, number in some)
    body = round(body * len(bodies) / max(sum(number for _, number in some), 1))
    active = water + body + round(gate * wet) + _walls(case, layers, wet)
    dt = time_step(case)
    return Estimate(
        water=water,
        wall=_walls(case, layers),
        body=body,
        gate=gate,
        active=active,
        bytes=active * (field_bytes(case) + 4 * LIST_ROOM * _neighbours(case)),
        steps=math.ceil((case.run.until - case.start) / dt),
        time_step=dt,
    )


def _there(case):
    """The bodies, and of those that come in as many of each supply as its concentration has on the box at once."""
    bodies, plan = [body for body in case.bodies if not body.enters], math.prod(case.box.size[:2])
    for supply in case.ice.supplies:
        floes = floes_of(case, supply)
        area = sum(body.shape.volume / (2.0 * body.shape.half[2]) for body in floes)
        share = min((supply.concentration or _CROWDED) * plan / area, 1.0) if floes else 0.0
        bodies += floes[: math.ceil(share * len(floes))]
    return bodies


def field_bytes(case):
    """Bytes of the fields of a particle, twice: sorting writes into new arrays."""
    return 2 * sum(np.dtype(field.dtype).itemsize for field in case.water.scheme.fields)


def time_step(case):
    """Time step at the largest expected speed, s."""
    return case.water.scheme.scheme(case).time_step(case.speed)


def disk(case, water):
    """Bytes on the disk that frames, series and checkpoints of a case of so many water particles will take, about."""
    bodies, time = len(case.bodies), case.run.until - case.start
    frames = math.ceil(time / case.output.frames + 2.0) * (_FRAME_BYTES * water + _BODY_BYTES * bodies)
    rows = sum(sensor.rows(case) for sensor in case.output.sensors)
    series = time / case.output.series * (_ROW_BYTES + _BODY_ROW_BYTES * bodies + _SENSOR_ROW_BYTES * rows)
    milestones = math.ceil(time / case.output.milestones) if case.output.milestones else 0
    checkpoint = water_bytes(case.water.scheme.fields) * water
    return frames, series, checkpoint * (3.0 + milestones)  # one is written before one is removed


def lines(case, ranks):
    """The estimate in words, for `ranks` ranks of one core each."""
    cost = estimate(case)
    parts = disk(case, cost.water)
    each, all_of_them = (f"on each of {ranks} ranks", f"on {ranks} ranks") if ranks > 1 else ("on one rank",) * 2
    return [
        f"particles  about {cost.water:,} water, {cost.wall:,} wall, {cost.body:,} body, {cost.gate:,} gate; "
        f"{cost.active:,} active",
        f"steps      {cost.steps:,} of {cost.time_step:.3g} s, from {case.start:g} to {case.run.until:g} s",
        f"memory     {_memory(cost, ranks)} {each}",
        f"time       {_duration(cost, ranks)} {all_of_them}, if a core makes {RATE:,} active particle-steps per second",
        "disk       {}: {} of frames, {} of series, {} of checkpoints".format(*map(_size, (sum(parts), *parts))),
    ]


def brief(case, ranks):
    """The estimate for one of `ranks` ranks, on one line."""
    cost = estimate(case)
    return (
        f"{cost.active:,} active particles, {cost.steps:,} steps, {_memory(cost, ranks)}, "
        f"{_duration(cost, ranks)}, {_size(sum(disk(case, cost.water)))} on the disk"
    )


def _memory(cost, ranks):
    return f"{(cost.bytes / ranks + RANK_BYTES) / 1e9:.1f} GB"


def _duration(cost, ranks):
    seconds = cost.active * cost.steps / (RATE * ranks)
    if seconds >= 3600:
        return f"{seconds / 3600:.1f} hours"
    if seconds >= 100:
        return f"{round(seconds / 60)} minutes"
    return f"{math.ceil(seconds)} seconds" if seconds > 1 else "1 second"


def _size(count):
    """A number of bytes in words."""
    unit, word = next((unit, word) for unit, word in ((1e9, "GB"), (1e6, "MB"), (0.0, "kB")) if count >= unit)
    return f"{count / (unit or 1e3):.1f} {word}"


def _count(case, lengths):
    """Lattice points in a box with edges `lengths` (3,), m."""
    return math.prod(max(0, round(lengths[axis] / case.spacing)) for axis in case.axes)


def _water(case):
    """Lattice points of all fills less the volume of the bodies and the gate in them."""
    fills = case.water.fill
    points = sum(_count(case, np.subtract(fill.max, fill.min)) - _count(case, _in_gate(case, fill)) for fill in fills)
    return points - sum(_immersed(case, body) for body in case.bodies if not body.enters)


def _in_gate(case, fill):
    """Edge lengths (3,) of the part of a fill that the gate takes, m."""
    lengths = np.subtract(fill.max, fill.min)
    inside = min(fill.max[0], case.gate.max_x) - max(fill.min[0], case.gate.min_x) if case.gate else 0.0
    return [max(0.0, inside), *lengths[1:]]


def _immersed(case, body):
    """Volume of a body in the water at the start, in lattice points."""
    rows = [((np.arange(_PROBES) + 0.5) / _PROBES * 2.0 - 1.0) * half for half in body.shape.half]
    box = places.of_body(body)
    points = np.stack(np.meshgrid(*rows, indexing="ij"), axis=-1).reshape(-1, 3) @ box.axes.T + box.centre
    points = points[places.clearance(box, points) == 0.0]
    wet = np.zeros(len(points), dtype=bool)
    for fill in case.water.fill:
        wet |= np.all((points >= fill.min) & (points <= fill.max), axis=1)
    return wet.mean() * body.shape.volume / case.spacing ** len(case.axes)


def _walls(case, layers, height=1.0):
    """Wall particles outside the faces that are walls, up to a share `height` of the box."""
    inner, outer, sides = 1, 1, [axis for axis, _, _ in walled_sides(case)]
    for axis in case.axes:
        count = round(case.box.size[axis] / case.spacing * (height if axis == 2 else 1.0))
        inner, outer = inner * count, outer * (count + layers * sides.count(axis))
    return outer - inner


def _gate(case, layers):
    """Particles that the closed gate shows: a support deep to each side, into floor and side walls."""
    if case.gate is None:
        return 0
    across = round(case.box.size[1] / case.spacing) + 2 * layers if case.dimensions == 3 else 1
    return 2 * layers * across * (math.ceil((case.box.max[2] - case.gate.bottom) / case.spacing) + layers)


def _neighbours(case):
    """Mean length of a neighbour list inside the water."""
    reach = case.reach / case.spacing
    return math.pi * reach**2 if case.dimensions == 2 else 4 / 3 * math.pi * reach**3
