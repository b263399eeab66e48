"""Made-up floes and water whose measures are known."""

import numpy as np

from parsim.geometry.rotation import from_angles, matrices
from parsim.solid.shapes.box import BoxShape
from parsim.solid.shapes.cylinder import CylinderShape
from parsim.solid.shapes.sphere import SphereShape


def box(*size):
    return BoxShape(size=size)


def cylinder(diameter, height):
    return CylinderShape(kind="cylinder", diameter=diameter, height=height)


def sphere(diameter):
    return SphereShape(kind="sphere", diameter=diameter)


def surfaces(*bodies):
    """Points, quads and owner of the faces of bodies: (shape, place), or with angles, degrees, or a quaternion."""
    points, quads, owners, first = [], [], [], 0
    for b, (shape, place, *turns) in enumerate(bodies):
        corners, faces = shape.surface()
        turn = np.array(turns[0] if turns else (0.0, 0.0, 0.0))
        (turn,) = matrices((turn if len(turn) == 4 else from_angles(turn))[None])
        points.append(corners @ turn.T + place)
        quads.append(faces + first)
        owners.append(np.full(len(faces), b))
        first += len(corners)
    return np.concatenate(points), np.concatenate(quads), np.concatenate(owners)


def still(spacing, low, high, rise=0.0, drive=9810.0, speed=0.5):
    """Frame of a lattice of water between corners (3,), its pressure of a level `rise`, m/m, up along x."""
    axes = [a + (np.arange(round((b - a) / spacing)) + 0.5) * spacing for a, b in zip(low, high, strict=True)]
    place = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    pressure = drive * (high[2] + rise * place[:, 0] - place[:, 2])
    velocity = np.zeros_like(place)
    velocity[:, 0] = speed
    return {"position": place, "velocity": velocity, "pressure": pressure, "class": np.zeros(len(place), np.uint8)}
