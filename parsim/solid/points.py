"""Points at which hard bodies touch, and how they answer to impulses there."""

import math
from typing import NamedTuple

import numpy as np

from parsim.machine.jit import kernel
from parsim.solid.laws.kernels import coefficients
from parsim.solid.motion import answer
from parsim.solid.search import DEPTH, FEATURE, FIRST, LAST, NORMAL, POINT, TOUCHING, A, B
from parsim.solid.separation import FIELD
from parsim.solid.shapes.polygon import MARGIN
from parsim.solid.table import INVERSE, POSITION, three
from parsim.solid.tanks import RADIUS
from parsim.solid.touch import measure, normal_of


class Points(NamedTuple):
    """Of each point that touches: slot, pair; normal (n, 3); arms (n, 6) from the centres of a and b, m; how deep, m;
    softness along and across the normal, 1/kg; impulse (n, 3), N s; speed along the normal that it is to have, m/s;
    of rolling friction its arm, m, softness at most, 1/(kg m2), and radius, m, (n, 3), and angular impulse (n, 3), N m
    s."""

    slot: np.ndarray
    pair: np.ndarray
    normal: np.ndarray
    arms: np.ndarray
    depth: np.ndarray
    soft: np.ndarray
    impulse: np.ndarray
    wanted: np.ndarray
    rolls: np.ndarray
    spun: np.ndarray


@kernel
def points_of(m, touch, which):
    """All points of the pairs `which` that touch: `Points`, their impulses zero."""
    pairs, slots = touch.pairs, touch.slots
    count = 0
    for c in which:
        apart, x, y, z = normal_of(m, touch, c)
        area = measure(m, touch, c, (x, y, z), apart) if apart < 0.0 else 0.0
        for slot in range(pairs[c, FIRST], pairs[c, LAST] + 1):
            if area == 0.0:
                slots[slot, DEPTH] = 0.0
            count += slots[slot, DEPTH] > 0.0
    out = Points(
        np.zeros(count, np.int64),
        np.zeros(count, np.int64),
        np.zeros((count, 3)),
        np.zeros((count, 6)),
        np.zeros(count),
        np.zeros((count, 2)),
        np.zeros((count, 3)),
        np.zeros(count),
        np.zeros((count, 3)),
        np.zeros((count, 3)),
    )
    k = 0
    for c in which:
        n, known = (0.0, 0.0, 0.0), False
        for slot in range(pairs[c, FIRST], pairs[c, LAST] + 1):
            if slots[slot, DEPTH] > 0.0:
                if touch.pairs[c, FEATURE] == FIELD:
                    n, known = three(slots, slot, NORMAL), True
                if not known:
                    _, x, y, z = normal_of(m, touch, c)
                    n, known = (x, y, z), True
                _note(m, touch, out, k, c, slot, n)
                k += 1
    return out


@kernel
def deepest(touch, number):
    """The largest depth of any element that touches over the least width of a body of its pair."""
    pairs, slots, margin, most = touch.pairs, touch.slots, touch.forms.margin, 0.0
    for c in range(number):
        thin = margin[pairs[c, A]]
        if pairs[c, B] >= 0:
            thin = min(thin, margin[pairs[c, B]])
        for slot in range(pairs[c, FIRST], pairs[c, LAST] + 1):
            if touch.marks[slot, TOUCHING] and slots[slot, DEPTH] > 0.0:
                most = max(most, slots[slot, DEPTH] / thin)
    return 0.5 * MARGIN * most


@kernel
def _note(m, touch, out, k, c, slot, n):
    a, b, by = touch.pairs[c, A], touch.pairs[c, B], three(touch.shift, c, 0)
    x, y, z = three(touch.slots, slot, POINT)
    out.slot[k], out.pair[k], out.depth[k] = slot, c, touch.slots[slot, DEPTH]
    p, q, r = three(m, a, POSITION)
    out.arms[k, 0], out.arms[k, 1], out.arms[k, 2] = x - p, y - q, z - r
    if b >= 0:
        p, q, r = three(m, b, POSITION)
        out.arms[k, 3], out.arms[k, 4], out.arms[k, 5] = x - p - by[0], y - q - by[1], z - r - by[2]
    out.normal[k, 0], out.normal[k, 1], out.normal[k, 2] = n
    across = (0.0, n[2], -n[1]) if abs(n[0]) < 0.6 else (-n[2], 0.0, n[0])
    size = math.sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2])
    u = (across[0] / size, across[1] / size, across[2] / size)
    v = (n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0])
    out.soft[k, 0] = _softness(m, out.arms, k, (a, b), n, n)
    uu, vv = _softness(m, out.arms, k, (a, b), u, u), _softness(m, out.arms, k, (a, b), v, v)
    uv, off = _softness(m, out.arms, k, (a, b), u, v), 0.5 * (uu - vv)
    out.soft[k, 1] = 0.5 * (uu + vv) + math.sqrt(off * off + uv * uv)
    radius, rolling = touch.tanks[c, RADIUS], coefficients(m, touch, a, b)[4]
    if radius > 0.0 and rolling > 0.0:
        soft = max(m[a, INVERSE], m[a, INVERSE + 1], m[a, INVERSE + 2])
        if b >= 0:
            soft += max(m[b, INVERSE], m[b, INVERSE + 1], m[b, INVERSE + 2])
        out.rolls[k, 0], out.rolls[k, 1], out.rolls[k, 2] = rolling * radius, soft, radius


@kernel
def at_centre(arm, f):
    """Force and torque about a centre, six numbers, of the force `f` at `arm` from there."""
    x, y, z = arm
    return f[0], f[1], f[2], y * f[2] - z * f[1], z * f[0] - x * f[2], x * f[1] - y * f[0]


@kernel
def _softness(m, arms, k, ab, n, u):
    """Speed along `u` that a pair gains at a point by an impulse of 1 N s along `n`, 1/kg."""
    soft = _softness_of(m, ab[0], three(arms, k, 0), n, u)
    return soft + _softness_of(m, ab[1], three(arms, k, 3), n, u) if ab[1] >= 0 else soft


@kernel
def _softness_of(m, b, arm, n, u):
    x, y, z = arm
    v, w = answer(m, b, at_centre(arm, n))
    soft = u[0] * (v[0] + w[1] * z - w[2] * y) + u[1] * (v[1] + w[2] * x - w[0] * z)
    return soft + u[2] * (v[2] + w[0] * y - w[1] * x)
