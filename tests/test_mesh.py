"""Meshes as bodies: their fields against closed forms, their contacts against boxes, in water, in a case."""

import math

import numpy as np
import pytest
import trimesh
from contact_cases import budget, case, go
from mesh_cases import SIZE, box_of, hollow, written

from parsim.case.model import load
from parsim.domain.comm import Comm
from parsim.errors import InputError
from parsim.geometry.mesh import read
from parsim.run.simulation import Simulation
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.shapes import BoxShape, MeshShape, SphereShape


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
    assert budget(bodies, contacts) == pytest.approx(before, abs=1e-9 * before)
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


@pytest.mark.parametrize("division", [17, 37, 64, 95, 125])
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


@pytest.mark.parametrize(("make", "said"), [
    (lambda: trimesh.util.concatenate([box_of(), box_of(at=(0.02, 0.01, 0.01))]), "pieces of it overlap"),
    (lambda: box_of((1.0, 1.0, 0.004)), "too thin for a field; its thinnest side must be a 200th"),
])  # fmt: skip
def test_what_a_field_cannot_hold_is_told(tmp_path, make, said):
    shape = MeshShape(kind="mesh", file=str(written(tmp_path, make())))
    assert any(said in text for text in shape.faults(False)), list(shape.faults(False))
    assert not list(MeshShape(kind="mesh", file=str(written(tmp_path, box_of((1.0, 1.0, 0.02))))).faults(False))


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
