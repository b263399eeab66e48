"""Shapes of bodies: volume, distance, rays, samples, surface, draught against plain versions; spheres in contact."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from contact_cases import boxes, budget, case, go, momenta
from flows import simulation, tank

from parsim.case.model import parse
from parsim.case.places import Place, overlap
from parsim.errors import InputError
from parsim.geometry.rotation import from_angles, matrices
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.laws.law import compliance
from parsim.solid.shapes import (
    SHAPES,
    BoxShape,
    CylinderShape,
    DilatedDiscShape,
    DiscShape,
    PolygonShape,
    PrismShape,
    SphereShape,
)
from parsim.solid.shapes.forms import forms_of
from parsim.solid.shapes.kernels import ahead, core, distance, reach


def sphere(diameter):
    return SphereShape(kind="sphere", diameter=diameter)


HEXAGON = [(0.2, 0.0), (0.1, 0.15), (-0.1, 0.2), (-0.2, 0.0), (-0.1, -0.1), (0.12, -0.12)]
TRIANGLE = [(0.3, 0.1), (0.0, 0.2), (0.0, 0.0)]  # clockwise, and off its centre
SOLID = [
    BoxShape(size=(0.2, 0.3, 0.5)),
    BoxShape(size=(0.1, 0.1, 0.1)),
    SphereShape(diameter=0.3, kind="sphere"),
    CylinderShape(kind="cylinder", diameter=0.4, height=0.2),
    CylinderShape(kind="cylinder", diameter=0.2, height=0.5),
    PrismShape(kind="prism", points=HEXAGON, height=0.15),
    PrismShape(kind="prism", points=TRIANGLE, height=0.3),
    DilatedDiscShape(kind="dilated_disc", diameter=0.5, thickness=0.2),
]
FLAT = [
    DiscShape(kind="disc", diameter=0.3),
    PolygonShape(kind="polygon", points=HEXAGON),
    PolygonShape(kind="polygon", points=TRIANGLE),
    PolygonShape(kind="polygon", points=[(0.0, 0.0), (0.3, 0.0), (0.3, 0.2), (0.0, 0.2)]),
]
GIVEN = SOLID + FLAT
every_shape = pytest.mark.parametrize("shape", GIVEN, ids=lambda shape: f"{shape.kind}-{GIVEN.index(shape)}")
WOOD = {"wood": {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}}


def directions(count, seed=0):
    """Unit vectors at random, as tuples."""
    each = np.random.default_rng(seed).normal(size=(count, 3))
    return [tuple(row) for row in each / np.linalg.norm(each, axis=1)[:, None]]


def test_shapes_stand_in_the_order_of_their_numbers():
    assert [shape.NUMBER for shape in SHAPES] == list(range(len(SHAPES)))


def points_about(shape, count, seed, width=1.5):
    """Points (count, 3) in and around a shape, in the plane of a flat one."""
    points = np.random.default_rng(seed).uniform(-width, width, (count, 3)) * shape.half
    return points * (1.0, 0.0, 1.0) if shape.FLAT else points


def ways(shape, count):
    """Unit vectors, those of a flat shape in its plane."""
    return [
        tuple(np.array(way) * (1.0, 0.0, 1.0) / math.hypot(way[0], way[2])) if shape.FLAT else way
        for way in directions(count)
    ]


@every_shape
def test_distance_is_that_to_the_nearest_point_of_the_surface(shape):
    """Walking the distance along the normal leads to the surface; nothing of the surface is nearer."""
    forms = forms_of([shape], shape.FLAT)
    for p in points_about(shape, 200, 1):
        high, n = distance(forms, 0, tuple(p))
        assert np.linalg.norm(n) == pytest.approx(1.0)
        assert shape.away(p[None])[0] == pytest.approx(high, abs=1e-14)
        foot = p - high * np.array(n)
        assert distance(forms, 0, tuple(foot))[0] == pytest.approx(0.0, abs=1e-12)
        inside = distance(forms, 0, tuple(p + (abs(high) - 1e-9) * np.array(ways(shape, 1)[0])))
        assert (inside[0] > 0.0) == (high > 0.0), "within the distance there is no surface"


def test_shapes_that_are_asked_for_something_still_compare():
    one, two = (PrismShape(kind="prism", points=HEXAGON, height=h) for h in (0.15, 0.2))
    assert one.corners is not None and one != two and one == PrismShape(kind="prism", points=HEXAGON, height=0.15)
    assert len({one, two, one.model_copy()}) == 2


@every_shape
def test_rays_meet_the_surface(shape):
    met, forms = 0, forms_of([shape], shape.FLAT)
    for p, n in zip(points_about(shape, 300, 2, 2.0), ways(shape, 300), strict=True):
        if distance(forms, 0, tuple(p))[0] <= 0.01:
            continue
        gap = ahead(forms, 0, tuple(p), n, 0.01)
        steps = np.linspace(0.0, 3.0, 301)
        along = [distance(forms, 0, tuple(p + t * np.array(n)))[0] for t in steps]
        if gap < np.inf:
            met += 1
            assert distance(forms, 0, tuple(p + gap * np.array(n)))[0] == pytest.approx(0.0, abs=1e-9)
            assert min((d for d, t in zip(along, steps, strict=True) if t < gap), default=1.0) > -1e-9
        else:
            assert min(along) > -1e-3
    assert met > 20
    closed = ahead(forms, 0, (0.0, 0.0, shape.half[2] - 0.005), (0.0, 0.0, -1.0), 0.01)
    assert closed == pytest.approx(-0.005) or shape.kind == "polygon", "an overlap closes the gap"


@every_shape
def test_volume_reach_and_inertia_are_those_of_the_surface(shape):
    points, quads = shape.surface()
    a, b, c, d = (points[quads[:, k]] for k in range(4))
    volume = sum((p * np.cross(q, r)).sum() for p, q, r in ((a, b, c), (a, c, d))) / 6.0
    assert volume == pytest.approx(shape.volume, rel=0.03)
    assert volume <= shape.volume * (1.0 + 1e-12), "corners lie on it"
    edges = np.concatenate([quads[:, [k, (k + 1) % 4]] for k in range(4)])
    assert {tuple(edge) for edge in edges} == {tuple(edge[::-1]) for edge in edges}, "closed, and turned one way"
    forms = forms_of([shape], shape.FLAT)
    for d in ways(shape, 50):
        assert (points @ d).max() == pytest.approx(reach(forms, 0, d), rel=0.02)
        assert shape.reach(d) == pytest.approx(reach(forms, 0, d), rel=1e-12)
        assert np.dot(core(forms, 0, d), d) < reach(forms, 0, d)
        assert distance(forms, 0, core(forms, 0, d))[0] <= -0.99 * forms.margin[0] or shape.ROUND
    sampled = shape.samples(0.01, 1.0, shape.FLAT)
    assert sampled.shares.sum() * 0.01 ** (2 if shape.FLAT else 3) == pytest.approx(shape.volume, rel=1e-3)
    moment = (sampled.shares[:, None] * sampled.offsets).sum(0) / sampled.shares.sum()
    assert np.abs(moment).max() < 0.002 * max(shape.half)
    square = (sampled.shares[:, None] * sampled.offsets**2).sum(0) / sampled.shares.sum()
    moments = np.array([square[1] + square[2], square[0] + square[2], square[0] + square[1]])
    about = [1] if shape.FLAT else [0, 1, 2]
    assert moments[about] == pytest.approx(np.array(shape.inertia(1.0))[about], rel=0.02)


@every_shape
def test_patches_cover_the_surface(shape):
    """Their normals sum up to nothing, and their parts of the volume to all of it."""
    s, forms = shape.samples(0.02, 0.06, shape.FLAT), forms_of([shape], shape.FLAT)
    assert (s.area[:, None] * s.normal).sum(0) == pytest.approx(np.zeros(3), abs=1e-3 * s.area.sum())
    volume = (s.area * (s.place * s.normal).sum(1)).sum() / (2.0 if shape.FLAT else 3.0)
    assert volume == pytest.approx(shape.volume, rel=0.05 if shape.kind == "dilated_disc" else 0.01)
    for place, normal, at in zip(s.place, s.normal, s.sample, strict=True):
        assert distance(forms, 0, tuple(place))[0] == pytest.approx(0.0, abs=1e-12)
        assert 0.0 < (place - s.offsets[at]) @ normal < 0.016
    depth = [-distance(forms, 0, tuple(p))[0] for p in s.offsets]
    assert min(depth) > 0.0 and max(depth) < 0.065


@pytest.mark.parametrize("shape", [*SOLID[:3], BoxShape(size=(0.07, 0.05, 1.0)), sphere(0.031)], ids=str)
@pytest.mark.parametrize("depth", [0.01, 0.03, 0.04, 0.2])
@pytest.mark.parametrize("planar", [False, True])
def test_samples_are_counted_without_making_them(shape, depth, planar):
    assert shape.number_of_samples(0.01, depth, planar) == len(shape.samples(0.01, depth, planar).offsets)


@every_shape
def test_elements_lie_on_the_surface_and_cover_its_faces(shape):
    rows, _ = shape.elements(shape.FLAT)
    forms = forms_of([shape], shape.FLAT)
    for row in rows:
        assert distance(forms, 0, tuple(row[:3]))[0] == pytest.approx(0.0, abs=1e-12)
    assert rows[:, 3:].sum(0) == pytest.approx(np.zeros(3), abs=1e-12)
    if shape.kind in ("cylinder", "prism", "dilated_disc"):
        across = {"cylinder": 0.5, "dilated_disc": 0.5}.get(shape.kind, 0.0)
        size = shape.core if shape.kind == "dilated_disc" else across * getattr(shape, "diameter", 0.0)
        face = math.pi * size**2 if across else shape.volume / shape.height
        assert rows[rows[:, 5] > 0.0, 5].sum() == pytest.approx(face, rel=1e-9)


@every_shape
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_every_shape_floats_at_its_draught_however_it_is_turned(share, shape):
    """Against points all through it, counted below the water."""
    points = points_about(shape, 40000, 5, 1.0)
    points = points[shape.away(points) < 0.0]
    for up in ways(shape, 1 if shape.kind == "dilated_disc" else 4):  # whose volume under a plane takes seconds
        height = shape.afloat(share, up)
        assert (points @ up < -height).mean() == pytest.approx(share, abs=0.012)


@pytest.mark.parametrize("share", [0.01, 0.3, 0.5, 0.9, 0.999])
def test_a_sphere_floats_at_its_draught(share):
    ball = sphere(0.2)
    h = ball.draught(share * 1000.0, 1000.0)
    assert math.pi * h * h * (3.0 * 0.1 - h) / 3.0 == pytest.approx(share * ball.volume, rel=1e-9)


def test_overlaps_with_balls():
    turn = matrices(np.array([from_angles((20.0, 30.0, 40.0))]))[0]
    box, ball = Place(np.zeros(3), turn, BoxShape(size=(0.2, 0.4, 0.6))), sphere(0.1)
    for x, expected in ((0.14, 0.01), (0.17, -0.02)):
        other = Place(turn @ (x, 0.0, 0.1), np.eye(3), ball)
        assert overlap(box, other) == overlap(other, box) == pytest.approx(expected)
    one, two = (Place(np.array([x, 0.0, 0.0]), np.eye(3), ball) for x in (0.0, 0.09))
    assert overlap(one, two) == pytest.approx(0.01)
    assert overlap(one, two, (0.02, 0.0, 0.0)) == pytest.approx(-0.01)


@pytest.mark.parametrize("change, said", [
    ({"shape": {"kind": "ball", "diameter": 0.1}}, "must be 'box', 'sphere', "),
    ({"shape": {"kind": "sphere", "size": [0.1, 0.1, 0.1]}}, "bodies.a.shape.size: belongs to kind = 'box'"),
    ({"shape": {"kind": "sphere", "diameter": 0.01}}, "shape.diameter = 0.01: thinner than two particles"),
    ({"position": [0.03, 0.1, 0.1]}, "outside the box, reaches from x = -0.02"),
    ({"position": [0.2, 0.1, "float"], "density": 2000.0}, "does not float"),
])  # fmt: skip
def test_what_is_wrong_with_a_sphere_is_told(change, said):
    body = {"name": "a", "shape": {"kind": "sphere", "diameter": 0.1}, "density": 500.0, "material": "wood"}
    given = tank(0.4, 0.4, 0.01, (0.4, 0.2), 0.2)
    with pytest.raises(InputError) as error:
        parse(given | {"materials": WOOD, "bodies": [{**body, "position": [0.2, 0.1, 0.1], **change}]})
    assert said in str(error.value)


def test_a_plane_has_no_spheres():
    body = {"name": "a", "shape": {"kind": "sphere", "diameter": 0.1}, "density": 500.0, "material": "wood"}
    with pytest.raises(InputError, match="a 2D case has none"):
        parse(tank(0.4, 0.4, 0.01, (0.4, 0.2)) | {"materials": WOOD, "bodies": [{**body, "position": [0.2, 0.5, 0.1]}]})


@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.8545, 1.0])
def test_a_dropped_sphere_rebounds(restitution):
    ball = Bodies([sphere(0.05)], [0.06], [(0.5, 0.5, 0.0251)], velocity=[(0.0, 0.0, -0.5)])
    contacts = Contacts(ball, case(restitution=restitution, gravity=(0.0, 0.0, 0.0), young=1e8))
    before = budget(ball, contacts, (0.0, 0.0, 0.0))
    go(ball, contacts, 1e-4, 100)
    assert contacts.count == 0
    assert ball.velocity[0, 2] / 0.5 == pytest.approx(restitution, rel=0.05)
    assert budget(ball, contacts, (0.0, 0.0, 0.0)) == pytest.approx(before, rel=0.01)


def test_a_sphere_rolls_down_a_slope_without_slipping():
    """5/7 g sin a (a solid sphere), on a floor that pushes back to the right depth."""
    slope = math.radians(20.0)
    down = (9.81 * math.sin(slope), 0.0, -9.81 * math.cos(slope))
    ball = Bodies([sphere(0.05)], [0.06], [(0.3, 0.5, 0.025)])
    contacts = Contacts(ball, case(gravity=down, restitution=0.3, friction=0.5, young=1e7))
    go(ball, contacts, 2e-4, 1500)
    assert ball.velocity[0, 0] == pytest.approx(5.0 / 7.0 * down[0] * 0.3, rel=0.01)
    assert ball.spin[0, 1] * 0.025 == pytest.approx(ball.velocity[0, 0], rel=0.01)


@pytest.mark.parametrize("shapes", [
    [sphere(0.05), sphere(0.03)],
    [sphere(0.05), *boxes((0.02, 0.03, 0.01))],
    [*boxes((0.02, 0.03, 0.01)), sphere(0.05)],
])  # fmt: skip
def test_action_is_reaction_with_spheres(shapes):
    bodies = Bodies(
        shapes,
        [0.06, 0.1],
        [(0.5, 0.5, 0.55), (0.505, 0.51, 0.5)],
        quaternion=[from_angles((10.0, 20.0, 0.0)), (1.0, 0.0, 0.0, 0.0)],
        velocity=[(0.0, 0.0, -0.6), (0.0, 0.0, 0.4)],
        spin=[(1.0, 2.0, 3.0), (0.0, 0.0, 0.0)],
    )
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), young=1e8))
    before, energy = momenta(bodies), bodies.kinetic_energy()
    go(bodies, contacts, 1e-4, 400)
    assert bodies.velocity[0, 2] > bodies.velocity[1, 2] and contacts.count == 0, "they have parted"
    assert budget(bodies, contacts, (0.0, 0.0, 0.0)) == pytest.approx(energy, rel=0.01)
    for now, then in zip(momenta(bodies), before, strict=True):
        assert now == pytest.approx(then, abs=1e-14)


def test_no_wall_holds_a_sphere_where_there_is_none():
    """Beyond an open side there is no floor, above the box no side."""
    places = [(1.2, 0.5, 0.025), (0.97, 0.5, 1.5), (0.97, 0.5, 0.5)]
    bodies = Bodies(
        [sphere(0.05)] * 3, [0.06] * 3, places, velocity=[(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 0.0, 0.0)]
    )
    contacts = Contacts(bodies, case(gravity=(0.0, 0.0, 0.0), walls=("z_min", "x_max")))
    falling = Contacts(Bodies([sphere(0.05)], [0.06], [places[0]]), case())
    go(bodies, contacts, 1e-3, 30)
    go(falling.bodies, falling, 1e-3, 100)
    assert bodies.velocity[:, 0].tolist()[1] == 2.0 and bodies.velocity[2, 0] < 0.0
    assert falling.bodies.position[0, 2] < 0.0


@pytest.mark.parametrize("count", [1.5, 2.0, 3.0, 6.0])
def test_samples_of_a_sphere_pull_nowhere(count):
    s = sphere(count * 0.01).samples(0.01, 0.031, False)
    assert (s.shares[:, None] * s.offsets).sum(0) == pytest.approx(np.zeros(3), abs=1e-15)
    assert (s.area[:, None] * s.normal).sum(0) == pytest.approx(np.zeros(3), abs=1e-15)


def test_the_lee_of_a_sphere_is_dry():
    """Films feed what water reaches: with water on one side only, the faces away from it have none."""
    body = {"name": "a", "shape": {"kind": "sphere", "diameter": 0.06}, "density": 500.0, "material": "wood"}
    given = tank(0.24, 0.12, 0.01, (0.09, 0.06), 0.1)
    given["run"]["settle"] = 0.0
    s = simulation(given | {"materials": WOOD, "bodies": [{**body, "position": [0.12, 0.05, 0.035], "fixed": True}]})
    for _ in range(20):
        s.step()
    fed = s.bodies.film[0, 1:]
    assert fed[0] > 0.5 and fed[1] == 0.0, "upstream, and away from the water"


def test_a_plate_on_balls_comes_to_rest():
    """A plate on three balls on the floor, at rest within 1 s; each contact is sqrt(F / (k pi R)) deep."""
    legs = [(0.5 + 0.05 * math.cos(a), 0.5 + 0.05 * math.sin(a), 0.02) for a in (0.0, 2.1, 4.2)]
    shapes = [*[sphere(0.04)] * 3, *boxes((0.08, 0.08, 0.01))]
    bodies = Bodies(shapes, [0.03, 0.03, 0.03, 0.2], [*legs, (0.5, 0.5, 0.0502)])
    contacts = Contacts(bodies, case(restitution=0.3, friction=0.5, young=1e7))
    go(bodies, contacts, 2e-4, 3000)
    assert np.abs(bodies.velocity).max() < 1e-3
    stiffness = 1.0 / (compliance(*[SimpleNamespace(young=1e7, poisson=0.4)] * 2) * 0.01)
    deep = [math.sqrt(9.81 * m / 3.0 / (stiffness * math.pi * 0.02)) for m in (0.2, 0.29)]
    assert bodies.position[3, 2] == pytest.approx(0.05 - sum(deep), abs=1e-6)


AFLOAT = {
    "sphere": {"kind": "sphere", "diameter": 0.12},
    "cylinder": {"kind": "cylinder", "diameter": 0.14, "height": 0.08},
    "prism": {"kind": "prism", "points": [[0.07, 0.0], [0.02, 0.07], [-0.07, 0.04], [-0.05, -0.06]], "height": 0.08},
    "dilated_disc": {"kind": "dilated_disc", "diameter": 0.15, "thickness": 0.08},
    "disc": {"kind": "disc", "diameter": 0.12},
    "polygon": {"kind": "polygon", "points": [[0.07, -0.04], [0.06, 0.04], [-0.06, 0.04], [-0.07, -0.04]]},
}


@pytest.mark.slow
@pytest.mark.parametrize("density", [300.0, 850.0])
@pytest.mark.parametrize("kind", AFLOAT)
def test_a_body_of_any_shape_stays_at_its_draught(kind, density):
    planar = kind in ("disc", "polygon")
    body = {"name": "a", "shape": AFLOAT[kind], "density": density, "material": "wood"}
    given = tank(0.24, 0.3, 0.01, (0.24, 0.16), None if planar else 0.24)
    given["run"]["settle"] = 1.0
    place = [0.12, 0.5 if planar else 0.12, "float"]
    s = simulation(given | {"materials": WOOD, "bodies": [{**body, "position": place}]})
    start = s.bodies.position[0, 2]
    while s.time < 1.0:
        s.step()
    p, at = s.domain.particles, s.near.fluid
    level = (p.z[at] + p.p[at] / 9810.0)[p.p[at] > 0.0].mean()
    assert s.bodies.position[0, 2] - level == pytest.approx(start - 0.16, abs=0.0025)
    assert np.linalg.norm(s.bodies.velocity[0]) < 0.01
