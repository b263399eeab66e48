"""Shapes of bodies: what exists is listed here, in the order of their numbers; to kernels a bed is a mesh."""

import functools

import numpy as np

from parsim.case.types import choice
from parsim.solid.shapes.bed import BedShape
from parsim.solid.shapes.box import BoxShape
from parsim.solid.shapes.cylinder import CylinderShape
from parsim.solid.shapes.dilated_disc import DilatedDiscShape
from parsim.solid.shapes.disc import DiscShape
from parsim.solid.shapes.mesh import MeshShape
from parsim.solid.shapes.polygon import PolygonShape
from parsim.solid.shapes.prism import PrismShape
from parsim.solid.shapes.sphere import SphereShape

SHAPES = (BoxShape, SphereShape, DiscShape, PolygonShape, CylinderShape, PrismShape, DilatedDiscShape, MeshShape)
Shape = choice(*SHAPES, BedShape)


def elements_of(bodies, spacing=None):
    """Contact elements, the points that feel what a body touches, each with its share of area, on all bodies.

    Returns first (nb + 1,): the elements of body b are rows first[b] to first[b + 1]; elements (n, 6): point, m, body
    frame, and its share of the face along each body axis, m2, signed as the face looks: the area seen along a
    direction d is the sum of max(0, area d) over the axes; cell (nb, 3), m, the distances between elements.
    """
    made = functools.cache(lambda shape: shape.elements(bodies.planar, spacing))
    parts = [made(shape) for shape in bodies.shapes]
    first = np.cumsum([0, *(len(part) for part, _ in parts)])
    elements = np.concatenate([np.zeros((0, 6)), *(part for part, _ in parts)])
    return first, elements, np.array([cell for _, cell in parts], float).reshape(-1, 3)
