"""The shapes of bodies as arrays, for kernels."""

from typing import NamedTuple

import numpy as np

from parsim.solid.shapes.meshed import flat
from parsim.solid.shapes.polygon import MARGIN


class Forms(NamedTuple):
    """Of b bodies: shape (b,), its NUMBER; half (b, 3), m, half edges of the box around it; margin (b,), m, by which
    its core is smaller; sides[first[b]:first[b + 1]], those of the polygon that it is in a plane: outward normal,
    offset, start, length, and corner of the core, eight numbers. planar: of a 2D case, without ends along y. field
    (n,), m: signed distances of meshes at the nodes of their grids (b, 8), see `meshed.flat`; alike ones share them."""

    shape: np.ndarray
    half: np.ndarray
    margin: np.ndarray
    first: np.ndarray
    sides: np.ndarray
    planar: bool
    field: np.ndarray
    grid: np.ndarray


def forms_of(shapes, planar, plates=()):
    """`Forms` of bodies with these shapes, then of upright boxes with these half edges (3,), m."""
    count, each = len(shapes) + len(plates), [shape.sides() for shape in shapes]
    half = np.array([*(shape.half for shape in shapes), *plates], float).reshape(-1, 3)
    number, margin = (
        np.zeros(count, np.int64),
        MARGIN * half[:, [0, 2] if planar else [0, 1, 2]].min(axis=1, initial=np.inf),
    )
    number[: len(shapes)] = [shape.NUMBER for shape in shapes]
    margin[: len(shapes)] = [MARGIN * shape.thinnest(planar) for shape in shapes]
    first = np.zeros(count + 1, np.int64)
    first[1 : len(shapes) + 1] = np.cumsum([len(rows) for rows in each])
    first[len(shapes) + 1 :] = first[len(shapes)]
    return Forms(
        number, half, margin, first, np.concatenate([np.zeros((0, 8)), *each]), bool(planar), *_fields(shapes, count)
    )


def _fields(shapes, count):
    """The fields of all meshes, one after the other, and the grids (count, 8) of all bodies."""
    values, grids, begins, at = [np.zeros(0)], np.zeros((count, 8)), {}, 0
    for b, shape in enumerate(shapes):
        if shape.field is None:
            continue
        its, grids[b] = flat(shape.field)
        if shape not in begins:
            begins[shape], at = at, at + len(its)
            values.append(its)
        grids[b, 0] = begins[shape]
    return np.concatenate(values), grids


def reordered(forms, order):
    """The same of these bodies alone, in this order (n,)."""
    each = [forms.sides[forms.first[b] : forms.first[b + 1]] for b in order]
    first = np.cumsum([0, *map(len, each)])
    sides = np.concatenate([np.zeros((0, 8)), *each])
    own = (forms.shape[order], forms.half[order], forms.margin[order])
    return Forms(*own, first, sides, forms.planar, forms.field, forms.grid[order])
