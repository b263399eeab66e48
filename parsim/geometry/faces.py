"""The faces of the box, in every form in which they are needed: which are walls, where these end, what repeats."""

import math

import numpy as np

SIDES = (("x_min", "x_max"), ("y_min", "y_max"), ("z_min", "z_max"))


def walled_sides(case, to="water"):
    """Axis, side (-1 low, 1 high) and level, m, of each side of the box that is a wall to "water" or to "bodies"."""
    for axis in case.axes:
        for sign, name, level in zip((-1, 1), SIDES[axis], (case.box.min[axis], case.box.max[axis]), strict=True):
            if _holds(case, name, to):
                yield axis, sign, level


def names_of_walls(case):
    """Names of the sides that are walls to water, such as "z_min", in the order of `planes_of_walls`."""
    return [SIDES[axis][sign > 0] for axis, sign, _ in walled_sides(case)]


def velocities_of_walls(case):
    """How fast the walls go in their own planes, (n, 3), m/s, in the order of `planes_of_walls`."""
    sides = [getattr(case.box.faces, name) for name in names_of_walls(case)]
    return np.array([side.velocity or (0.0, 0.0, 0.0) for side in sides]).reshape(-1, 3)


def _holds(case, name, to):
    side = getattr(case.box.faces, name)
    return {"water": side.holds_water, "bodies": side.holds_bodies}[to]


def ends_of_walls(case, to="water"):
    """Lowest and highest corner (3,), m, of where there are walls: they end where things leave, and only there."""

    def leaves(name):
        side = getattr(case.box.faces, name)
        return not (_holds(case, name, to) or side.repeats or side.continues)

    low = [case.box.min[a] if leaves(low) else -np.inf for a, (low, _) in enumerate(SIDES)]
    high = [case.box.max[a] if leaves(high) else np.inf for a, (_, high) in enumerate(SIDES)]
    return np.array(low), np.array(high)


def planes_of_walls(case, to="water"):
    """The walls as kernels take them, (n, 10): normal inwards, level, lowest and highest corner of where they are, m.

    A point x is in front of one where normal . x > level.
    """
    planes = list(walled_sides(case, to))
    walls = np.zeros((len(planes), 10))
    walls[:, 4:] = np.concatenate(ends_of_walls(case, to))
    for row, (axis, side, level) in enumerate(planes):
        walls[row, axis], walls[row, 3] = -side, -side * level
    return walls


def repeats(case):
    """Whether the box repeats along x, y and z: three bool."""
    faces = [getattr(case.box.faces, low) for low, _ in SIDES]
    return tuple(axis in case.axes and face.repeats for axis, face in enumerate(faces))


def period(case):
    """Lengths (3,), m, after which the box repeats; inf where it does not."""
    low, high = case.box.min, case.box.max
    return np.array([high[a] - low[a] if again else math.inf for a, again in enumerate(repeats(case))])


def images(case, places, reach):
    """Places (n, 2 or 3), m, brought into the box, with their images at most `reach` (n,), m, off it: (m, 2 or 3); and
    which of the places each is of (m,)."""
    of, places = np.arange(len(places)), np.array(places, float)
    for axis, length in enumerate(period(case)[: places.shape[1]]):
        if not math.isfinite(length):
            continue
        low = case.box.min[axis]
        places[:, axis] = low + (places[:, axis] - low) % length
        near = (places[:, axis] - reach[of] < low, places[:, axis] + reach[of] > low + length)
        moved = [places, *(places[at] for at in near)]
        for shift, part in zip((length, -length), moved[1:], strict=True):
            part[:, axis] += shift
        places, of = np.concatenate(moved), np.concatenate([of, *(of[at] for at in near)])
    return places, of


def to_nearest_image(d, period):
    """Distances d (n,), m, along an axis to the nearest image, where things repeat after `period`, m, or never, inf."""
    return d - period * np.rint(d / period) if math.isfinite(period) else d
