"""Contacts of a heap in blocks of 64: one quantity of all of them lies together, so that loops become vector code.

A block is ROWS rows of 64 numbers: RA, RB, m, radii of balls a and b, of a wall 0; ROUND, m, of both together; LIGHT,
1/kg, 1 / effective mass; OWN, DAMPING, MU, SHEAR, ROLLING, see `forces.press`; BY (3), m, to the periodic image of b;
TOUCHING, 1 or 0; LAPSE, STORED, LOST, SHEARED, NOW, see `tanks`; ROOM, J, the most that its tank may hold; FREED, J,
what its friction springs hold less than before; DEEP, m; NORMAL, ELASTIC, N; N (3); SLIP, friction (3), N; TURN,
against rolling and twisting (3), N m; STRETCH, ROLL (3), m; TWIST, rad; WORK, WASTE, J, of all its loads and of what
they dissipate in a kick; DRY, see `tanks`.

Loops are over all 64, with what does not touch masked, and take roots eight at a time. What they call must be
`inlined`; a block is handed on as a view from 0 on, for where an index may be negative no loop becomes vector code.
"""

import math

from parsim.machine.jit import inlined, kernel
from parsim.solid.balls import push_of_balls, turn_of_balls, twist_of_balls
from parsim.solid.curves import spot_area
from parsim.solid.laws.kernels import stiffness

LANES, ROWS = 64, 42
(
    RA, RB, ROUND, LIGHT, OWN, DAMPING, MU, SHEAR, ROLLING, BY, _, _, TOUCHING, LAPSE, STORED, LOST, SHEARED, NOW, ROOM,
    FREED, DEEP, NORMAL, ELASTIC, N, _, _, SLIP, _, _, TURN, _, _, STRETCH, _, _, ROLL, _, _, TWIST, WORK, WASTE, DRY,
) = range(0, ROWS * LANES, LANES)  # fmt: skip
_V, _A, _B, _R, _D, _NEW, _FAR, _AREA, _RIGID, _HELD, _MORE = (
    LANES * k for k in (0, 3, 6, 9, 12, 15, 18, 19, 20, 21, 22)
)
SCRATCH = 23 * LANES
_Y, _Z = LANES, 2 * LANES
# columns of the tables of a heap's balls. move: place, velocity, spin, acceleration at the kick before, radius,
# 1 / mass, 1 / moment of inertia, material; load: what contacts do now, mean of the motions before and after a kick;
# kept: constant load, impulse of contacts, quaternion
X, V, W, RUSH, RADIUS, SOFT, INERT, MATERIAL = 0, 3, 6, 9, 12, 13, 14, 15
LOAD, MEAN = 0, 6
GIVEN, TOTAL, QUATERNION = 0, 6, 12


@kernel
def gather(move, a, b, s):
    """Velocities, spins and accelerations of the balls `a` and `b` of a block into the scratch `s`."""
    for i in range(LANES):
        p, q = a[i], b[i]
        for k in range(3):
            s[_V + k * LANES + i] = move[p, V + k] - move[q, V + k]
            s[_A + k * LANES + i], s[_B + k * LANES + i] = move[p, W + k], move[q, W + k]
            s[_R + k * LANES + i] = move[p, RUSH + k] - move[q, RUSH + k]


@kernel
def approach(move, a, b, pair, s):
    """Depth and normal of a block of pairs of balls, into `s`."""
    for i in range(LANES):
        p, q = a[i], b[i]
        for k in range(3):
            s[_D + k * LANES + i] = move[p, X + k] - move[q, X + k]
    for i in range(LANES):
        x, y, z = s[_D + i] - pair[i + BY], s[_D + _Y + i] - pair[i + BY + _Y], s[_D + _Z + i] - pair[i + BY + _Z]
        far = math.sqrt(x * x + y * y + z * z)
        share = 1.0 / far if far > 0.0 else 0.0
        s[_NEW + i], s[_NEW + _Y + i], s[_NEW + _Z + i] = share * x, share * y, share * z if far > 0.0 else 1.0
        s[_FAR + i] = pair[i + RA] + pair[i + RB] - far


@kernel
def approach_walls(move, a, walls, which, s):
    """The same of a block of balls and walls; `which`: number of the wall, by pair, -1: none."""
    for i in range(LANES):
        p, w = a[i], which[i]
        s[_FAR + i], s[_NEW + i], s[_NEW + _Y + i], s[_NEW + _Z + i] = -1.0, 0.0, 0.0, 1.0
        if w >= 0:
            n = (walls[w, 0], walls[w, 1], walls[w, 2])
            s[_FAR + i] = -height(move, p, walls, w)
            s[_NEW + i], s[_NEW + _Y + i], s[_NEW + _Z + i] = n


@inlined
def height(move, p, walls, w):
    """Distance, m, of ball `p` from wall `w`; endlessly far where the wall is not."""
    x, y, z, radius = move[p, X], move[p, X + 1], move[p, X + 2], move[p, RADIUS]
    apart = x * walls[w, 0] + y * walls[w, 1] + z * walls[w, 2] - radius - walls[w, 3]
    arm = radius + 0.5 * min(apart, 0.0)
    x, y, z = x - arm * walls[w, 0], y - arm * walls[w, 1], z - arm * walls[w, 2]
    there = walls[w, 4] <= x <= walls[w, 7] and walls[w, 5] <= y <= walls[w, 8] and walls[w, 6] <= z <= walls[w, 9]
    return apart if there else math.inf


@kernel
def respond(pair, s, law, lapse, span):
    """Forces of a block, what was approached and gathered in `s`; see `forces.press`. `law`: (number, curvature)."""
    number, bend = law
    for i in range(LANES):
        far, radius, own = s[_FAR + i], pair[i + ROUND], pair[i + OWN]
        deep = far if far > 0.0 else radius
        area = spot_area((bend, radius), deep)
        rigid, held, more = stiffness(number, own, area, bend, radius, deep)
        s[_AREA + i], s[_RIGID + i], s[_HELD + i], s[_MORE + i] = area, rigid, held, more
    for i in range(LANES):
        far, radius, n = s[_FAR + i], pair[i + ROUND], (s[_NEW + i], s[_NEW + _Y + i], s[_NEW + _Z + i])
        on, was = far > 0.0, pair[i + TOUCHING]
        deep = far if on else radius
        one, two = 0.5 * deep - pair[i + RA], pair[i + RB] - 0.5 * deep
        before = pair[i + NORMAL] * (pair[i + N] * n[0] + pair[i + N + _Y] * n[1] + pair[i + N + _Z] * n[2])
        before += pair[i + SLIP] * n[0] + pair[i + SLIP + _Y] * n[1] + pair[i + SLIP + _Z] * n[2]
        parting = s[_R + i] * n[0] + s[_R + _Y + i] * n[1] + s[_R + _Z + i] * n[2]
        x, y, z = _armed(s, i, one, two)
        v = (
            s[_V + i] + (y * n[2] - z * n[1]),
            s[_V + _Y + i] + (z * n[0] - x * n[2]),
            s[_V + _Z + i] + (x * n[1] - y * n[0]),
        )
        shear, held = s[_MORE + i] * pair[i + SHEAR], s[_HELD + i]
        own = s[_AREA + i], radius, s[_RIGID + i], held, pair[i + DAMPING], pair[i + MU], shear, 0.0, math.inf
        age = was * (lapse + pair[i + LAPSE])
        stretch = was * pair[i + STRETCH], was * pair[i + STRETCH + _Y], was * pair[i + STRETCH + _Z]
        ahead, now = (before, parting), (deep, age, span)
        normal, elastic, slip, stretch, energy = push_of_balls(own, n, v, pair[i + LIGHT], ahead, stretch, now)
        pair[i + NORMAL], pair[i + ELASTIC] = normal if on else 0.0, elastic if on else 0.0
        for c in range(3):
            pair[i + N + c * LANES], pair[i + SLIP + c * LANES] = n[c], slip[c] if on else 0.0
            pair[i + STRETCH + c * LANES] = stretch[c] if on else 0.0
        pair[i + DEEP], pair[i + DRY] = deep if on else 0.0, 0.0
        room, energy = pair[i + NOW], energy if on else 0.0
        pair[i + NOW] = energy + (held * elastic * deep if on else 0.0)
        room += pair[i + NOW]
        pair[i + ROOM] = room
        pair[i + FREED], pair[i + SHEARED] = pair[i + SHEARED] - energy, energy


@kernel
def roll(pair, s, lapse, span):
    """Add what rolling friction does to the forces of a block, known from `respond`."""
    for i in range(LANES):
        on, was, n = pair[i + DEEP] > 0.0, pair[i + TOUCHING], (pair[i + N], pair[i + N + _Y], pair[i + N + _Z])
        acts = on and pair[i + ROLLING] > 0.0
        rolling = pair[i + ROLLING] if acts else 1.0
        own = s[_AREA + i], pair[i + ROUND], s[_RIGID + i], s[_HELD + i], pair[i + DAMPING], 0.0, 0.0, rolling, math.inf
        spin = s[_A + i] - s[_B + i], s[_A + _Y + i] - s[_B + _Y + i], s[_A + _Z + i] - s[_B + _Z + i]
        rolled = was * pair[i + ROLL], was * pair[i + ROLL + _Y], was * pair[i + ROLL + _Z]
        now = pair[i + DEEP], was * (lapse + pair[i + LAPSE]), span
        turn, rolled, energy = turn_of_balls(own, n, spin, pair[i + LIGHT], pair[i + NORMAL], rolled, now)
        for a in range(3):
            pair[i + TURN + a * LANES] = turn[a] if acts else 0.0
            pair[i + ROLL + a * LANES] = rolled[a] if acts else 0.0
        energy = energy if acts else 0.0
        pair[i + NOW] += energy
        pair[i + ROOM] += energy
        pair[i + FREED] -= energy
        pair[i + SHEARED] += energy


@kernel
def twist(pair, s, lapse, span):
    """Add what friction does against turns about the normal to the forces of a block, known from `respond`."""
    for i in range(LANES):
        on, was, n = pair[i + DEEP] > 0.0, pair[i + TOUCHING], (pair[i + N], pair[i + N + _Y], pair[i + N + _Z])
        shear = s[_MORE + i] * pair[i + SHEAR] if on else 1.0
        own = s[_AREA + i], pair[i + ROUND], s[_RIGID + i], 1.0, 0.0, pair[i + MU], shear, 0.0, math.inf
        spin = s[_A + i] - s[_B + i], s[_A + _Y + i] - s[_B + _Y + i], s[_A + _Z + i] - s[_B + _Z + i]
        now = pair[i + DEEP], was * (lapse + pair[i + LAPSE]), span
        t, turned, energy = twist_of_balls(own, n, spin, pair[i + LIGHT], pair[i + NORMAL], was * pair[i + TWIST], now)
        for a in range(3):
            pair[i + TURN + a * LANES] += t * n[a] if on else 0.0
        pair[i + TWIST] = turned if on else 0.0
        energy = energy if on else 0.0
        pair[i + NOW] += energy
        pair[i + ROOM] += energy
        pair[i + FREED] -= energy
        pair[i + SHEARED] += energy


@inlined
def _armed(s, i, one, two):
    """Spins times arms along the normal, of a less that of b."""
    x, y = one * s[_A + i] - two * s[_B + i], one * s[_A + _Y + i] - two * s[_B + _Y + i]
    return x, y, one * s[_A + _Z + i] - two * s[_B + _Z + i]


@kernel
def load_balls(load, a, b, pair):
    """Add the loads of a block to those of its balls, pair by pair; how many touch."""
    touching = 0
    for i in range(LANES):
        p, q = a[i], b[i]
        pair[i + TOUCHING], pair[i + LAPSE] = 0.0, 0.0
        if pair[i + DEEP] > 0.0:
            touching += 1
            pair[i + TOUCHING] = 1.0
            load_pair(load, p, q, pair, i, 1.0)
    return touching


@kernel
def load_pair(load, p, q, pair, k, share):
    """Add this share of the loads of the pair at `k` to those of its balls `p` and `q`."""
    n, f = (pair[k + N], pair[k + N + _Y], pair[k + N + _Z]), (pair[k + SLIP], pair[k + SLIP + _Y], pair[k + SLIP + _Z])
    one, two = 0.5 * pair[k + DEEP] - pair[k + RA], pair[k + RB] - 0.5 * pair[k + DEEP]
    normal = pair[k + NORMAL]
    moment = n[1] * f[2] - n[2] * f[1], n[2] * f[0] - n[0] * f[2], n[0] * f[1] - n[1] * f[0]
    for c in range(3):
        force, turn = share * (normal * n[c] + f[c]), pair[k + TURN + c * LANES]
        load[p, LOAD + c] += force
        load[q, LOAD + c] -= force
        load[p, LOAD + 3 + c] += share * (one * moment[c] + turn)
        load[q, LOAD + 3 + c] -= share * (two * moment[c] + turn)


@kernel
def work(load, a, b, pair, s, span):
    """WORK and WASTE of a block in a kick over `span`, s, at the MEAN motion of its balls."""
    for i in range(LANES):
        p, q = a[i], b[i]
        for c in range(3):
            s[_V + c * LANES + i] = load[p, MEAN + c] - load[q, MEAN + c]
            s[_A + c * LANES + i], s[_B + c * LANES + i] = load[p, MEAN + 3 + c], load[q, MEAN + 3 + c]
    for i in range(LANES):
        n = pair[i + N], pair[i + N + _Y], pair[i + N + _Z]
        one, two = 0.5 * pair[i + DEEP] - pair[i + RA], pair[i + RB] - 0.5 * pair[i + DEEP]
        x, y, z = _armed(s, i, one, two)
        u, v, w = s[_V + i], s[_V + _Y + i], s[_V + _Z + i]
        along = u * n[0] + v * n[1] + w * n[2]
        u, v, w = u + (y * n[2] - z * n[1]), v + (z * n[0] - x * n[2]), w + (x * n[1] - y * n[0])
        power = pair[i + NORMAL] * along + (pair[i + SLIP] * u + pair[i + SLIP + _Y] * v + pair[i + SLIP + _Z] * w)
        x, y, z = s[_A + i] - s[_B + i], s[_A + _Y + i] - s[_B + _Y + i], s[_A + _Z + i] - s[_B + _Z + i]
        power += pair[i + TURN] * x + pair[i + TURN + _Y] * y + pair[i + TURN + _Z] * z
        pair[i + WORK], pair[i + WASTE] = span * power, span * (power - pair[i + ELASTIC] * along)
        pair[i + STORED] = min(pair[i + STORED], pair[i + ROOM])


@kernel
def exceeds(pair):
    """Whether a pair of a block would take more from its tank than is in it."""
    over = 0
    for i in range(LANES):
        over += pair[i + WORK] > pair[i + STORED]
    return over > 0


@kernel
def slacken(pair, k, share):
    """Leave the pair at `k` this share of its loads, and its friction springs the stretch that goes with theirs."""
    pair[k + NORMAL] *= share
    pair[k + ELASTIC] *= share
    pair[k + TWIST] *= share
    for c in range(3):
        for row in (SLIP, TURN, STRETCH, ROLL):
            pair[k + row + c * LANES] *= share
    left = share * share * pair[k + SHEARED]
    pair[k + FREED] += pair[k + SHEARED] - left
    pair[k + SHEARED] = left


@kernel
def account(pair, taken):
    """Fill or drain the tanks of a block by its WORK; adds to `taken` (64,), J. See `tanks._account`."""
    for i in range(LANES):
        taken[i] -= pair[i + WORK]
        more = max(-pair[i + WORK], 0.0) * (1.0 - pair[i + DRY])
        there = max(pair[i + STORED] - max(pair[i + WORK], 0.0), 0.0) + more
        lost = min(max(pair[i + FREED] - pair[i + WASTE], -pair[i + LOST]), there)
        on = pair[i + NOW] > 0.0
        before, stored = pair[i + LOST], pair[i + STORED]
        after = min(before + lost, pair[i + ROOM])
        pair[i + LOST], pair[i + STORED] = after if on else before, there - lost if on else stored


@kernel
def answer_to(move, p, q, pair, k):
    """(force times acceleration by the loads of the pair at `k` on its balls `p` and `q`, W/s; power of these at the
    motion before the kick, W)."""
    n, f = (pair[k + N], pair[k + N + _Y], pair[k + N + _Z]), (pair[k + SLIP], pair[k + SLIP + _Y], pair[k + SLIP + _Z])
    one, two = 0.5 * pair[k + DEEP] - pair[k + RA], pair[k + RB] - 0.5 * pair[k + DEEP]
    moment = n[1] * f[2] - n[2] * f[1], n[2] * f[0] - n[0] * f[2], n[0] * f[1] - n[1] * f[0]
    total, power = 0.0, 0.0
    for c in range(3):
        force, turn = pair[k + NORMAL] * n[c] + f[c], pair[k + TURN + c * LANES]
        x, y = one * moment[c] + turn, two * moment[c] + turn
        total += pair[k + LIGHT] * force * force + move[p, INERT] * x * x + move[q, INERT] * y * y
        power += force * (move[p, V + c] - move[q, V + c])
        power += x * move[p, W + c] - y * move[q, W + c]
    return total, power
