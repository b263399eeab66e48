"""A box: its table in a case, and what follows from it."""

import itertools
import math
from typing import Literal

import numpy as np
from pydantic import Field

from parsim.case.types import Size
from parsim.machine.compiled import compiled
from parsim.solid.shapes.samples import Samples
from parsim.solid.shapes.shape import ShapeTable

_SIGNS = np.array([[(c >> a & 1) * 2.0 - 1.0 for a in range(3)] for c in range(8)])  # corners
MOST = 1e6  # contact elements of a body
_QUADS = np.array([[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]])


class BoxShape(ShapeTable):
    """A box about its centre."""

    NUMBER = 0

    kind: Literal["box"] = Field("box", description="a box")
    size: Size = Field(description="edge lengths (x, y, z) before turning, m; in 2D y = 1")

    @property
    def half(self):
        """Half edges (3,), m."""
        return tuple(0.5 * edge for edge in self.size)

    @property
    def volume(self):
        """Volume, m3."""
        return math.prod(self.size)

    def told(self):
        """See `ShapeTable`."""
        return f"shape.size = {list(self.size)}"

    def faults(self, planar):
        """See `ShapeTable`."""
        if planar and self.size[1] != 1.0:
            yield f"{self.told()}: y must be 1 in a 2D case"
        a, b, c = sorted(self.size)
        count = 0.0 if planar else 2.0 * (a * b + b * c + c * a) / a**2
        if count > MOST:
            yield (
                f"{self.told()}: contact elements, as far apart as its thinnest edge, would be {count:.3g}; at most "
                f"{MOST:.3g}"
            )

    def radius(self, planar):
        """See `ShapeTable`; the metre across a plane turns with nothing."""
        return float(np.sqrt((np.array(self.half)[[0, 2] if planar else [0, 1, 2]] ** 2).sum()))

    def reach(self, direction):
        """See `ShapeTable`."""
        return reach(direction, self.half)

    def inertia(self, mass):
        """See `ShapeTable`."""
        square = [h * h for h in self.half]
        return [mass / 3.0 * (square[(a + 1) % 3] + square[(a + 2) % 3]) for a in range(3)]

    def away(self, points):
        """See `ShapeTable`."""
        over = np.abs(points) - self.half
        return np.linalg.norm(np.maximum(over, 0.0), axis=1) + np.minimum(over.max(axis=1), 0.0)

    def afloat(self, share, up=(0.0, 0.0, 1.0)):
        """See `ShapeTable`; exact where a face is level."""
        for axis in range(3):
            if abs(up[axis]) > 1.0 - 1e-12:
                return self.half[axis] - self.size[axis] * share
        return super().afloat(share, up)

    def surface(self):
        """See `ShapeTable`."""
        return _SIGNS * np.array(self.half), _QUADS

    def elements(self, planar, spacing=None):
        """See `ShapeTable`: on corners, on edges, and between at most `spacing`, m, apart; in 2D on the outline.

        Left out, the spacing is the smallest edge; there are at least three elements along each edge. Two faces that
        overlap share a corner of one of them, or cross like bars: elements no farther apart than the smallest edge
        always feel it.
        """
        half, used = np.array(self.half), [0, 2] if planar else [0, 1, 2]
        wanted = spacing or 2.0 * min(half[used])
        counts = [max(math.ceil(2.0 * h / wanted - 1e-9), 2) if a in used else 0 for a, h in enumerate(half)]
        lines = [np.linspace(-h, h, n + 1) if n else np.zeros(1) for h, n in zip(half, counts, strict=True)]
        shares = [_shares(h, n) for h, n in zip(half, counts, strict=True)]
        grid = np.stack(np.meshgrid(*lines, indexing="ij"), -1).reshape(-1, 3)
        share = np.stack(np.meshgrid(*shares, indexing="ij"), -1).reshape(-1, 3)
        area = np.zeros_like(grid)
        for a in used:
            on_face = np.abs(grid[:, a]) == half[a]
            side = np.sign(grid[:, a]) * share[:, (a + 1) % 3] * share[:, (a + 2) % 3]
            area[:, a] = np.where(on_face, side, 0.0)
        surface = np.any(area != 0.0, axis=1)
        cell = [2.0 * h / max(n, 1) for h, n in zip(half, counts, strict=True)]
        return np.hstack([grid, area])[surface], cell

    def number_of_samples(self, spacing, depth, planar):
        """See `ShapeTable`."""
        every, inner = 1, 1
        for edge in (self.size[a] for a in ((0, 2) if planar else (0, 1, 2))):
            count = max(1, round(edge / spacing))
            outside = min(math.ceil(depth / edge * count - 0.5), (count + 1) // 2)  # of a line, from one end
            every, inner = every * count, inner * max(count - 2 * outside, 0)
        return every - inner

    def samples(self, spacing, depth, planar):
        """See `ShapeTable`: a grid, even along each edge."""
        half, used = np.array(self.half), [0, 2] if planar else [0, 1, 2]
        counts = np.array([max(round(2.0 * h / spacing), 1) if a in used else 1 for a, h in enumerate(half)])
        axes = [((np.arange(n) + 0.5) / n * 2.0 - 1.0) * h for n, h in zip(counts, half, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
        offsets = grid[np.min(half[used] - np.abs(grid[:, used]), axis=1) < depth]
        share = math.prod(2.0 * half[a] / counts[a] / spacing for a in used)
        sides = [(a, sign) for a, sign in itertools.product(used, (-1, 1))]
        outer = [np.abs(sign * offsets[:, a] / half[a] - (1.0 - 1.0 / counts[a])) < 1e-9 for a, sign in sides]
        patches = [self._side(offsets, counts, side, dict(zip(sides, outer, strict=True))) for side in sides]
        return Samples(offsets, np.full(len(offsets), share), *map(np.concatenate, zip(*patches, strict=True)))

    def _side(self, offsets, counts, side, outer):
        """Of the patches of one side: see `Samples`."""
        (a, sign), half = side, self.half
        at = np.flatnonzero(outer[side])
        rim = np.any([layer[at] for (b, _), layer in outer.items() if b != a], axis=0)
        place, normal = offsets[at].copy(), np.zeros((at.size, 3))
        place[:, a], normal[:, a] = sign * half[a], sign
        area = math.prod(2.0 * half[b] / counts[b] for b in dict.fromkeys(b for b, _ in outer) if b != a)
        return at, np.full(at.size, 2 * a + (sign > 0)), rim, place, normal, np.full(at.size, area)


def _shares(half, count):
    """Lengths that the points of one line stand for: halves at its ends."""
    if not count:
        return np.array([2.0 * half])
    share = np.full(count + 1, 2.0 * half / count)
    share[[0, -1]] *= 0.5
    return share


@compiled
def distance(p, half, planar):
    """See `kernels.distance`."""
    x, z = abs(p[0]) - half[0], abs(p[2]) - half[2]
    y = -math.inf if planar else abs(p[1]) - half[1]
    deepest = max(x, y, z)
    if deepest <= 0.0:
        if x == deepest:
            return x, (1.0 if p[0] > 0.0 else -1.0, 0.0, 0.0)
        if y == deepest:
            return y, (0.0, 1.0 if p[1] > 0.0 else -1.0, 0.0)
        return z, (0.0, 0.0, 1.0 if p[2] > 0.0 else -1.0)
    x, y, z = max(x, 0.0), max(y, 0.0), max(z, 0.0)
    length = math.sqrt(x * x + y * y + z * z)
    scale = 1.0 / length
    x, y, z = x if p[0] > 0.0 else -x, y if p[1] > 0.0 else -y, z if p[2] > 0.0 else -z
    return length, (x * scale, y * scale, z * scale)


@compiled
def ahead(p, n, half, behind):
    """See `kernels.ahead`."""
    enter, leave = -behind, math.inf
    for a in range(3):
        if abs(n[a]) < 1e-12:
            if abs(p[a]) > half[a]:
                return math.inf
            continue
        t0, t1 = (-half[a] - p[a]) / n[a], (half[a] - p[a]) / n[a]
        enter, leave = max(enter, min(t0, t1)), min(leave, max(t0, t1))
    return enter if enter <= leave else math.inf


@compiled
def reach(d, half):
    """See `kernels.reach`."""
    return half[0] * abs(d[0]) + half[1] * abs(d[1]) + half[2] * abs(d[2])


@compiled
def core(d, half, margin, planar):
    """See `kernels.core`."""
    x, y, z = half[0] - margin, 0.0 if planar else half[1] - margin, half[2] - margin
    return x if d[0] > 0.0 else -x, y if d[1] > 0.0 else -y, z if d[2] > 0.0 else -z


@compiled
def depth(p, d, half, ramp, lateral):
    """See `kernels.depth`."""
    deep, weight = math.inf, 1.0
    for i in range(3):
        if abs(d[i]) < lateral:
            weight = min(weight, 1.0 + (half[i] - abs(p[i])) / ramp)
        else:
            ahead = p[i] if d[i] > 0.0 else -p[i]
            if half[i] + ahead < 0.0:
                return 0.0, 0.0
            deep = min(deep, (half[i] - ahead) / abs(d[i]))
    return deep, max(weight, 0.0)
