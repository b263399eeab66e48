"""Where bodies are at the start: reach, distance and overlap of what is turned. Angles in degrees, lengths in m."""

from dataclasses import dataclass, field

import numpy as np

from parsim.solid.shapes import BoxShape, SphereShape
from parsim.solid.shapes.box import distance
from parsim.solid.shapes.meshed import Meshed

_WAYS, _ROUNDS = 64, 12  # directions tried at first, and around the best of them


@dataclass(frozen=True)
class Place:
    """A shape with its centre (3,), m, and axes (3, 3), whose columns are the directions of its own; grown by m."""

    centre: np.ndarray
    axes: np.ndarray
    shape: object
    grown_by: float = 0.0
    reach: np.ndarray = field(init=False)  # half extents along x, y and z, to the farther side, (3,), m

    def __post_init__(self):
        """Find how far it reaches."""
        both = [max(self.along(way), self.along(-way)) for way in np.eye(3)]
        object.__setattr__(self, "reach", np.array(both))

    @property
    def half(self):
        """Half edges (3,) of its box, m."""
        return np.array(self.shape.half) + self.grown_by

    def along(self, way):
        """How far it reaches along a unit vector (3,) from its centre, m."""
        return self.shape.reach(self.axes.T @ way) + self.grown_by

    def low(self):
        """Lowest corner (3,) of the upright box around it, m."""
        return self.centre - [self.along(-way) for way in np.eye(3)]

    def high(self):
        """Highest corner (3,) of the upright box around it, m."""
        return self.centre + [self.along(way) for way in np.eye(3)]

    def grown(self, by):
        """The same with its surface moved outwards by `by`, m."""
        return Place(self.centre, self.axes, self.shape, self.grown_by + by)


def rotation(angles):
    """Matrix (3, 3) that turns about the fixed x, then y, then z axis by `angles` (3,), degrees."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def of_body(body):
    """The place that a body of a case takes."""
    w, *v = body.shape.turn
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    own = np.eye(3) + 2.0 * (w * cross + cross @ cross)
    return Place(np.array(body.position), rotation(body.angles) @ own, body.shape)


def clearance(place, points):
    """Distance (n,) of points (n, 3) from a body, m; 0 inside."""
    local = (points - place.centre) @ place.axes
    return np.maximum(place.shape.away(local) - place.grown_by, 0.0)


def upright(low, high):
    """The box between the corners `low` and `high`, (3,)."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    return Place((low + high) / 2, np.eye(3), BoxShape.model_construct(size=tuple(high - low)))


def overlap(first, second, shift=(0.0, 0.0, 0.0)):
    """Least depth, m, by which `first` enters `second` moved by `shift`; 0 or less when they are apart or touch."""
    between = second.centre + np.asarray(shift) - first.centre
    if isinstance(first.shape, Meshed) or isinstance(second.shape, Meshed):
        return _deepest(first, second, between)
    kinds = [type(place.shape) for place in (first, second)]
    if SphereShape in kinds:
        ball, other, way = (first, second, -between) if kinds[0] is SphereShape else (second, first, between)
        if type(other.shape) is SphereShape:
            return float(first.half[0] + second.half[0] - np.linalg.norm(between))
        if type(other.shape) is BoxShape:
            high, _ = distance(other.axes.T @ way, other.half, False)
            return float(ball.half[0] - high)
    elif kinds == [BoxShape] * 2:
        return _overlap_of_boxes(first, second, between)
    return -_separation(first, second, between)


def apart(first, second, shift=(0.0, 0.0, 0.0)):
    """Whether the line between their centres, or a face of one, shows that they do not overlap; else they may."""
    shapes = first.shape, second.shape
    if any(shape.FLAT or isinstance(shape, Meshed) for shape in shapes):
        return False
    between = second.centre + np.asarray(shift) - first.centre
    faces = np.concatenate([place.shape.normals() @ place.axes.T for place in (first, second)])
    ways = np.concatenate([[between / max(np.linalg.norm(between), 1e-300)], faces * np.sign(faces @ between)[:, None]])
    order = np.argsort(-(ways @ between), kind="stable")
    return any(ways[k] @ between >= first.along(ways[k]) + second.along(-ways[k]) for k in order if ways[k].any())


def _deepest(first, second, between):
    """How deep any point of one body's surface lies in the other, m."""
    deep = []
    for one, other, way in ((first, second, between), (second, first, -between)):
        points = one.shape.surface()[0] if one.shape.ROUND else one.shape.elements(False)[0][:, :3]
        deep.append(-other.shape.away((points @ one.axes.T - way) @ other.axes).min())
    return float(max(deep)) + first.grown_by + second.grown_by


def _overlap_of_boxes(first, second, between):
    """Separating axes (Gottschalk, Lin & Manocha 1996): three of each box and their nine cross products."""
    crosses = np.cross(first.axes.T[:, None, :], second.axes.T[None, :, :]).reshape(9, 3)
    lengths = np.linalg.norm(crosses, axis=1)
    directions = np.vstack([first.axes.T, second.axes.T, crosses[lengths > 1e-9] / lengths[lengths > 1e-9, None]])
    reach = np.abs(directions @ first.axes) @ first.half + np.abs(directions @ second.axes) @ second.half
    return float(np.min(reach - np.abs(directions @ between)))


def _separation(first, second, between):
    """How far two convex bodies are apart along the direction along which they are farthest apart, m.

    Sought from the faces and the centres on, then ever closer around the best: that has no second maximum.
    """

    def apart(way):
        return float(between @ way) - first.along(way) - second.along(-way)

    dice = np.random.default_rng(0)
    flat = first.shape.FLAT or second.shape.FLAT
    ways = [between, *dice.normal(size=(_WAYS, 3))]
    for place in (first, second):
        ways += [sign * place.axes @ normal for normal in place.shape.normals() for sign in (1.0, -1.0)]
    best, most = None, -np.inf
    for width in [None, *0.3 ** np.arange(_ROUNDS)]:
        tried = ways if width is None else best + width * dice.normal(size=(24, 3))
        for way in tried:
            way = way * (1.0, 0.0, 1.0) if flat else way
            length = np.linalg.norm(way)
            if length > 1e-12 and (gap := apart(way / length)) > most:
                best, most = way / length, gap
    return most


def near_pairs(boxes, period=(np.inf, np.inf, np.inf)):
    """Yield (i, j, shift) of boxes whose extents overlap, j > i; `shift` moves j to its nearest periodic image.

    In the order of i, then j. Each looks at those that begin within its reach along the axis that spreads them most.
    """
    centres = np.array([box.centre for box in boxes]).reshape(-1, 3)
    reaches = np.array([box.reach for box in boxes]).reshape(-1, 3)
    period = np.asarray(period)
    length = np.where(np.isfinite(period), period, 0.0)
    axis = int(np.argmax(np.where(np.isfinite(period), -1.0, np.ptp(centres, axis=0)))) if len(boxes) else 0
    order = np.argsort(centres[:, axis])
    span = reaches[:, axis] + reaches[:, axis].max(initial=0.0)
    ends = np.searchsorted(centres[order, axis], centres[:, axis] + [[-1.0], [1.0]] * span)
    for i, (low, high) in enumerate(ends.T):
        others = np.sort(order[low:high])
        others = others[others > i]
        between = centres[others] - centres[i]
        shifts = -length * np.round(between / period)
        near = np.all(np.abs(between + shifts) < reaches[others] + reaches[i], axis=1)
        for j, shift in zip(others[near].tolist(), shifts[near], strict=True):
            yield i, j, shift
