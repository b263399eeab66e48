"""Where the water stands at the start: lattices in boxes, less bodies and gate, true to the volume of water.

Gaps narrower than the spacing hold no particle, and a body's underside need not lie on a lattice plane. Hence the
space that bodies take is measured finely, and as many lattice points are left out as fill it, those deepest inside
the bodies first, whole rows thinned evenly.
"""

import numpy as np

from parsim.solid.rotation import matrices

_FINE = 4  # measuring points per spacing and axis
_OPPOSITE = -0.9  # cosine below which two outward directions face each other across a gap


def lattice(low, high, spacing, axes):
    """Even lattice points (n, 3) in a box with about the spacing; the other axis keeps its middle."""
    rows = []
    for axis in range(3):
        length = high[axis] - low[axis]
        count = max(round(length / spacing), 1) if axis in axes else 1
        rows.append(low[axis] + (np.arange(count) + 0.5) * (length / count))
    return np.stack(np.meshgrid(*rows, indexing="ij"), -1).reshape(-1, 3)


def outside_box(points, centre, turn, half, axes):
    """Signed distance (n,) to a turned box, m, and the outward direction (n, 3)."""
    local = (points - centre) @ turn
    over = np.abs(local) - half
    over[:, [a for a in range(3) if a not in axes]] = -np.inf
    beyond = np.maximum(over, 0.0)
    distance = np.sqrt((beyond**2).sum(axis=1)) + np.minimum(over.max(axis=1), 0.0)
    direction = np.sign(local) * beyond
    length = np.sqrt((direction**2).sum(axis=1))
    return distance, (direction / np.where(length > 0, length, 1.0)[:, None]) @ turn.T


def plane_distances(points, case):
    """Distance (n,) and direction into the water (3,) of each wall and gate face that stands beside the points."""
    for axis, name in enumerate("xyz"):
        if axis not in case.axes:
            continue
        for side, place, sign in (("min", case.box.min[axis], 1.0), ("max", case.box.max[axis], -1.0)):
            if getattr(case.box.faces, f"{name}_{side}") == "wall":
                yield sign * (points[:, axis] - place), sign * np.eye(3)[axis]
    if case.gate is not None:
        for place, sign in ((case.gate.min_x, -1.0), (case.gate.max_x, 1.0)):
            distance = sign * (points[:, 0] - place)
            yield np.where(distance >= 0, distance, np.inf), sign * np.eye(3)[0]


def solids(points, case, bodies):
    """Distance to the nearest body (n,) and whether a point is in a body or in a gap narrower than the spacing."""
    found = [outside_box(points, centre, turn, half, case.axes)
             for centre, turn, half in zip(bodies.position, matrices(bodies.quaternion), bodies.half, strict=True)]
    nearest = np.min([distance for distance, _ in found], axis=0)
    taken = nearest <= 0.0
    others = found + [(d, np.broadcast_to(v, points.shape)) for d, v in plane_distances(points, case)]
    for k, (distance, direction) in enumerate(found):
        close = np.flatnonzero(~taken & (distance < case.spacing))
        for other, facing in others[k + 1 :]:
            cosine = (direction[close] * facing[close]).sum(axis=1)
            taken[close] |= (distance[close] + other[close] < case.spacing) & (cosine < _OPPOSITE)
    return nearest, taken


def scatter(index):
    """A fixed shuffle: a well-mixed 64-bit number of each index (splitmix64 of Steele, Lea & Flood 2014)."""
    with np.errstate(over="ignore"):
        z = (np.asarray(index).astype(np.uint64) + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return z ^ (z >> np.uint64(31))


def free_of_bodies(points, spacing, case, bodies):
    """Which lattice points (n, 3) stay water: bool (n,). `spacing` (3,) is that of the lattice, m."""
    if not len(bodies.mass) or not len(points):
        return np.ones(len(points), bool)
    nearest, taken = solids(points, case, bodies)
    near = np.flatnonzero(nearest < case.spacing)
    volume = 0.0
    fine = (np.arange(_FINE) + 0.5) / _FINE - 0.5
    steps = [fine * spacing[a] if a in case.axes else np.zeros(1) for a in range(3)]
    for offset in np.stack(np.meshgrid(*steps, indexing="ij"), -1).reshape(-1, 3):
        volume += solids(points[near] + offset, case, bodies)[1].mean() * near.size if near.size else 0.0
    count = round(volume / _FINE ** len(case.axes))
    depth = np.where(taken, np.minimum(nearest, -1e-9 * case.spacing), nearest)[near]
    depth = np.round(depth / case.spacing, 6)  # points of one lattice plane are equally deep
    order = near[np.lexsort((scatter(near), depth))]
    stays = np.ones(len(points), bool)
    stays[order[:count]] = False
    return stays
