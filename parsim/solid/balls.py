"""Pairs of balls, and of balls and walls: one element, whose normal goes through their centres.

The same laws as in `forces` and `substeps`, for what there is most of.
"""

import math

from parsim.machine.jit import inlined, kernel
from parsim.solid.curves import spot_area
from parsim.solid.element import friction_force, give_way, normal_force, of_spot, rolling_torque, twisting_torque
from parsim.solid.faces import EXPECTED
from parsim.solid.laws.kernels import stiffness
from parsim.solid.laws.law import LINE, SPOT
from parsim.solid.search import (
    CRUSHED,
    DEPTH,
    FEATURE,
    LAST,
    NORMAL,
    ROLL,
    STRETCH,
    TOUCHING,
    TWIST,
    WALL_MATERIAL,
    A,
    B,
)
from parsim.solid.separation import BALLS, gap_of_balls
from parsim.solid.speeds import add_rate
from parsim.solid.table import GIVEN, HALF, LIGHT, LOAD, MATERIAL, POSITION, RUSH, SPIN, VELOCITY, three
from parsim.solid.tanks import BEFORE, LAPSE, LOADS, LOSSES, NOW, SHEAR, SHEAR_BEFORE, SPENT

CALM = 0.25  # how far, over their depth, contacts at rest may still move


@kernel
def press_balls(m, touch, which, lapse, span):
    """Loads of those of the pairs `which` that are balls; how many touch. See `forces.press`."""
    pairs, marks, slots, tanks = touch.pairs, touch.marks, touch.slots, touch.tanks
    touching = 0
    for c in which:
        if pairs[c, FEATURE] != BALLS:
            continue
        apart, n = _gap(m, touch.walls, pairs, touch.shift, c)
        tanks[c, BEFORE], tanks[c, SHEAR_BEFORE] = tanks[c, NOW], tanks[c, SHEAR]
        if apart >= 0.0:
            marks[pairs[c, LAST], TOUCHING], slots[pairs[c, LAST], DEPTH] = 0, 0.0
            tanks[c, NOW] = tanks[c, SHEAR] = 0.0
            for k in range(LOADS, LOSSES + 6):
                tanks[c, k] = 0.0
            continue
        touching += 1
        slot, ab = slots[pairs[c, LAST]], (pairs[c, A], pairs[c, B])
        slot[DEPTH] = -apart
        age = lapse + tanks[c, LAPSE] if span > 0.0 else 0.0
        if not marks[pairs[c, LAST], TOUCHING]:
            slot[STRETCH:NORMAL], marks[pairs[c, LAST], TOUCHING], age = 0.0, 1, 0.0
        law = _law(m, ab, -apart, touch.walls, touch.pair_law, touch.law, touch.forms.planar)
        _push(m, slot, tanks[c], ab, n, law, (-apart, age, span), touch.forms.planar)
    return touching


@inlined
def _gap(m, walls, pairs, shift, c):
    """(distance of pair `c`, unit normal towards ball a); endlessly far where its wall is not."""
    a, b = pairs[c, A], pairs[c, B]
    if b >= 0:
        apart, x, y, z = gap_of_balls(m, a, b, three(shift, c, 0))
        return apart, (x, y, z)
    w = -1 - b
    (x, y, z), n = three(m, a, POSITION), three(walls, w, 0)
    apart = x * n[0] + y * n[1] + z * n[2] - m[a, HALF] - walls[w, 3]
    arm = m[a, HALF] + 0.5 * min(apart, 0.0)
    x, y, z = x - arm * n[0], y - arm * n[1], z - arm * n[2]
    there = walls[w, 4] <= x <= walls[w, 7] and walls[w, 5] <= y <= walls[w, 8] and walls[w, 6] <= z <= walls[w, 9]
    return (apart if there else math.inf), n


@inlined
def radius_of_both(one, two):
    """Radius, m, of balls of the radii `one` and `two`, m, together; `two` 0: of a wall."""
    return one * two / (one + two) if two > 0.0 else one


@inlined
def _law(m, ab, deep, walls, law, number, planar):
    """(area, m2, radius, m, of what touches; force over area and depth; energy held over force times depth; damping
    ratio; friction; tangential over normal stiffness; rolling friction; crushing strength, Pa)."""
    a, b = ab
    one, two = int(m[a, MATERIAL]), int(m[b, MATERIAL] if b >= 0 else walls[-1 - b, WALL_MATERIAL])
    radius = radius_of_both(m[a, HALF], m[b, HALF] if b >= 0 else 0.0)
    bend = LINE if planar else SPOT
    area = spot_area((bend, radius), deep)
    rigid, held, more = stiffness(number, law[0, one, two], area, bend, radius, deep)
    shear = more * law[3, one, two]
    return area, radius, rigid, held, law[1, one, two], law[2, one, two], shear, law[4, one, two], law[5, one, two]


@inlined
def lightness(m, a, b):
    """1 / effective mass of two balls along their normal, 1/kg."""
    return m[a, LIGHT] + (m[b, LIGHT] if b >= 0 else 0.0)


@inlined
def _slip(m, a, b, n, arm):
    """Velocity (3,), m/s, and spin (3,) of ball a against b, or a wall, where they touch; arms along the normal, m."""
    v, w = three(m, a, VELOCITY), three(m, a, SPIN)
    x, y, z = arm[0] * n[0], arm[0] * n[1], arm[0] * n[2]
    v = (v[0] + (w[1] * z - w[2] * y), v[1] + (w[2] * x - w[0] * z), v[2] + (w[0] * y - w[1] * x))
    if b < 0:
        return v, w
    u, s = three(m, b, VELOCITY), three(m, b, SPIN)
    x, y, z = arm[1] * n[0], arm[1] * n[1], arm[1] * n[2]
    u = (u[0] + (s[1] * z - s[2] * y), u[1] + (s[2] * x - s[0] * z), u[2] + (s[0] * y - s[1] * x))
    return (v[0] - u[0], v[1] - u[1], v[2] - u[2]), (w[0] - s[0], w[1] - s[1], w[2] - s[2])


@inlined
def _arms(m, a, b, deep):
    """How far along the normal the place of contact lies from the centres of a and b, m."""
    return 0.5 * deep - m[a, HALF], (m[b, HALF] - 0.5 * deep if b >= 0 else 0.0)


@kernel
def _push(m, slot, tank, ab, n, law, now, planar):
    """The law for one pair with its slot and its tank; `now`: depth, m, age of its springs and span of the kick, s."""
    a, b = ab
    light, arm = lightness(m, a, b), _arms(m, a, b, now[0])
    before = slot[CRUSHED]
    deep, slot[CRUSHED] = give_way(now[0], before, law[8] / law[2])
    if slot[CRUSHED] > before:
        tank[SPENT] += law[8] * law[0] * (slot[CRUSHED] - before)
    now = deep, now[1], now[2]
    x, y, z = three(m, a, RUSH)
    if b >= 0:
        p, q, r = three(m, b, RUSH)
        x, y, z = x - p, y - q, z - r
    before = tank[LOADS] * n[0] + tank[LOADS + 1] * n[1] + tank[LOADS + 2] * n[2]
    ahead = before, x * n[0] + y * n[1] + z * n[2]
    s, roll = (slot[STRETCH], slot[STRETCH + 1], slot[STRETCH + 2]), (slot[ROLL], slot[ROLL + 1], slot[ROLL + 2])
    v, spin = _slip(m, a, b, n, arm)
    normal, elastic, slip, s, energy = push_of_balls(law, n, v, light, ahead, s, now)
    turn = (0.0, 0.0, 0.0)
    if law[7] > 0.0:
        turn, roll, more = turn_of_balls(law, n, spin, light, normal, roll, now)
        energy += more
    if not planar:
        t, slot[TWIST], more = twist_of_balls(law, n, spin, light, normal, slot[TWIST], now)
        turn, energy = (turn[0] + t * n[0], turn[1] + t * n[1], turn[2] + t * n[2]), energy + more
    for k in range(3):
        slot[STRETCH + k], slot[ROLL + k] = s[k], roll[k]
    tank[NOW], tank[SHEAR] = energy + law[3] * elastic * now[0], energy
    _load(m, tank, ab, n, arm, ((normal, slip), turn, elastic))


@inlined
def dashpot_of_balls(law, light, span):
    """Dashpot over area, N s/m3, of two balls for the `law` that they have; less in long kicks: see `forces._push`."""
    area, _, rigid, held, damping, _, _, _, _ = law
    dashpot = 2.0 * damping * math.sqrt(rigid / (light * area) * (0.5 / held))
    return dashpot / (1.0 + 0.5 * span * dashpot * area * light)


@inlined
def push_of_balls(law, n, v, light, ahead, stretch, now):
    """(normal force, its elastic part, N, friction (3,), N, new stretch (3,), m, energy in it, J) on ball a.

    `law`: see `_law`; `v`: of a against b where they touch; `light`: 1 / effective mass; `ahead`: their force along the
    normal and their acceleration along it at the kick before; `now`: depth, m, age of the stretch, span of the kick, s.
    """
    area, _, rigid, _, _, mu, shear, _, strength = law
    (before, parting), (deep, age, span) = ahead, now
    dashpot = dashpot_of_balls(law, light, span)
    sooner = 0.5 * span * (parting + light * (rigid * area * deep - before))
    speed = v[0] * n[0] + v[1] * n[1] + v[2] * n[2]
    normal, elastic = normal_force(rigid, dashpot, area, deep, speed + sooner, strength)
    stiff, drag = shear * rigid * area, math.sqrt(shear) * dashpot * area
    slip, stretch, energy = friction_force(stretch, n, v, age, mu * normal, stiff, drag)
    return normal, elastic, slip, stretch, energy


@inlined
def turn_of_balls(law, n, spin, light, normal, roll, now):
    """(torque against rolling (3,), N m, its new spring (3,), m, energy in it, J) on ball a; see `push_of_balls`."""
    area, radius, rigid, _, _, _, _, rolling, _ = law
    share, dashpot = 2.25 * rolling * rolling, dashpot_of_balls(law, light, now[2])
    stiff, drag = share * rigid * area, math.sqrt(share) * dashpot * area
    return rolling_torque(roll, n, spin, now[1], rolling * normal, radius, stiff, drag)


@inlined
def twist_of_balls(law, n, spin, light, normal, twist, now):
    """(torque along the normal, N m, new twist, rad, energy in it, J) on ball a; see `push_of_balls`."""
    area, radius, rigid, _, _, mu, shear, _, _ = law
    spot, stiff = of_spot(area, mu)
    speed = spin[0] * n[0] + spin[1] * n[1] + spin[2] * n[2]
    stiff, inertia = stiff * shear * rigid * area, 0.4 * radius * radius / light
    return twisting_torque(twist, speed, now[1], spot * normal, stiff, inertia)


@kernel
def _load(m, tank, ab, n, arm, given):
    """Note what a pair does to ball a in its tank, and load both."""
    (normal, slip), turn, elastic = given
    a, b = ab
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        force, moment = normal * n[k] + slip[k], n[i] * slip[j] - n[j] * slip[i]
        torque = arm[0] * moment + turn[k]
        tank[LOADS + k], tank[LOSSES + k] = force, force - elastic * n[k]
        tank[LOADS + 3 + k] = tank[LOSSES + 3 + k] = torque
        m[a, LOAD + k] += force
        m[a, LOAD + 3 + k] += torque
        if b >= 0:
            m[b, LOAD + k] -= force
            m[b, LOAD + 3 + k] -= arm[1] * moment + turn[k]


@kernel
def rate_balls(m, touch, which, steps):
    """Add to the RATE of their bodies what those of the pairs `which` that are balls need; see `rates.longest_step`.

    `steps`: in half a period of what moves, and of what is at rest.
    """
    pairs = touch.pairs
    for c in which:
        if pairs[c, FEATURE] != BALLS:
            continue
        a, b = pairs[c, A], pairs[c, B]
        apart, n = _gap(m, touch.walls, pairs, touch.shift, c)
        if apart == math.inf:
            continue
        square = _square(
            m, touch, a, b, max(EXPECTED * radius_of_both(m[a, HALF], m[b, HALF] if b >= 0 else 0.0), -apart)
        )
        many = steps[1] if apart < 0.0 and _calm(m, touch, a, b, -apart, n) else steps[0]
        add_rate(m, a, b, n, square * (many * many))


@inlined
def _square(m, touch, a, b, deep):
    """Square of the angular frequency, 1/s2, of two balls on each other at a depth."""
    law = _law(m, (a, b), deep, touch.walls, touch.pair_law, touch.law, touch.forms.planar)
    area, _, rigid, held, _, _, _, _, _ = law
    return rigid * (1.0 / held - 1.0) * area * lightness(m, a, b)


@inlined
def _calm(m, touch, a, b, deep, n):
    """Whether two balls lie at rest on each other; see `rates._calm`."""
    square, light = _square(m, touch, a, b, deep), m[a, LIGHT]
    v, _ = _slip(m, a, b, n, _arms(m, a, b, deep))
    pull = 0.0
    for k in range(3):
        pull += n[k] * light * (m[a, GIVEN + k] + m[a, LOAD + k])
        if b >= 0:
            pull -= n[k] * m[b, LIGHT] * (m[b, GIVEN + k] + m[b, LOAD + k])
    fastest = abs(v[0] * n[0] + v[1] * n[1] + v[2] * n[2])
    return fastest / math.sqrt(square) + abs(pull) / square < CALM * deep
