"""Springs from bodies to points and lines of the world: moorings, booms. Rows of `springs`: see `ties.Joints`."""

import math

from parsim.geometry.rotation import to_global
from parsim.machine.jit import kernel
from parsim.solid.motion import answer
from parsim.solid.table import LOAD, LOSS, POSITION, PULL, SPIN, VELOCITY, three, turn_at

BODY, AT, FROM, TO, STIFFNESS, DAMPING, LENGTH, SLACK = 0, 1, 4, 7, 10, 11, 12, 13


@kernel
def _stretched(m, springs, k):
    """(arm (3,) from the centre, m, unit vector (3,) away from where it is fixed, by how much it is longer, m).

    A spring without length has no direction and does not pull.
    """
    b = int(springs[k, BODY])
    x, y, z = to_global(turn_at(m, b), springs[k, AT], springs[k, AT + 1], springs[k, AT + 2])
    px, py, pz = m[b, POSITION] + x, m[b, POSITION + 1] + y, m[b, POSITION + 2] + z
    ax, ay, az = three(springs, k, FROM)
    lx, ly, lz = springs[k, TO] - ax, springs[k, TO + 1] - ay, springs[k, TO + 2] - az
    square, share = lx * lx + ly * ly + lz * lz, 0.0
    if square > 0.0:
        share = min(max(((px - ax) * lx + (py - ay) * ly + (pz - az) * lz) / square, 0.0), 1.0)
    dx, dy, dz = px - ax - share * lx, py - ay - share * ly, pz - az - share * lz
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    more = length - springs[k, LENGTH]
    if length == 0.0 or (springs[k, SLACK] > 0.0 and more <= 0.0):
        return (x, y, z), (0.0, 0.0, 0.0), 0.0
    return (x, y, z), (dx / length, dy / length, dz / length), more


@kernel
def pull_springs(m, springs):
    """Add the loads of all springs to those of their bodies."""
    for k in range(len(springs)):
        b, ((x, y, z), e, more) = int(springs[k, BODY]), _stretched(m, springs, k)
        (p, q, r), v = three(m, b, SPIN), three(m, b, VELOCITY)
        away = (v[0] + q * z - r * y) * e[0] + (v[1] + r * x - p * z) * e[1] + (v[2] + p * y - q * x) * e[2]
        force, drag = -springs[k, STIFFNESS] * more, -springs[k, DAMPING] * away
        if springs[k, SLACK] > 0.0:
            drag = min(drag, -force)  # a rope does not push
        arm = (y * e[2] - z * e[1], z * e[0] - x * e[2], x * e[1] - y * e[0])
        for a in range(3):
            m[b, LOAD + a] += (force + drag) * e[a]
            m[b, PULL + a] += (force + drag) * e[a]
            m[b, LOSS + a] += drag * e[a]
            m[b, LOAD + 3 + a] += (force + drag) * arm[a]
            m[b, PULL + 3 + a] += (force + drag) * arm[a]
            m[b, LOSS + 3 + a] += drag * arm[a]


@kernel
def held_by_springs(m, springs):
    """Energy that all springs hold, J."""
    energy = 0.0
    for k in range(len(springs)):
        more = _stretched(m, springs, k)[2]
        energy += 0.5 * springs[k, STIFFNESS] * more * more
    return energy


@kernel
def rate_of_springs(m, springs):
    """Bound of the square of the largest angular frequency of bodies on springs, 1/s2: those of a body add up."""
    largest = 0.0
    for k in range(len(springs)):
        b, total = int(springs[k, BODY]), 0.0
        for j in range(len(springs)):
            if int(springs[j, BODY]) == b:
                (x, y, z), e, _ = _stretched(m, springs, j)
                f = (e[0], e[1], e[2], y * e[2] - z * e[1], z * e[0] - x * e[2], x * e[1] - y * e[0])
                a, w = answer(m, b, f)
                soft = f[0] * a[0] + f[1] * a[1] + f[2] * a[2] + (f[3] * w[0] + f[4] * w[1] + f[5] * w[2])
                total += springs[j, STIFFNESS] * soft
                hasty = springs[j, DAMPING] * soft
                total += hasty * hasty
        largest = max(largest, total)
    return largest
