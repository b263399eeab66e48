"""The kernels' working copy of all that moves: one array, a row per body, then those of what is driven (the gate).

One array instead of many: a kernel then passes a table of bodies on to the next at no cost. Columns by name:
"""

from parsim.machine.jit import kernel

# what every pair asks for comes first and lies together: a table of many bodies does not fit into the cache
POSITION, VELOCITY, SPIN = 0, 3, 6  # spin in global axes
LIGHT, HALF = 9, 10  # 1 / mass, 0 for what is held; half edges of the box around it
ROLE, MATERIAL = 13, 14
RUSH = 15  # acceleration of its centre at the kick before
LOAD, LOSS = 18, 24  # force and torque of contacts and springs, of the drag of springs
MEAN = 30  # of velocity and spin before and after a kick
GIVEN, TOTAL = 36, 42  # force and torque that are constant; impulse of contacts
STIRRED = 48  # round in which its loads last changed, as contacts are kept from giving energy
QUATERNION, TURN = 49, 53  # TURN: rotation matrix by rows, 9
MOMENTUM = 62  # angular, in global axes
INERTIA, INVERSE = 65, 68  # principal moments; 1 / moments, 0 for what is held
CELL = 71  # distances of contact elements
RADIUS, SHAPE = 74, 75  # of the ball around it, in a plane of the disc; number of its shape
FREE = 76  # 1 where it may move along x, y, z and turn about them
ROD = 82  # pivot and length of the rod that it hangs by, 0 if by none
PULL, TIED = 86, 92  # force and torque of its springs to the world; their impulse
RATE, SWING = 98, 101  # bounds of the squares of its frequencies, 1/s2: along the axes by contacts; by its springs
HASTE = 102  # bound of the speed that its springs may give it in a step
WIDTH = 103

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
