"""Meshes: what is read and refused, their fields against closed forms, their contacts against boxes, in water."""

import math

import meshio
import numpy as np
import pytest
import trimesh
from contact_cases import budget, case, go

from parsim.case.model import load
from parsim.domain.comm import Comm
from parsim.errors import InputError
from parsim.geometry.mesh import read
from parsim.geometry.rotation import matrices
from parsim.run.simulation import Simulation
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.shapes import BoxShape, MeshShape, SphereShape

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


def test_a_field_is_exact_beside_the_surface_and_of_order_two_between_its_nodes(tmp_path):
    """A ball of 20,480 triangles, whose own distance from the sphere is far less."""
    file, errors = written(tmp_path, trimesh.creation.icosphere(5, 0.05), "ball.ply"), []
    points = np.random.default_rng(1).normal(size=(2000, 3))
    points *= np.random.default_rng(2).uniform(0.03, 0.058, (2000, 1)) / np.linalg.norm(points, axis=1)[:, None]
    for nodes in (16, 32):
        shape = MeshShape(kind="mesh", file=str(file), resolution=0.1 / nodes)
        errors.append(np.abs(shape.away(points) - (np.linalg.norm(points, axis=1) - 0.05)).max())
    assert errors[0] < 5e-4 and 3.0 < errors[0] / errors[1] < 5.0
    assert shape.thinnest(False) == pytest.approx(0.05, rel=0.06)


def test_a_field_knows_the_inside_of_a_hollow_body(tmp_path):
    """Nodes on corners, edges and in the planes of faces among them."""
    shape = MeshShape(kind="mesh", file=str(written(tmp_path, hollow())), resolution=0.0025)
    centre = read(tmp_path / "a.stl", 1.0).centre
    for place, inside in [
        ((0, 0, 0.01), True),
        ((0, 0, 0.03), False),
        ((0.05, 0, 0.04), True),
        ((0.05, 0.05, 0.045), True),
        ((0.03, 0.03, 0.045), False),
        ((0, 0, -0.002), False),
        ((0.062, 0, 0.01), False),
    ]:
        assert (shape.away(np.array([place]) - centre)[0] < 0.0) == inside, place
    field = shape.field
    i, j, k = np.meshgrid(
        *(s + field.step * np.arange(n) for s, n in zip(field.start, field.value.shape, strict=True)), indexing="ij"
    )
    x, y, z = (np.abs(i + centre[0]), np.abs(j + centre[1]), k + centre[2])
    solid = (np.maximum(x, y) < 0.06) & (z > 0.0) & (z < 0.05) & ~((np.maximum(x, y) < 0.04) & (z > 0.02))
    clear = np.abs(field.value) > 1e-9
    assert ((field.value < 0.0) == solid)[clear].all()


@pytest.mark.parametrize("spacing", [0.005, 0.01])
def test_samples_and_patches_make_up_the_body(tmp_path, spacing):
    shape = MeshShape(kind="mesh", file=str(written(tmp_path, hollow())))
    samples = shape.samples(spacing, math.inf, False)
    assert samples.shares.sum() * spacing**3 == pytest.approx(shape.volume)
    assert (shape.away(samples.offsets) < 0.5 * spacing).all()
    assert (samples.normal * samples.area[:, None]).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
    outwards = (samples.place * samples.normal * samples.area[:, None]).sum() / 3.0
    assert outwards == pytest.approx(shape.volume, rel=1e-6)


def test_elements_have_the_faces_of_a_box(tmp_path):
    elements, _ = MeshShape(kind="mesh", file=str(written(tmp_path, box_of()))).elements(False)
    for axis, face in enumerate((0.0024, 0.0032, 0.0048)):
        assert np.maximum(elements[:, 3 + axis], 0.0).sum() == pytest.approx(face, rel=1e-5)
    assert np.abs(elements[:, :3]).max(axis=0) == pytest.approx((0.04, 0.03, 0.02), rel=1e-5)


MASS = 0.192


@pytest.mark.parametrize("other", ["mesh", "box", "sphere"])
def test_what_is_put_on_a_mesh_comes_to_rest_there(tmp_path, other):
    """The lower is a mesh; loads, heights and energy of the two at rest."""
    mesh = MeshShape(kind="mesh", file=str(written(tmp_path, box_of())))
    top = {"mesh": mesh, "box": BoxShape(size=SIZE), "sphere": SphereShape(kind="sphere", diameter=0.04)}[other]
    bodies = Bodies([mesh, top], [MASS] * 2, [(0.5, 0.5, 0.0201), (0.501, 0.5, 0.0605)])
    contacts = Contacts(bodies, case(restitution=0.3))
    before = budget(bodies, contacts)
    go(bodies, contacts, 1e-3, 600)
    assert bodies.position[:, 2] == pytest.approx([0.02, 0.06], abs=5e-4)
    assert bodies.contact_load[:, 2] == pytest.approx([9.81 * MASS] * 2, rel=2e-3)
    assert budget(bodies, contacts) == pytest.approx(before, abs=1e-3 * before)
    assert abs(bodies.position[1, 0] - 0.501) < 1e-3


@pytest.mark.parametrize("law", ["soft", "hard"])
def test_a_block_lies_in_a_hollow(tmp_path, law):
    """It falls into the pit of a tray, not onto its rim: what is not convex has a shape of its own."""
    from parsim.solid.laws import DEFAULT
    from parsim.solid.laws.impulse import ImpulseLaw

    tray = MeshShape(kind="mesh", file=str(written(tmp_path, hollow())))
    centre = read(tmp_path / "a.stl", 1.0).centre
    bodies = Bodies(
        [tray, BoxShape(size=(0.05, 0.05, 0.05))], [1.0, 0.1], [(0.5, 0.5, centre[2]), (0.503, 0.498, 0.05)]
    )
    contacts = Contacts(bodies, case(restitution=0.2, law=DEFAULT if law == "soft" else ImpulseLaw(kind="impulse")))
    before = budget(bodies, contacts)
    for step in range(600):
        go(bodies, contacts, 1e-3, 1, time=1e-3 * step)
        assert budget(bodies, contacts) < before + 1e-3 * abs(before)
    assert bodies.position[1, 2] == pytest.approx(0.045, abs=3e-4)
    assert np.abs(bodies.velocity).max() < 1e-2


def test_no_mesh_makes_energy(tmp_path):
    """Trays and boxes of any pose that hit each other, without weight."""
    tray = MeshShape(kind="mesh", file=str(written(tmp_path, hollow())))
    draw = np.random.default_rng(5)
    for _ in range(12):
        turn = draw.normal(size=(2, 4))
        turn /= np.linalg.norm(turn, axis=1)[:, None]
        way = draw.normal(size=3)
        way /= np.linalg.norm(way)
        shapes = [tray, tray if draw.random() < 0.5 else BoxShape(size=SIZE)]
        bodies = Bodies(
            shapes,
            [1.0, 0.3],
            [(0.5, 0.5, 0.5), 0.5 + 0.2 * way],
            turn,
            velocity=[(0, 0, 0), -draw.uniform(0.5, 3.0) * way],
            spin=draw.normal(size=(2, 3)) * 3.0,
        )
        contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), walls=(), friction=0.3))
        start, momentum = bodies.kinetic_energy(), bodies.mass @ bodies.velocity
        for step in range(200):
            go(bodies, contacts, 1e-3, 1, time=1e-3 * step)
            assert bodies.kinetic_energy() + contacts.elastic_energy() < 1.001 * start
        assert bodies.mass @ bodies.velocity == pytest.approx(momentum, abs=1e-9)


CASE = """
dimensions = 3
spacing = 0.01
[box]
max = [0.2, 0.2, 0.2]
[[water.fill]]
min = [0.0, 0.0, 0.0]
max = [0.2, 0.2, 0.1]
[materials.ice]
young = 1e7
poisson = 0.3
friction = 0.4
restitution = 0.5
[[bodies]]
name = "floe"
shape = {kind = "mesh", file = "floe.stl"}
density = 500.0
position = [0.1, 0.1, "float"]
material = "ice"
[run]
until = 0.02
"""


def test_a_mesh_floats_from_where_the_case_is(tmp_path):
    """The file is named from the case's folder; the completed case names it whole."""
    written(tmp_path, box_of(), "floe.stl")
    (tmp_path / "case.toml").write_text(CASE)
    found = load(tmp_path / "case.toml")
    assert found.bodies[0].position[2] == pytest.approx(0.1)
    assert str(tmp_path / "floe.stl") in found.to_toml()
    s = Simulation(found, Comm())
    while s.time < found.run.until:
        s.step()
    assert s.bodies.water_load[0, 2] == pytest.approx(9.81 * 0.096, rel=0.2)
    assert abs(s.bodies.position[0, 2] - 0.1) < 1e-3


@pytest.mark.parametrize(("changes", "said"), [
    ({"scale": 1000.0}, "in millimetres"),
    ({"resolution": 1.0}, "shape.resolution = 1.0: must be between"),
    ({"file": "none.stl"}, "none.stl: no such file"),
])  # fmt: skip
def test_what_is_wrong_with_a_mesh_in_a_case_is_told(tmp_path, changes, said):
    written(tmp_path, box_of(), "floe.stl")
    (tmp_path / "case.toml").write_text(CASE)
    with pytest.raises(InputError, match=said):
        load(tmp_path / "case.toml", [f"bodies.floe.shape.{key}={value}" for key, value in changes.items()])


@pytest.mark.parametrize("division", [17, 37, 64, 95, 125, 385])
def test_no_row_of_a_field_leaks(tmp_path, division):
    """Lines through edges of triangles and through diagonals of faces cross a surface once, rounding or not."""
    file = written(tmp_path, box_of(), "a.ply")
    shape = MeshShape(kind="mesh", file=str(file), resolution=0.08 / division)
    field, half = shape.field, np.array(SIZE) / 2.0
    place = np.stack(np.meshgrid(*(s + field.step * np.arange(n) for s, n in zip(
        field.start, field.value.shape, strict=True)), indexing="ij"), -1)  # fmt: skip
    over = (np.abs(place) - half).max(axis=-1)
    clear = np.abs(over) > 1e-8
    assert ((field.value < 0.0) == (over < 0.0))[clear].all()


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


@pytest.mark.parametrize(("make", "said"), [
    (lambda: trimesh.util.concatenate([box_of(), box_of(at=(0.02, 0.01, 0.01))]), "pieces of it overlap"),
    (lambda: box_of((1.0, 1.0, 0.004)), "too thin for a field; its thinnest side must be a 200th"),
])  # fmt: skip
def test_what_a_field_cannot_hold_is_told(tmp_path, make, said):
    shape = MeshShape(kind="mesh", file=str(written(tmp_path, make())))
    assert any(said in text for text in shape.faults(False)), list(shape.faults(False))
    assert not list(MeshShape(kind="mesh", file=str(written(tmp_path, box_of((1.0, 1.0, 0.02))))).faults(False))


def test_pieces_that_touch_along_an_edge_are_refused(tmp_path):
    pair = trimesh.util.concatenate([box_of(), box_of(at=(SIZE[0], SIZE[1], 0.0))])
    with pytest.raises(InputError, match="1 of 35 edges belong to more than two triangles"):
        read(written(tmp_path, pair), 1.0)


def test_a_file_that_has_changed_is_another_body(tmp_path):
    """The completed case knows its contents, and paths count from the case also where they are set."""
    written(tmp_path, box_of(), "floe.stl")
    written(tmp_path, box_of((0.06, 0.06, 0.04)), "other.stl")
    (tmp_path / "case.toml").write_text(CASE)
    found = load(tmp_path / "case.toml", ["bodies.floe.shape.file=other.stl"])
    assert found.bodies[0].shape.half[0] == pytest.approx(0.03)
    completed = tmp_path / "out.toml"
    completed.write_text(found.to_toml())
    load(completed)
    written(tmp_path, box_of((0.05, 0.06, 0.04)), "other.stl")
    with pytest.raises(InputError, match="has changed; its SHA-256 is not"):
        load(completed)
