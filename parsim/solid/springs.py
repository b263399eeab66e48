"""Springs from bodies to points and lines of the world: moorings, booms. Rows of `springs`: see `ties.Joints`."""

import math

from parsim.geometry.rotation import to_global
from parsim.machine.jit import kernel
from parsim.solid.speeds import MARGIN, length, speed_of
from parsim.solid.table import (
    HASTE,
    INVERSE,
    LIGHT,
    LOAD,
    LOSS,
    POSITION,
    PULL,
    RADIUS,
    SPIN,
    SWING,
    VELOCITY,
    three,
    turn_at,
)

BODY, AT, FROM, TO, STIFFNESS, DAMPING, LENGTH, SLACK = 0, 1, 4, 7, 10, 11, 12, 13
_NONE = (0.0, 0.0, 0.0)
_STEEPEST = 100.0  # times its stiffness that a spring pressed to almost nothing acts across
STEPS = 4  # times those of a contact, in half a swing: sub-steps change as contacts come and go, and that makes energy


@kernel
def _stretched(m, springs, k):
    """The same as `_away`, but for what is slack: nowhere, 0."""
    arm, e, more = _away(m, springs, k)
    if springs[k, SLACK] > 0.0 and more <= 0.0:
        return arm, _NONE, 0.0
    return arm, e, more


@kernel
def _away(m, springs, k):
    """(arm (3,) from the centre, m, unit vector (3,) away from where it is fixed, by how much it is longer, m).

    A spring that ends where it begins has no direction and does not pull.
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
    far = length((dx, dy, dz))
    if far == 0.0:
        return (x, y, z), _NONE, -springs[k, LENGTH]
    return (x, y, z), (dx / far, dy / far, dz / far), far - springs[k, LENGTH]


@kernel
def pull_springs(m, touch, rows):
    """Add the loads of the springs of these rows to those of the bodies."""
    for b in rows:
        for k in range(touch.first_spring[b], touch.first_spring[b + 1]):
            _pull(m, touch.springs, b, k)


@kernel
def _pull(m, springs, b, k):
    (x, y, z), e, more = _stretched(m, springs, k)
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
def hasten(m, springs, dt):
    """Set HASTE of all bodies for the next `dt`, s: the speed that its energy gives, or its force in that time."""
    m[:, HASTE] = 0.0
    for k in range(len(springs)):
        b, (arm, _, away) = int(springs[k, BODY]), _stretched(m, springs, k)
        turning = max(m[b, INVERSE], m[b, INVERSE + 1], m[b, INVERSE + 2])
        wide = max(length(arm), m[b, RADIUS])
        soft, more = m[b, LIGHT] + wide * wide * turning, abs(away)
        m[b, HASTE] += more * min(dt * springs[k, STIFFNESS] * soft, math.sqrt(springs[k, STIFFNESS] * soft))


@kernel
def rate_springs(m, touch, dt):
    """Set SWING of all bodies, for the next `dt`, s.

    Springs of a body add up. One acts along itself with its stiffness and across with tension over length, as a
    pendulum does; it turns its body by tension times arm. The largest counts, so that the bound of what is not pressed
    together does not change with the pose: sub-steps that follow the swing make or take energy. A rope counts if it
    may become taut.
    """
    springs, first = touch.springs, touch.first_spring
    for b in range(len(m)):
        total, damped, turning = 0.0, 0.0, max(m[b, INVERSE], m[b, INVERSE + 1], m[b, INVERSE + 2])
        for k in range(first[b], first[b + 1]):
            if _may_pull(m, springs, k, dt):
                arm, _, away = _away(m, springs, k)
                tension, arm = abs(away) if springs[k, SLACK] == 0.0 else max(away, 0.0), length(arm)
                across = min(tension / max(away + springs[k, LENGTH], 1e-300), _STEEPEST)
                soft = m[b, LIGHT] + arm * arm * turning
                total += springs[k, STIFFNESS] * max(soft * max(across, 1.0), tension * arm * turning)
                damped += springs[k, DAMPING] * soft
        m[b, SWING] = total + damped * damped


@kernel
def _may_pull(m, springs, k, dt):
    """Whether a spring may pull within `dt`, s."""
    if springs[k, SLACK] == 0.0:
        return True
    return _away(m, springs, k)[2] + MARGIN * dt * speed_of(m, int(springs[k, BODY]), dt) > 0.0
