"""Files of meshes: what is read, what follows from it, and what is refused."""

import meshio
import numpy as np
import pytest
import trimesh
from mesh_cases import SIZE, box_of, written

from parsim.errors import InputError
from parsim.geometry.mesh import read
from parsim.geometry.rotation import matrices
from parsim.solid.shapes import BoxShape, MeshShape


@pytest.mark.parametrize("name", ["a.stl", "a.ply", "a.obj"])
def test_a_box_is_a_box_whatever_the_file(tmp_path, name):
    """About its centre, though the file has it elsewhere."""
    shape, box = (
        MeshShape(kind="mesh", file=str(written(tmp_path, box_of(at=(1.0, 2.0, 3.0)), name))),
        BoxShape(size=SIZE),
    )
    assert shape.volume == pytest.approx(box.volume, rel=1e-5)
    assert shape.half == pytest.approx(box.half, rel=1e-5)
    assert shape.inertia(2.0) == pytest.approx(box.inertia(2.0), rel=1e-5)
    assert shape.turn == pytest.approx((1.0, 0.0, 0.0, 0.0))
    assert shape.draught(500.0, 1000.0) == pytest.approx(0.02, rel=1e-5)
    assert shape.reach((0.0, 0.6, 0.8)) == pytest.approx(0.6 * 0.03 + 0.8 * 0.02, rel=1e-5)


def test_cells_of_a_solid_are_their_skin(tmp_path):
    """Two hexahedra with a face between them, in millimetres."""
    points = np.array([(x, y, z) for x in (0, 10, 20) for y in (0, 10) for z in (0, 10)], float)
    cells = [[0, 4, 6, 2, 1, 5, 7, 3], [4, 8, 10, 6, 5, 9, 11, 7]]
    meshio.Mesh(points, [("hexahedron", np.array(cells))]).write(tmp_path / "a.vtu")
    mesh = read(tmp_path / "a.vtu", 0.001)
    assert mesh.volume == pytest.approx(2e-6) and len(mesh.triangles) == 20
    assert np.ptp(mesh.points, axis=0) == pytest.approx((0.02, 0.01, 0.01))
    assert mesh.centre == pytest.approx((0.01, 0.005, 0.005))


def test_what_is_turned_in_its_file_stands_in_principal_axes(tmp_path):
    surface = box_of()
    surface.apply_transform(trimesh.transformations.euler_matrix(0.3, -0.2, 0.4))
    mesh = read(written(tmp_path, surface, "a.ply"), 1.0)
    assert np.abs(mesh.points).max(axis=0) == pytest.approx((0.04, 0.03, 0.02), rel=1e-5)
    turn = matrices(np.array([mesh.turn]))[0]
    back = mesh.points @ turn.T + mesh.centre
    assert np.abs(np.sort(back, axis=0) - np.sort(surface.vertices, axis=0)).max() < 1e-7
    assert mesh.moments == pytest.approx(np.array(BoxShape(size=SIZE).inertia(1.0)) * mesh.volume, rel=1e-5)


def _open():
    surface = box_of()
    surface.update_faces(np.arange(len(surface.faces)) > 1)
    return surface


def _turned_in():
    surface = box_of()
    surface.invert()
    return surface


def _mixed():
    surface = box_of()
    return trimesh.Trimesh(
        surface.vertices, [f[::-1] if k == 3 else f for k, f in enumerate(surface.faces)], process=False
    )


@pytest.mark.parametrize(("make", "said"), [
    (_open, "is open: 4 of 17 edges belong to one triangle only, the first at"),
    (_turned_in, "its faces are turned in, its volume is -0.000192 m3; flip its normals"),
    (_mixed, "some of its triangles look in, others out: they disagree at 3 of 18 edges"),
])  # fmt: skip
def test_what_is_no_solid_is_refused_with_the_remedy(tmp_path, make, said):
    with pytest.raises(InputError, match=said):
        read(written(tmp_path, make()), 1.0)


def sheet(size=(0.3, 0.2), cells=6, bend=0.0):
    """An open sheet, its half beyond the middle turned up by an angle, degrees."""
    x, y = (np.linspace(-0.5 * s, 0.5 * s, cells + 1) for s in size)
    at = np.array([(a, b) for a in x for b in y])
    up, turned = np.maximum(at[:, 0], 0.0), np.radians(bend)
    points = np.column_stack([np.minimum(at[:, 0], 0.0) + up * np.cos(turned), at[:, 1], up * np.sin(turned)])
    row = cells + 1
    corners = [(i * row + j, (i + 1) * row + j, (i + 1) * row + j + 1, i * row + j + 1)
               for i in range(cells) for j in range(cells)]  # fmt: skip
    return trimesh.Trimesh(points, [t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))], process=False)


def test_an_open_sheet_becomes_a_shell(tmp_path):
    mesh = read(written(tmp_path, sheet(), "a.ply"), 1.0, 0.02)
    assert mesh.volume == pytest.approx(0.3 * 0.2 * 0.02, rel=1e-6)
    assert np.ptp(mesh.points, axis=0) == pytest.approx((0.3, 0.2, 0.02), rel=1e-6)
    assert mesh.moments == pytest.approx(np.array(BoxShape(size=(0.3, 0.2, 0.02)).inertia(1.0)) * mesh.volume, rel=1e-5)


@pytest.mark.parametrize("bend", [20.0, 60.0, 90.0])
def test_a_shell_keeps_its_thickness_round_a_bend(tmp_path, bend):
    """The two faces are parallel: the mean surface, mitred, times the thickness."""
    mesh = read(written(tmp_path, sheet(bend=bend), "a.ply"), 1.0, 0.02)
    assert mesh.volume == pytest.approx(0.3 * 0.2 * 0.02, rel=1e-3)
    shape = MeshShape(kind="mesh", file=str(tmp_path / "a.ply"), thickness=0.02)
    assert not [*shape.faults(False)]
    assert shape.thinnest(False) == pytest.approx(0.01, rel=0.15)
    assert shape.samples(0.01, 0.05, False).shares.sum() * 0.01**3 == pytest.approx(mesh.volume, rel=1e-6)


def test_a_round_shell_is_as_thick_all_over(tmp_path):
    ball = trimesh.creation.icosphere(4, 0.1)
    half = ball.submesh([ball.triangles_center[:, 2] > 0.0], append=True)
    mesh = read(written(tmp_path, half, "a.ply"), 1.0, 0.01)
    assert mesh.volume == pytest.approx(half.area * 0.01, rel=0.01)


def test_only_an_open_surface_becomes_a_shell(tmp_path):
    with pytest.raises(InputError, match=r"a.stl: is closed; leave shape.thickness out"):
        read(written(tmp_path, box_of()), 1.0, 0.01)
    mixed = sheet()
    faces = np.array(mixed.faces)
    faces[7] = faces[7][::-1]
    with pytest.raises(InputError, match="some of its triangles look in, others out"):
        read(written(tmp_path, trimesh.Trimesh(mixed.vertices, faces, process=False), "b.ply"), 1.0, 0.01)
    with pytest.raises(InputError, match=r"close its holes, or give shape.thickness to make a shell of it"):
        read(written(tmp_path, sheet(), "c.ply"), 1.0)


@pytest.mark.parametrize(("name", "text", "said"), [
    ("a.step", "", "a mesh is a file of the kinds stl, obj, ply, vtu"),
    ("a.stl", "solid\nnothing", "cannot be read as stl|holds no triangles"),
    ("a.ply", "ply\nrubbish", "cannot be read as ply"),
    ("a.vtu", "<xml", "cannot be read as vtu"),
    ("a.obj", "", "cannot be read as obj|holds no triangles"),
])  # fmt: skip
def test_what_is_no_mesh_is_refused(tmp_path, name, text, said):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=said):
        read(tmp_path / name, 1.0)
    with pytest.raises(InputError, match="no such file"):
        read(tmp_path / "b.stl", 1.0)


@pytest.mark.parametrize("offset", [1e3, 1e5, 5e6])
def test_a_mesh_may_lie_far_from_its_origin(tmp_path, offset):
    """As from a map; its file has nine decimals."""
    file = tmp_path / "far.obj"
    surface = box_of((0.8, 0.6, 0.4), (offset, 2.0 * offset, 0.1 * offset))
    lines = [f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in surface.vertices]
    file.write_text("\n".join([*lines, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in surface.faces)]))
    mesh = read(file, 1.0)
    exact = np.array(BoxShape(size=(0.8, 0.6, 0.4)).inertia(1.0)) * 0.192
    assert mesh.moments == pytest.approx(exact, rel=1e-6 + 1e-12 * offset)
    assert mesh.turn == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-6)


def test_a_skin_given_beside_its_cells_counts_once_and_other_cells_are_refused(tmp_path):
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], float)
    skin = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
    meshio.Mesh(points, [("triangle", skin), ("tetra", np.array([[0, 1, 2, 3]]))]).write(tmp_path / "a.vtu")
    assert read(tmp_path / "a.vtu", 1.0).volume == pytest.approx(1.0 / 6.0)
    parts = [("tetra", np.array([[0, 1, 2, 3]])), ("tetra", np.array([[1, 2, 3, 4]]))]
    meshio.Mesh(points, parts).write(tmp_path / "b.vtu")
    assert len(read(tmp_path / "b.vtu", 1.0).triangles) == 6, "blocks that share a face"
    meshio.Mesh(points, [("pyramid", np.array([[0, 1, 2, 3, 4]]))]).write(tmp_path / "c.vtu")
    with pytest.raises(
        InputError, match="has cells of the kind pyramid; allowed are triangle, quad, tetra, hexahedron"
    ):
        read(tmp_path / "c.vtu", 1.0)


def test_pieces_that_touch_along_an_edge_are_refused(tmp_path):
    pair = trimesh.util.concatenate([box_of(), box_of(at=(SIZE[0], SIZE[1], 0.0))])
    with pytest.raises(InputError, match="1 of 35 edges belong to more than two triangles"):
        read(written(tmp_path, pair), 1.0)
