"""All joints of a case, as contacts and kernels take them."""

import math
from typing import NamedTuple

import numpy as np

from parsim.geometry.rotation import turn_of, turned
from parsim.solid.joints.lock import AXES, LockTable
from parsim.solid.joints.pendulum import PendulumTable
from parsim.solid.joints.spring import SpringTable


class Joints(NamedTuple):
    """Of nb bodies: free (nb, 6), 1 where it may move along x, y, z and turn about them, else 0; rod (nb, 4), pivot and
    length, m, of what it hangs by, 0 where it does not; springs (k, 14) in order of bodies: body, point in its frame,
    both ends of the line, m, stiffness, N/m, damping, N s/m, length, m, and 1 where it only pulls; driven: (body,
    joint, place (3,), quaternion (4,) at the start)."""

    free: np.ndarray
    rod: np.ndarray
    springs: np.ndarray
    driven: tuple

    def drives(self, time, dt):
        """Number, mean velocity (3,), m/s, and spin (3,), rad/s, over `dt`, s, of each body whose motion is given."""
        for b, table, centre, start in self.driven:
            now, then = (table.pose(max(t - table.begins, 0.0), centre) for t in (time, time + dt))
            if dt == 0.0:
                yield b, np.zeros(3), np.zeros(3)
            else:
                before, after = (turned(turn_of(*pose.turn), tuple(start)) for pose in (now, then))
                yield b, (then.shift - now.shift) / dt, _vector_between(before, after) / dt

    @property
    def reacts(self):
        """Which bodies are tied by any: (nb,) bool."""
        out = ~self.free.all(axis=1) | (self.rod[:, 3] > 0.0)
        out[self.springs[:, 0].astype(int)] = True
        out[[b for b, *_ in self.driven]] = True
        return out


def _vector_between(before, after):
    """The turn vector (3,), rad, that leads from one quaternion to another."""
    w, *v = turned(after, (before[0], -before[1], -before[2], -before[3]))
    sine = math.hypot(*v)
    if sine == 0.0:
        return np.zeros(3)
    return 2.0 * math.atan2(math.copysign(sine, w), abs(w)) / sine * np.array(v)


def joints_of(tables, names, position, quaternion, frames):
    """`Joints` of bodies with these names, positions (nb, 3), m, and quaternions (nb, 4).

    frames (nb, 3, 3): the axes of the case's own frame of each body, by rows in the body's frame.
    """
    count, number = len(names), {name: b for b, name in enumerate(names)}
    free, rod, springs, driven = np.ones((count, 6)), np.zeros((count, 4)), [], []
    for table in tables:
        b = number[table.body]
        if isinstance(table, LockTable):
            free[b, [AXES.index(name) for name in table.locked]] = 0.0
        elif isinstance(table, PendulumTable):
            rod[b] = *table.pivot, np.linalg.norm(position[b] - table.pivot)
        elif isinstance(table, SpringTable):
            at, *rest = table.row()
            springs.append([b, *(frames[b].T @ at), *rest])
        else:
            driven.append((b, table, position[b].copy(), quaternion[b].copy()))
    springs = np.array(sorted(springs, key=lambda row: row[0]), float).reshape(-1, 14)
    return Joints(free, rod, springs, tuple(driven))
