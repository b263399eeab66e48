"""Closed surfaces of triangles from files: read, checked, and what follows from them."""

from typing import NamedTuple

import meshio
import numpy as np
import trimesh

from parsim.errors import InputError

FORMATS = ("stl", "obj", "ply", "vtu")
_SOLID = {
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}  # sides of cells, anticlockwise seen from outside
_SURFACE, _LESS = ("triangle", "quad"), ("vertex", "line")
_SHARPEST = 0.3  # cosine between corner and faces of a fold, beyond which shells become thinner there
_SAME = 1e-9  # of its size, by which corners may differ that are one


class Mesh(NamedTuple):
    """A closed surface about its centre of mass, in principal axes: points (k, 3), m; triangles (n, 3) of them,
    anticlockwise seen from outside; volume, m3; moments (3,), m5, of the volume about the axes; turn: quaternion (4,)
    from these axes to those of the file; centre (3,), m, in the file."""

    points: np.ndarray
    triangles: np.ndarray
    volume: float
    moments: np.ndarray
    turn: tuple
    centre: np.ndarray


def read(path, scale, thickness=None):
    """`Mesh` of a file, its lengths times `scale`; with a `thickness`, m, that of the `shell` along its open surface.

    Raises InputError where it cannot be read, or is not closed, or is although it is to become a shell.
    """
    kind = path.suffix[1:].lower()
    if kind not in FORMATS:
        raise InputError(f"{path}: a mesh is a file of the kinds {', '.join(FORMATS)}")
    try:
        points, triangles = _of_cells(path) if kind == "vtu" else _of_surface(path, kind)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (OSError, ValueError, KeyError, IndexError, TypeError, SystemExit) as error:
        raise InputError(f"{path}: cannot be read as {kind}: {error}") from None
    if not np.isfinite(points).all():
        raise InputError(f"{path}: holds what is no number")
    size = scale * np.ptp(points, axis=0).max() if len(triangles) else 0.0
    if size > 0.0:
        points, triangles = joined(scale * points, triangles, _SAME * size)
    if size == 0.0 or not len(triangles):
        raise InputError(f"{path}: holds no triangles")
    if thickness is not None:
        points, triangles = _thickened(points, triangles, thickness, path)
    return _placed(points, triangles, path)


def _of_surface(path, kind):
    with path.open("rb") as file:
        surface = trimesh.load(file, file_type=kind, process=False, force="mesh")
    return np.array(surface.vertices, float), np.array(surface.faces, int)


def _of_cells(path):
    """Of solid cells the sides that only one has, or surface cells where there are none, as triangles."""
    mesh = meshio.read(path)
    strange = sorted({cells.type for cells in mesh.cells} - {*_SOLID, *_SURFACE, *_LESS})
    if strange:
        raise InputError(f"{path}: has cells of the kind {strange[0]}; allowed are {', '.join((*_SURFACE, *_SOLID))}")
    solid, out = [cells for cells in mesh.cells if cells.type in _SOLID], [np.zeros((0, 3), int)]
    sides = [cells.data[:, corners] for cells in solid for corners in _SOLID[cells.type]]
    sides = sides or [cells.data for cells in mesh.cells if cells.type in _SURFACE]
    for width in {each.shape[1] for each in sides}:
        every = np.concatenate([each for each in sides if each.shape[1] == width])
        _, first, count = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
        every = every[np.sort(first[count == 1])]
        out += [every[:, [0, k, k + 1]] for k in range(1, width - 1)]
    return np.array(mesh.points, float), np.concatenate(out)


def joined(points, triangles, within):
    """The same with corners that are `within` a distance, m, made one, and without triangles that have lost a side."""
    _, first, same = np.unique(np.round(points / within), axis=0, return_index=True, return_inverse=True)
    triangles = same.reshape(-1)[triangles]
    whole = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return points[first], triangles[whole]


def _thickened(points, triangles, thickness, path):
    edges, _, count = _edges(triangles)
    if not (count == 1).any():
        raise InputError(f"{path}: is closed; leave shape.thickness out, which makes a shell of an open surface")
    return shell(points, triangles, thickness)


def _edges(triangles):
    """Edges (3 n, 2) of triangles (n, 3); which of those there are without regard to their sense each is, (3 n,); and
    how many triangles have each of them."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    _, inverse, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    return edges, inverse.reshape(-1), count


def shell(points, triangles, thickness):
    """Points and triangles of the closed shell of a thickness, m, half of it on either side of an open surface.

    Corners go along the mean normal of the triangles at them, so far that flat faces keep the thickness.
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)
    normals, mean = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-300), np.zeros_like(points)
    for k in range(3):
        np.add.at(mean, triangles[:, k], area)
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-300)
    lean, many = np.zeros(len(points)), np.zeros(len(points))
    for k in range(3):
        np.add.at(lean, triangles[:, k], (normals * mean[triangles[:, k]]).sum(axis=1))
        np.add.at(many, triangles[:, k], 1.0)
    away = 0.5 * thickness * mean / np.maximum(lean / np.maximum(many, 1.0), _SHARPEST)[:, None]
    edges, inverse, count = _edges(triangles)
    rim, under = edges[count[inverse] == 1], len(points)
    first, second = rim[:, 0], rim[:, 1]
    sides = [np.stack([second, first, first + under], 1), np.stack([second, first + under, second + under], 1)]
    faces = np.concatenate([triangles, triangles[:, ::-1] + under, *sides])
    return np.concatenate([points + away, points - away]), faces


def _placed(points, triangles, path):
    edges, inverse, count = _edges(triangles)
    there, back = np.zeros(len(count), int), np.zeros(len(count), int)
    np.add.at(there, inverse, edges[:, 0] < edges[:, 1])
    np.add.at(back, inverse, edges[:, 0] > edges[:, 1])
    if (count == 1).any():
        raise InputError(
            f"{path}: is open: {int((count == 1).sum())} of {len(count)} edges belong to one triangle only, the first "
            f"at {_at(points, edges, inverse, int(np.argmax(count == 1)))} m; close its holes, or give "
            "shape.thickness to make a shell of it"
        )
    if (there != back).any():
        raise InputError(
            f"{path}: some of its triangles look in, others out: they disagree at {int((there != back).sum())} of "
            f"{len(count)} edges, first at {_at(points, edges, inverse, int(np.argmax(there != back)))} m; make its "
            "normals consistent"
        )
    if (count > 2).any():
        raise InputError(
            f"{path}: {int((count > 2).sum())} of {len(count)} edges belong to more than two triangles, the first at "
            f"{_at(points, edges, inverse, int(np.argmax(count > 2)))} m; its pieces may not touch"
        )
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    points = points - middle  # far from the origin moments would be differences of large numbers
    a, b, c = (points[triangles[:, k]] for k in range(3))
    volume = float((a * np.cross(b, c)).sum() / 6.0)
    if volume < 0.0:
        raise InputError(f"{path}: its faces are turned in, its volume is {volume:.4g} m3; flip its normals")
    if not volume > 1e-12 * np.ptp(points, axis=0).max() ** 3:
        raise InputError(f"{path}: has no volume")
    surface = trimesh.Trimesh(points, triangles, process=False)
    centre = np.array(surface.center_mass)
    moments, axes = np.linalg.eigh(_exact_zeros(np.array(surface.moment_inertia)))
    axes = _nearest_axes(axes)
    moments = np.array([axes[:, k] @ surface.moment_inertia @ axes[:, k] for k in range(3)])
    return Mesh((points - centre) @ axes, triangles, volume, moments, _quaternion(axes), centre + middle)


def _exact_zeros(tensor):
    """The tensor (3, 3) without what is rounding, so that bodies whose axes are principal are not turned."""
    return np.where(np.abs(tensor) < 1e-9 * np.trace(tensor), 0.0, tensor)


def _nearest_axes(axes):
    """Principal axes, columns (3, 3), in the order and with the signs that are nearest to x, y and z, right-handed."""
    order, left = [], [0, 1, 2]
    for k in range(3):
        best = max(left, key=lambda c: (round(abs(axes[k, c]), 9), -c))
        order.append(best)
        left.remove(best)
    axes = axes[:, order]
    axes = axes * np.where(np.diag(axes) < 0.0, -1.0, 1.0)
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return axes


def _quaternion(turn):
    """Quaternion (4,) of a rotation matrix (3, 3)."""
    whole = np.eye(4)
    whole[:3, :3] = turn
    return tuple(float(v) for v in trimesh.transformations.quaternion_from_matrix(whole, isprecise=True))


def _at(points, edges, inverse, edge):
    """Middle of an edge, as text."""
    row = int(np.argmax(inverse == edge))
    return "(" + ", ".join(f"{v:.4g}" for v in points[edges[row]].mean(axis=0)) + ")"
