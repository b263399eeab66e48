"""Where two bodies touch: for boxes the common normal by separating axes, for others between their cores.

One normal for all elements of a pair keeps elements near an edge from choosing the wrong face. It is one of 15
directions (Gottschalk, Lin & Manocha 1996, OBBTree): the face normals of both boxes and the cross products of their
edges; the one along which they are farthest apart, or overlap least. `m`: table of bodies.
"""

import math

from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.solid.cores import between_cores
from parsim.solid.shapes.facets import faces_from, normal_towards
from parsim.solid.shapes.kernels import LATERAL, distance, is_box, is_mesh, reach, touches_at_one_point
from parsim.solid.table import CELL, HALF, POSITION, TURN, is_tied, shape_of, three, turn_at

ROUND_A, ROUND_B = 15, 16  # features: a, or b, is round and touches the nearest point of the other
BALLS = 17  # both are round and free to move and turn, or one is, on a wall: through their centres
CORES = 18  # the direction between the cores
FIELD = 19  # one is a mesh: each element has the normal of what it is in
_BIAS = 0.05  # by which another normal must be better, of faces beside the way between cores, of edges beside faces
_PARALLEL = 0.05  # sine of the angle below which edges are parallel: their normal would turn 20 times as fast as they


@kernel
def axis(m, b, i):
    """Direction of axis `i` of body `b`, global."""
    return m[b, TURN + i], m[b, TURN + 3 + i], m[b, TURN + 6 + i]


@kernel
def reach_along(m, forms, b, x, y, z):
    """How far body `b` reaches along the unit vector (x, y, z) from its centre, m."""
    return reach(forms, b, to_body(turn_at(m, b), x, y, z))


@kernel
def direction(m, a, b, feature):
    """Unit vector of `feature`: 0-2 axes of a, 3-5 of b, 6-14 their cross products; zeros if these are parallel."""
    if feature < 3:
        return axis(m, a, feature)
    if feature < 6:
        return axis(m, b, feature - 3)
    u, v, w = axis(m, a, (feature - 6) // 3)
    p, q, r = axis(m, b, (feature - 6) % 3)
    x, y, z = v * r - w * q, w * p - u * r, u * q - v * p
    length = math.sqrt(x * x + y * y + z * z)
    if length < _PARALLEL:
        return 0.0, 0.0, 0.0
    return x / length, y / length, z / length


@kernel
def between(m, a, b, shift):
    """Vector to the centre of a from that of b moved by `shift`."""
    return (
        m[a, POSITION] - m[b, POSITION] - shift[0],
        m[a, POSITION + 1] - m[b, POSITION + 1] - shift[1],
        m[a, POSITION + 2] - m[b, POSITION + 2] - shift[2],
    )


@kernel
def separation(m, forms, a, b, shift, feature):
    """(distance of a and b along a feature, unit normal from b to a); negative where they overlap.

    Edges that have turned parallel since they were chosen, within a step, no longer cross: infinitely far apart.
    """
    if feature == BALLS:
        return gap_of_balls(m, a, b, shift)
    if feature == ROUND_A:
        return gap_to_round(m, forms, a, b, shift)
    if feature == ROUND_B:
        apart, x, y, z = gap_to_round(m, forms, b, a, (-shift[0], -shift[1], -shift[2]))
        return apart, -x, -y, -z
    if feature == FIELD:
        return _between_boxes(m, forms, a, b, shift)
    dx, dy, dz = between(m, a, b, shift)
    if feature == CORES:
        n = between_cores(m, forms, a, b, (dx, dy, dz))[0]
        apart = _gap_along(m, forms, a, b, (dx, dy, dz), n)
        return (apart, n[0], n[1], n[2]) if apart >= 0.0 else _least_deep(m, forms, a, b, (dx, dy, dz), (apart, n))
    x, y, z = direction(m, a, b, feature)
    if x == 0.0 and y == 0.0 and z == 0.0:
        return math.inf, x, y, z
    if dx * x + dy * y + dz * z < 0.0:
        x, y, z = -x, -y, -z
    return _gap_along(m, forms, a, b, (dx, dy, dz), (x, y, z)), x, y, z


@kernel
def _gap_along(m, forms, a, b, d, n):
    """Distance of a and b along the unit vector `n` (3,), m; d (3,): vector to the centre of a from that of b."""
    along = d[0] * n[0] + d[1] * n[1] + d[2] * n[2]
    return along - reach_along(m, forms, a, -n[0], -n[1], -n[2]) - reach_along(m, forms, b, n[0], n[1], n[2])


@kernel
def _least_deep(m, forms, a, b, d, known):
    """(distance, unit normal from b to a) along a face's normal where bodies overlap clearly less than along what is
    `known`: (distance < 0, unit normal).

    Where they overlap sideways by less than the margins of their cores, the way between these slants from one rim to
    the other, and what is in each other by 0.1 mm was taken for 40 mm deep.
    """
    best, n = known
    least, (x, y, z) = (1.0 - _BIAS) * best, n
    for body, sign in ((a, -1.0), (b, 1.0)):
        t = turn_at(m, body)
        look = to_body(t, sign * n[0], sign * n[1], sign * n[2])
        first, last = faces_from(forms, body)
        for face in range(first, last):
            p, q, r = normal_towards(forms, body, face, look)
            if p * look[0] + q * look[1] + r * look[2] > LATERAL:
                u, v, w = to_global(t, sign * p, sign * q, sign * r)
                apart = _gap_along(m, forms, a, b, d, (u, v, w))
                if apart > least:
                    best, least, x, y, z = apart, apart, u, v, w
    return best, x, y, z


@kernel
def gap_of_balls(m, a, b, shift):
    """(distance of ball a from ball b moved by `shift`, unit normal from b to a)."""
    x, y, z = between(m, a, b, shift)
    far = math.sqrt(x * x + y * y + z * z)
    if far == 0.0:
        return -m[a, HALF] - m[b, HALF], 0.0, 0.0, 1.0
    return far - m[a, HALF] - m[b, HALF], x / far, y / far, z / far


@kernel
def gap_to_round(m, forms, a, b, shift):
    """(distance of the round body a from the surface of b moved by `shift`, unit normal from b to a)."""
    x, y, z = between(m, a, b, shift)
    t = turn_at(m, b)
    high, n = distance(forms, b, to_body(t, x, y, z))
    x, y, z = to_global(t, n[0], n[1], n[2])
    return high - m[a, HALF], x, y, z


@kernel
def best_feature(m, forms, a, b, shift, planar):
    """(feature, distance) of the direction along which a and b are farthest apart. 0.3 us.

    In 2D only the axes in the plane. Edge pairs must win clearly, as they tie with faces where boxes lie flat. Where
    one is round, the direction is that to the nearest point of the other; where one is no box, that between cores.
    """
    if is_ball(m, a) and is_ball(m, b):
        return BALLS, gap_of_balls(m, a, b, shift)[0]
    for body, feature in ((a, ROUND_A), (b, ROUND_B)):
        if touches_at_one_point(shape_of(m, body)):
            return feature, separation(m, forms, a, b, shift, feature)[0]
    if is_mesh(shape_of(m, a)) or is_mesh(shape_of(m, b)):
        return FIELD, _between_boxes(m, forms, a, b, shift)[0]
    if not is_box(shape_of(m, a)) or not is_box(shape_of(m, b)):
        return CORES, separation(m, forms, a, b, shift, CORES)[0]
    best, farthest = 0, -math.inf
    for feature in range(6):
        if planar and feature % 3 == 1:
            continue
        apart = separation(m, forms, a, b, shift, feature)[0]
        if apart > farthest:
            best, farthest = feature, apart
    if planar:
        return best, farthest
    needed = farthest + _BIAS * abs(farthest)
    for feature in range(6, 15):
        apart = separation(m, forms, a, b, shift, feature)[0]
        if needed < apart < math.inf:
            best, farthest, needed = feature, apart, apart
    return best, farthest


@kernel
def _between_boxes(m, forms, a, b, shift):
    """(at most the distance of a and b, unit normal from b to a): along the axes of the boxes around them."""
    dx, dy, dz = between(m, a, b, shift)
    most, n = -math.inf, (0.0, 0.0, 1.0)
    for feature in range(6):
        x, y, z = direction(m, a, b, feature)
        along = dx * x + dy * y + dz * z
        if along < 0.0:
            along, x, y, z = -along, -x, -y, -z
        apart = along - reach_along(m, forms, a, -x, -y, -z) - reach_along(m, forms, b, x, y, z)
        if apart > most:
            most, n = apart, (x, y, z)
    return most, n[0], n[1], n[2]


@kernel
def is_ball(m, b):
    """Whether body `b` is round, and no joint keeps it from moving."""
    return touches_at_one_point(shape_of(m, b)) and not is_tied(m, b)


@kernel
def overlap_share(m, forms, ab, shift, n, ramp):
    """Share (0 to 1) of its stiffness that a contact of normal `n` (3,) has: less where it is narrower than `ramp`.

    Boxes that overlap like two corners of a raft, by next to nothing in two directions, hardly feel each other.
    """
    a, b = ab
    share = 1.0
    dx, dy, dz = between(m, a, b, shift)
    for feature in range(6):
        u, v, w = direction(m, a, b, feature)
        width = reach_along(m, forms, a, u, v, w) + reach_along(m, forms, b, u, v, w) - abs(dx * u + dy * v + dz * w)
        if width <= 0.0:
            return 0.0
        if abs(u * n[0] + v * n[1] + w * n[2]) < LATERAL:
            share = min(share, width / ramp)
    return share


@kernel
def ramp_of(m, a, b):
    """Width, m, over which the area of elements fades at the rim of a contact: a quarter of their distance."""
    return 0.25 * min(m[a, CELL], m[a, CELL + 2], m[b, CELL], m[b, CELL + 2])


@kernel
def edge_crossing(m, a, b, shift, feature, n):
    """(x, y, z, area, whether they meet) of the crossing of two edges for an edge-edge feature.

    The area is the mean of what an element on either edge would show along the normal `n` from b to a.
    """
    i, j = (feature - 6) // 3, (feature - 6) % 3
    px, py, pz, area_a = _edge(m, a, i, -n[0], -n[1], -n[2])
    qx, qy, qz, area_b = _edge(m, b, j, n[0], n[1], n[2])
    qx, qy, qz = qx + shift[0], qy + shift[1], qz + shift[2]
    ux, uy, uz = axis(m, a, i)
    vx, vy, vz = axis(m, b, j)
    dx, dy, dz = qx - px, qy - py, qz - pz
    c = ux * vx + uy * vy + uz * vz
    du, dv = dx * ux + dy * uy + dz * uz, dx * vx + dy * vy + dz * vz
    s, t = (du - c * dv) / (1.0 - c * c), (c * du - dv) / (1.0 - c * c)
    return (
        0.5 * (px + s * ux + qx + t * vx),
        0.5 * (py + s * uy + qy + t * vy),
        0.5 * (pz + s * uz + qz + t * vz),
        0.5 * (area_a + area_b),
        abs(s) <= m[a, HALF + i] and abs(t) <= m[b, HALF + j],
    )


@kernel
def _edge(m, b, i, x, y, z):
    """Middle of the edge of box b along its axis i that lies farthest along (x, y, z), and its element's area."""
    px, py, pz = three(m, b, POSITION)
    area = 0.0
    for k in range(3):
        if k == i:
            continue
        u, v, w = axis(m, b, k)
        along = u * x + v * y + w * z
        side = m[b, HALF + k] if along > 0.0 else -m[b, HALF + k]
        px, py, pz = px + side * u, py + side * v, pz + side * w
        area += 0.5 * abs(along) * m[b, CELL + i] * m[b, CELL + 3 - i - k]
    return px, py, pz, area
