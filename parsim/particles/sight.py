"""What a thin plate hides from each other, and the neighbour lists without it."""

import numpy as np

from parsim.machine.jit import kernel
from parsim.particles.state import BODY, FLUID, GATE_DOWN, GATE_UP, WALL


@kernel
def hidden(xa, za, xb, zb, low, high, barrier):
    """Whether the segment a-b meets the plate low <= x <= high at z >= barrier; low = high for its middle plane."""
    if min(xa, xb) > high or max(xa, xb) < low:
        return False
    if barrier == -np.inf:
        return True
    top = -np.inf
    for x in (low, high):
        if min(xa, xb) <= x <= max(xa, xb) and xa != xb:
            top = max(top, za + (zb - za) * (x - xa) / (xb - xa))
    if low <= xa <= high:
        top = max(top, za)
    if low <= xb <= high:
        top = max(top, zb)
    return top >= barrier


@kernel
def sees_gate(xf, zf, xg, zg, kind, low, high, barrier):
    """Whether a particle at f meets the gate sample at g: each side its own samples, from below the inner ones."""
    if kind == GATE_UP:
        if xf >= 0.5 * (low + high):
            return False
        face = low
    else:
        if xf < 0.5 * (low + high):
            return False
        face = high
    if low <= xg <= high:
        return True
    if low < xf < high:
        return False
    return zf + (zg - zf) * (face - xf) / (xg - xf) >= barrier


@kernel
def visible(i, j, other, x, z, low, high, barrier):
    """Whether the gate leaves particles i and j, one of them fluid and `other` the kind of the other, in sight.

    Water and bodies are hidden from each other where the middle plane of the plate lies between them: around its edge
    they are one water, and hiding what is behind the corner would leave holes in the support that look like a free
    surface. Walls are hidden by the whole plate, whose own samples stand there.
    """
    if other == WALL:
        return not hidden(x[i], z[i], x[j], z[j], low, high, barrier)
    if other == GATE_UP or other == GATE_DOWN:
        return sees_gate(x[i], z[i], x[j], z[j], other, low, high, barrier)
    middle = 0.5 * (low + high)
    return not hidden(x[i], z[i], x[j], z[j], middle, middle, barrier)


@kernel
def cut_rows(near, place, kind, plate, lists):
    """Compact the rows `near` in place, keeping only neighbours that the gate leaves in sight.

    Nearly all pairs are settled by lying on one side of the plate: its low and high x, and where it ends below, m.
    """
    x, _, z = place
    low, high, barrier = plate
    start, middle, end, index = lists
    between = 0.5 * (low + high)
    for i in near:
        m = start[i]
        own = kind[i]
        if own == FLUID or own == BODY:
            for t in range(start[i], middle[i]):
                j = index[t]
                index[m] = j
                m += (x[i] - between) * (x[j] - between) > 0.0 or visible(i, j, BODY, x, z, low, high, barrier)
        else:
            for t in range(start[i], middle[i]):
                j = index[t]
                index[m] = j
                m += visible(j, i, own, x, z, low, high, barrier)
        kept = m
        for t in range(middle[i], end[i]):
            j = index[t]
            index[m] = j
            m += visible(i, j, kind[j], x, z, low, high, barrier)
        middle[i] = kept
        end[i] = m
