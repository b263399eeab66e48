"""The table of a case about a channel whose sides repeat, and what may be wrong with it."""

import math

from pydantic import Field

from parsim.case.course import Course, largest, wrong_course
from parsim.case.types import Positive, Table

_DEPTHS = 5.0  # that the water travels while the controller answers


class Channel(Table):
    """A channel that repeats along x, driven such that a discharge flows through it."""

    discharge: Course = Field(
        description='discharge of the water, m3/s (2D: m2/s): a number, rows of [time, s, value] or {file = "q.csv"}'
    )
    relaxation: Positive | None = Field(
        None, description="time in which the discharge is brought to what it should be, s; left out: that of 5 depths"
    )


def completed(case):
    """The channel of a case with its time of relaxation, None without one."""
    channel = case.channel
    if channel is None or channel.relaxation is not None:
        return channel
    area, most = _area(case), largest(channel.discharge)
    if not (area > 0.0 and most > 0.0):
        return channel
    return channel.model_copy(update={"relaxation": _DEPTHS * case.depth * area / most})


def faults(case):
    """What is wrong with the channel of a completed case: messages."""
    channel = case.channel
    if channel is None:
        return []
    if not case.water.scheme.WET or not case.water.fill:
        return ["channel.discharge: there is no water, water.fill, to flow"]
    sides = case.box.faces.x_min.kind, case.box.faces.x_max.kind
    if sides != ("periodic", "periodic"):
        told = " and ".join(f'"{side}"' for side in sides)
        return [f"channel.discharge: box.faces.x_min and x_max = {told}: must be periodic, for the water to come back"]
    out = wrong_course("channel.discharge", channel.discharge)
    most = largest(channel.discharge)
    if channel.relaxation is None:
        out.append("channel.discharge = 0.0: there is nothing to hold; leave the channel out, or give its relaxation")
    mean = most / _area(case)
    if mean > case.speed:
        out.append(
            f"channel.discharge: {most:g} m3/s through {_area(case):.4g} m2 of water is {mean:.4g} m/s, more than the "
            f"largest expected speed, {case.speed:.4g} m/s; give water.speed"
        )
    return out


def _area(case):
    """Mean area of the water across the channel at the start, m2 (2D: m), bodies not taken off."""
    volume = 0.0
    for fill in case.water.fill:
        edges = [high - low for low, high in zip(fill.min, fill.max, strict=True)]
        volume += math.prod(edges[axis] for axis in case.axes)
    return volume / case.box.size[0]
