"""Points at which a body is sampled for the water, and the patches of its surface next to them."""

from typing import NamedTuple

import numpy as np


class Samples(NamedTuple):
    """Points at which a body is sampled for the water.

    offsets (n, 3), m; shares (n,), the volume of each over that of a lattice point. Of the patches of its surface, one
    for each sample of the outer layer and side it belongs to: sample (p,); face (p,), 2 axis + 1 of the direction in
    which it looks most, less 1 where that is downwards; rim (p,), whether water comes to the side there; place (p, 3),
    m, on the surface; normal (p, 3), outwards; area (p,), m2.
    """

    offsets: np.ndarray
    shares: np.ndarray
    sample: np.ndarray
    face: np.ndarray
    rim: np.ndarray
    place: np.ndarray
    normal: np.ndarray
    area: np.ndarray


def flat_samples(rings, deepest, spacing, depth):
    """`Samples` of a 2D body from the rings of its outline, whose innermost ends `deepest`, m, down."""
    rings = list(rings)
    width = deepest / len(rings)
    kept = [ring for k, ring in enumerate(rings) if (k + 0.5) * width < depth]
    outer = rings[0]
    normal, at = _upright(outer.normal), np.arange(len(outer.length))
    return Samples(
        _upright(np.concatenate([ring.points for ring in kept])),
        np.concatenate([ring.area for ring in kept]) / spacing**2,
        at,
        face_of(normal),
        np.ones(at.size, bool),
        _upright(outer.place),
        normal,
        outer.length,
    )


def stacked_samples(rings, deepest, height, spacing, depth):
    """`Samples` of a body that stands `height`, m, tall about its centre on the outline that has these rings."""
    rings = list(rings)
    width, layers = deepest / len(rings), max(round(height / spacing), 1)
    thick = height / layers
    offsets, shares, patches, first = [], [], [], 0
    for layer in range(layers):
        z = (layer + 0.5) * thick - 0.5 * height
        ends = [sign for sign, last in ((-1.0, layer == 0), (1.0, layer == layers - 1)) if last]
        for k, ring in enumerate(rings):
            if min((k + 0.5) * width, 0.5 * height - abs(z)) >= depth:
                continue
            count, flat = len(ring.area), np.zeros(len(ring.area))
            at, even = first + np.arange(count), np.ones(count)
            offsets.append(np.column_stack([ring.points, z * even]))
            shares.append(ring.area * thick / spacing**3)
            if k == 0:
                normal = np.column_stack([ring.normal, flat])
                rim = np.full(count, bool(ends))
                place = np.column_stack([ring.place, z * even])
                patches.append((at, face_of(normal), rim, place, normal, ring.length * thick))
            for sign in ends:
                normal = np.column_stack([flat, flat, sign * even])
                place = np.column_stack([ring.points, 0.5 * sign * height * even])
                patches.append((at, face_of(normal), np.full(count, k == 0), place, normal, ring.area))
            first += count
    return Samples(np.concatenate(offsets), np.concatenate(shares), *map(np.concatenate, zip(*patches, strict=True)))


def face_of(normal):
    """Faces (n,) of normals (n, 3): see `Samples`."""
    axis = np.abs(normal).argmax(axis=1)
    return 2 * axis + (normal[np.arange(len(normal)), axis] > 0.0)


def _upright(flat):
    """Points or directions (n, 2) of the x-z plane as (n, 3)."""
    return np.stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]], -1)
