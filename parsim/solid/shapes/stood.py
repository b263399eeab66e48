"""What stands upright on an outline, cylinders and prisms: what follows from their height, for all of them."""

import math

from parsim.machine.compiled import compiled


@compiled
def distance(flat, z, half):
    """See `kernels.distance`: from that in the plane of the outline, `flat`, the height `z` and half the height, m."""
    level, nx, ny = flat
    high, side = abs(z) - half, 1.0 if z > 0.0 else -1.0
    if level <= 0.0 and high <= 0.0:
        if level >= high:
            return level, (nx, ny, 0.0)
        return high, (0.0, 0.0, side)
    level, high = max(level, 0.0), max(high, 0.0)
    length = math.sqrt(level * level + high * high)
    return length, (nx * level / length, ny * level / length, side * high / length)


@compiled
def ahead(crossing, z, dz, half, behind):
    """See `kernels.ahead`: from where the line enters and leaves the outline."""
    enter, leave = max(crossing[0], -behind), crossing[1]
    if abs(dz) < 1e-12:
        if abs(z) > half:
            return math.inf
    else:
        one, two = (-half - z) / dz, (half - z) / dz
        enter, leave = max(enter, min(one, two)), min(leave, max(one, two))
    return enter if enter <= leave else math.inf


@compiled
def depth(flat, z, dz, half, ramp, lateral):
    """See `kernels.depth`: from that of the sides alone, `flat`."""
    deep, weight = flat
    side = 1.0 if dz > 0.0 else -1.0
    if abs(dz) < lateral:
        weight = min(weight, 1.0 + (half - abs(z)) / ramp)
    else:
        if half + side * z < 0.0:
            return 0.0, 0.0
        deep = min(deep, (half - side * z) / abs(dz))
    return deep, max(weight, 0.0)
