"""Surfaces for the tests of meshes, and their files."""

import numpy as np
import trimesh

SIZE = (0.08, 0.06, 0.04)


def written(folder, surface, name="a.stl"):
    """The path of a surface in a file."""
    surface.export(folder / name)
    return folder / name


def box_of(size=SIZE, at=(0.0, 0.0, 0.0)):
    """A box as a mesh."""
    surface = trimesh.creation.box(size)
    surface.apply_translation(at)
    return surface


def hollow():
    """A tray: a box with a pit from above, 0.12 x 0.12 x 0.05 m, its walls and its floor 0.02 m thick."""
    ring = [[-0.06, -0.06], [0.06, -0.06], [0.06, 0.06], [-0.06, 0.06]]
    inner = [[x * 2 / 3, y * 2 / 3] for x, y in ring]
    points = np.array(
        [
            [*p, z]
            for p, z in [(p, 0.0) for p in ring]
            + [(p, 0.05) for p in ring]
            + [(p, 0.05) for p in inner]
            + [(p, 0.02) for p in inner]
        ]
    )
    faces = [(0, 2, 1), (0, 3, 2), (12, 13, 14), (12, 14, 15)]
    for k in range(4):
        n = (k + 1) % 4
        faces += [(k, n, 4 + n), (k, 4 + n, 4 + k), (4 + k, 4 + n, 8 + n), (4 + k, 8 + n, 8 + k)]
        faces += [(8 + k, 8 + n, 12 + n), (8 + k, 12 + n, 12 + k)]
    return trimesh.Trimesh(points, faces, process=False)
