"""One contact element: its normal force with a dashpot, its friction spring with memory.

Friction is a spring with memory (Cundall & Strack 1979), capped at mu times the normal force of the element. What is
round turns on its spot against the friction of a spot that is no point.
"""

import math

from parsim.machine.jit import inlined


@inlined
def normal_force(stiffness, dashpot, area, depth, speed, strength):
    """Normal force of one element, N, and its elastic part. `speed`: of parting, m/s; never pulls.

    `strength`, Pa: no pressure is more than that.
    """
    elastic = stiffness * area * depth
    return min(max(elastic - dashpot * area * speed, 0.0), strength * area), elastic


@inlined
def give_way(depth, crushed, least):
    """(elastic depth, depth crushed for good), m, of an element at `depth` of which `crushed` was already.

    It gives way at the elastic depth `least`: crushing at a constant pressure, by which ice is taken to push on piers
    (AASHTO LRFD Bridge Design Specifications, 3.9.2.2), with the energy spent.
    """
    deep = max(depth - crushed, 0.0)
    return (least, depth - least) if deep > least else (deep, crushed)


@inlined
def friction_force(stretch, n, v, lapse, limit, stiffness, dashpot):
    """(friction force, new stretch), two tuples of 3, and the elastic energy stored.

    `stretch`: displacement of the contact, m, first turned into the plane across the normal `n`; `v`: relative
    velocity, m/s, for `lapse` seconds since; `limit`: mu times the normal force, N; `stiffness`, N/m, and `dashpot`,
    N s/m, of this element.
    """
    along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2]
    vx, vy, vz = v[0] - along * n[0], v[1] - along * n[1], v[2] - along * n[2]
    sx, sy, sz = _into_plane(stretch, n)
    sx, sy, sz = sx + lapse * vx, sy + lapse * vy, sz + lapse * vz
    length = math.sqrt(sx * sx + sy * sy + sz * sz)
    if stiffness * length >= limit:
        ratio = limit / (stiffness * length) if length > 0.0 else 0.0
        sx, sy, sz, length = ratio * sx, ratio * sy, ratio * sz, ratio * length
        dashpot = 0.0
    fx, fy, fz = -stiffness * sx - dashpot * vx, -stiffness * sy - dashpot * vy, -stiffness * sz - dashpot * vz
    size = math.sqrt(fx * fx + fy * fy + fz * fz)
    if size > limit:
        fx, fy, fz = fx * limit / size, fy * limit / size, fz * limit / size
    return (fx, fy, fz), (sx, sy, sz), 0.5 * stiffness * length * length


@inlined
def rolling_torque(roll, n, spin, lapse, limit, radius, stiffness, dashpot):
    """(torque against rolling, N m, new spring, two tuples of 3, and the elastic energy stored).

    A friction spring of what rolls off, radius times the turn, with the stiffness 2.25 mu_r^2 of the normal one, capped
    at mu_r times the normal force (Ai et al. 2011, doi 10.1016/j.powtec.2010.09.030, model C).
    """
    v = (
        radius * (spin[1] * n[2] - spin[2] * n[1]),
        radius * (spin[2] * n[0] - spin[0] * n[2]),
        radius * (spin[0] * n[1] - spin[1] * n[0]),
    )
    (x, y, z), roll, energy = friction_force(roll, n, v, lapse, limit, stiffness, dashpot)
    torque = radius * (n[1] * z - n[2] * y), radius * (n[2] * x - n[0] * z), radius * (n[0] * y - n[1] * x)
    return torque, roll, energy


@inlined
def twisting_torque(twist, speed, lapse, limit, stiffness, inertia):
    """(torque along the normal, N m, new twist, rad, and the elastic energy stored) of what turns on its spot.

    `speed`: of the turn about the normal, rad/s, for `lapse` seconds since; `limit`, N m. Critically damped for this
    `inertia`, kg m2: no spot is known to swing.
    """
    twist, dashpot = twist + lapse * speed, 2.0 * math.sqrt(stiffness * inertia)
    if stiffness * abs(twist) >= limit:
        twist = math.copysign(limit / stiffness, twist) if stiffness > 0.0 else 0.0
        dashpot = 0.0
    torque = min(max(-stiffness * twist - dashpot * speed, -limit), limit)
    return torque, twist, 0.5 * stiffness * twist * twist


@inlined
def of_spot(area, mu):
    """(limit over normal force, m, stiffness over that sideways, m2) of what turns on a round spot of this area, m2.

    Of a circle of radius a whose pressure is that of Hertz: 3 pi / 16 mu N a (Johnson 1985, sec. 3.8), and what is as
    stiff everywhere sideways, a^2 / 2.
    """
    square = area / math.pi
    return 3.0 * math.pi / 16.0 * mu * math.sqrt(square), 0.5 * square


@inlined
def _into_plane(s, n):
    """The vector `s` turned into the plane across the unit vector `n`, of unchanged length."""
    along = s[0] * n[0] + s[1] * n[1] + s[2] * n[2]
    x, y, z = s[0] - along * n[0], s[1] - along * n[1], s[2] - along * n[2]
    before, after = s[0] * s[0] + s[1] * s[1] + s[2] * s[2], x * x + y * y + z * z
    ratio = math.sqrt(before / after) if after > 0.0 else 0.0
    return ratio * x, ratio * y, ratio * z
