"""The kernels' working copy of all that moves: one array, a row per body, then those of what is driven (the gate).

One array instead of many: a kernel then passes a table of bodies on to the next at no cost. Columns by name:
"""

from parsim.machine.jit import kernel

POSITION, QUATERNION, VELOCITY = 0, 3, 7
MOMENTUM, SPIN = 10, 13  # angular, both in global axes
TURN = 16  # rotation matrix by rows, 9
GIVEN, LOAD, LOSS, TOTAL = 25, 31, 37, 43  # force and torque: constant; of contacts; their lossy part; their impulse
HALF, CELL = 49, 52  # half edges of the box around it; distances of contact elements
INERTIA, INVERSE, LIGHT = 55, 58, 61  # principal moments; 1 / moments; 1 / mass; the inverses 0 for what is held
ROLE, MATERIAL = 62, 63
MEAN = 64  # of velocity and spin before and after a kick
RADIUS = 70  # of the ball around it, in a plane of the disc
SHAPE = 71  # number of its shape
FREE = 72  # 1 where it may move along x, y, z and turn about them
ROD = 78  # pivot and length of the rod that it hangs by, 0 if by none
PULL, TIED = 82, 88  # force and torque of its springs to the world; their impulse
RUSH = 94  # acceleration of its centre at the kick before
WIDTH = 97

HELD, DRIVEN, ALONE, INVOLVED = 0, 1, 2, 3  # roles: at rest; moves as given; free, touches nothing now; may touch


@kernel
def three(m, b, at):
    """Columns `at` to at + 2 of body `b`, a tuple."""
    return m[b, at], m[b, at + 1], m[b, at + 2]


@kernel
def quaternion_of(m, b):
    """Orientation of body `b`, a tuple of 4."""
    return m[b, QUATERNION], m[b, QUATERNION + 1], m[b, QUATERNION + 2], m[b, QUATERNION + 3]


@kernel
def turn_at(m, b):
    """Rotation matrix of body `b`, nine numbers by rows."""
    t = TURN
    return (
        m[b, t], m[b, t + 1], m[b, t + 2], m[b, t + 3], m[b, t + 4], m[b, t + 5], m[b, t + 6], m[b, t + 7], m[b, t + 8],
    )  # fmt: skip


@kernel
def shape_of(m, b):
    """Number of the shape of body `b`."""
    return int(m[b, SHAPE])


@kernel
def hangs(m, b):
    """Whether body `b` hangs by a rod."""
    return m[b, ROD + 3] > 0.0


@kernel
def along_rod(m, b):
    """Unit vector from the pivot of body `b` to its centre."""
    scale = 1.0 / m[b, ROD + 3]
    return (
        scale * (m[b, POSITION] - m[b, ROD]),
        scale * (m[b, POSITION + 1] - m[b, ROD + 1]),
        scale * (m[b, POSITION + 2] - m[b, ROD + 2]),
    )


@kernel
def turns_freely(m, b):
    """Whether body `b` may turn about all axes."""
    return m[b, FREE + 3] + m[b, FREE + 4] + m[b, FREE + 5] == 3.0


@kernel
def is_tied(m, b):
    """Whether a joint keeps body `b` from moving as its loads would have it."""
    return hangs(m, b) or not turns_freely(m, b) or m[b, FREE] + m[b, FREE + 1] + m[b, FREE + 2] < 3.0


@kernel
def pose_of(m, b, shift):
    """(centre moved by `shift`, rotation matrix) of body `b`."""
    x, y, z = three(m, b, POSITION)
    return (x + shift[0], y + shift[1], z + shift[2]), turn_at(m, b)
