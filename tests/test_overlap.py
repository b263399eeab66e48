"""The area in which bodies touch: of faces that lie on each other, of the side of a cylinder against what is short."""

import math

import numpy as np
import pytest
from contact_cases import case, go
from test_laws import HALF_SPACE, HERTZ, YOUNG

from parsim.geometry.rotation import from_angles
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.search import AREA, DEPTH, POINT
from parsim.solid.shapes import BoxShape, CylinderShape, DilatedDiscShape, PolygonShape, PrismShape
from parsim.solid.touch import measure, normal_of

DEEP = 1e-4  # m


def touching(shapes, places, turns):
    """(area that touches, m2; depth summed over it, m3; its centre, m) of two bodies."""
    turns = [from_angles(turn) for turn in turns]
    bodies = Bodies(shapes, [1.0, 1.0], places, quaternion=turns)
    contacts = Contacts(bodies, case(walls=()))
    number, count, *_ = contacts._prepare(bodies, bodies.fixed, 0.0, 0.01)
    if not number:
        return 0.0, 0.0, np.zeros(3)
    touch = contacts._touch()
    apart, *n = normal_of(contacts._table, touch, 0)
    area = measure(contacts._table, touch, 0, tuple(n), apart) if apart < 0.0 else 0.0
    s = touch.slots[:count]
    s = s[s[:, DEPTH] > 0.0]
    if area == 0.0:
        return 0.0, 0.0, np.zeros(3)
    assert s[:, AREA].sum() == pytest.approx(area, rel=1e-12)
    return area, s[:, AREA] @ s[:, DEPTH], s[:, AREA] @ s[:, POINT : POINT + 3] / area


def hit(pier, floe, level, **options):
    """Of a floe of 180 kg that hits a pier at 1 m/s: (largest force, N, how deep it got, m)."""
    place = (0.5 * pier.diameter + 0.5 + 1e-5, 0.0, level)
    bodies = Bodies(
        [pier, floe],
        [1.0, 180.0],
        [(0.0, 0.0, 0.0), place],
        velocity=[(0.0,) * 3, (-1.0, 0.0, 0.0)],
        fixed=[True, False],
    )
    given = case(walls=(), gravity=(0.0, 0.0, 0.0), restitution=1.0, young=YOUNG, law=HERTZ, steps=60, **options)
    contacts, most, deepest = Contacts(bodies, given), 0.0, 0.0
    for _ in range(2000):
        go(bodies, contacts, 1e-4, 1)
        most = max(most, bodies.contact_load[1, 0])
        deepest = max(deepest, 0.5 * pier.diameter + 0.5 - bodies.position[1, 0])
        if most > 0.0 and bodies.contact_load[1, 0] == 0.0:
            break
    return float(most), float(deepest)


def clipped(outline, by):
    """Area, m2, of a convex outline (k, 2), cut side by side by another, both anticlockwise (Sutherland & Hodgman)."""
    for p, q in zip(by, np.roll(by, -1, axis=0), strict=True):
        inward = np.array([p[1] - q[1], q[0] - p[0]])
        room, kept = (outline - p) @ inward, []
        for k in range(len(outline)):
            j = (k + 1) % len(outline)
            if room[k] >= 0.0:
                kept.append(outline[k])
            if (room[k] < 0.0) != (room[j] < 0.0):
                kept.append(outline[k] + room[k] / (room[k] - room[j]) * (outline[j] - outline[k]))
        if len(kept) < 3:
            return 0.0
        outline = np.array(kept)
    x, y = outline.T
    return 0.5 * float(x @ np.roll(y, -1) - np.roll(x, -1) @ y)


def random_face(random):
    """A shape 0.2 m high, the outline (k, 2) of its end about its place, its turn about z, degrees."""
    kind, turn = random.integers(4), float(random.uniform(0.0, 360.0))
    around = np.column_stack([np.cos(2.0 * math.pi * np.arange(96) / 96), np.sin(2.0 * math.pi * np.arange(96) / 96)])
    if kind == 0:
        x, y = map(float, random.uniform(0.2, 1.0, 2))
        shape, outline = BoxShape(kind="box", size=(x, y, 0.2)), 0.5 * np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    elif kind == 1:
        angles = random.uniform(0.0, 0.8, 5) + 2.0 * math.pi / 5.0 * np.arange(5)
        corners = random.uniform(0.3, 0.6) * np.column_stack([np.cos(angles), np.sin(angles)])
        shape = PrismShape(kind="prism", points=tuple(map(tuple, corners.tolist())), height=0.2)
        outline = shape.corners
    elif kind == 2:
        shape = CylinderShape(kind="cylinder", diameter=float(random.uniform(0.5, 1.0)), height=0.2)
        outline = shape.half[0] * around
    else:
        shape = DilatedDiscShape(kind="dilated_disc", diameter=float(random.uniform(0.7, 1.2)), thickness=0.2)
        outline = shape.core * around
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    return shape, outline @ np.array([[c, s], [-s, c]]), turn


def test_the_area_of_faces_is_that_of_their_overlap():
    random, seen, round_ = np.random.default_rng(11), 0, 0
    for _ in range(300):
        (one, upper, turn), (two, lower, other) = random_face(random), random_face(random)
        at = np.append(random.uniform(-0.5, 0.5, 2), 0.2 - DEEP)
        area, volume, _ = touching([one, two], [at, (0.0, 0.0, 0.0)], [(0.0, 0.0, turn), (0.0, 0.0, other)])
        exact = clipped(upper + at[:2], lower)
        if exact < 0.02:
            continue
        seen += 1
        rounded = {CylinderShape, DilatedDiscShape} & {type(one), type(two)}
        round_ += bool(rounded)
        assert area == pytest.approx(exact, rel=0.02 if rounded else 1e-6), (one, two, at, turn, other)
        if not isinstance(one, DilatedDiscShape) and not isinstance(two, DilatedDiscShape):  # theirs fades at the rim
            assert volume == pytest.approx(DEEP * area, rel=1e-6)
    assert seen > 150
    assert 0 < round_ < seen


@pytest.mark.parametrize("shift", [0.0, 0.05, 0.13, 0.29, 0.377])
def test_equal_faces_that_are_shifted_touch_where_they_overlap(shift):
    """Their edges coincide; 0.4 m wide, so that the last overlap is narrower than the distance of their elements."""
    floe = BoxShape(kind="box", size=(0.4, 1.0, 0.2))
    area, _, centre = touching([floe, floe], [(shift, 0.0, 0.2 - DEEP), (0.0, 0.0, 0.0)], [(0.0, 0.0, 0.0)] * 2)
    assert area == pytest.approx(0.4 - shift, rel=1e-6)
    assert -0.2 + shift - 1e-9 <= centre[0] <= 0.2 + 1e-9


def test_faces_that_lie_flat_no_more_come_to_what_their_elements_say():
    """Half as flat, half as much of the overlap: nothing jumps while a floe tilts."""
    pair = [BoxShape(kind="box", size=(0.44, 0.9, 0.2)), BoxShape(kind="box", size=(3.0, 3.0, 0.2))]
    tilts = np.linspace(0.0, 8.0, 81)
    areas = [
        touching(pair, [(0.0, 0.0, 0.2 - DEEP - 0.03), (0.0, 0.0, 0.0)], [(0.0, float(tilt), 0.0), (0.0, 0.0, 0.0)])[0]
        for tilt in tilts
    ]
    assert max(abs(np.diff(areas))) < 0.4 * areas[0]


def regular(count, across):
    """Corners of a regular polygon, its first side below, `across`, m, from centre to side."""
    angles = -0.5 * math.pi + math.pi / count * (2.0 * np.arange(count) - 1.0)
    corners = across / math.cos(math.pi / count) * np.column_stack([np.cos(angles), np.sin(angles)])
    return tuple(map(tuple, corners.tolist()))


@pytest.mark.parametrize("count", [3, 5, 8, 12, 24, 64])
@pytest.mark.parametrize("wide", [3.0, 0.05])
def test_a_side_of_a_prism_lies_with_its_own_area(count, wide):
    """On its side on a box, wider or narrower than it; neither the sides next to it nor the box's own elements add."""
    shape = PrismShape(kind="prism", points=regular(count, 0.2), height=0.3)
    under = BoxShape(kind="box", size=(wide, 3.0, 0.2))
    area, volume, _ = touching([shape, under], [(0.0, 0.0, 0.3 - DEEP), (0.0,) * 3], [(90.0, 0.0, 0.0), (0.0,) * 3])
    assert area == pytest.approx(0.3 * min(0.4 * math.tan(math.pi / count), wide), rel=1e-6)
    assert volume == pytest.approx(DEEP * area, rel=1e-6)


def test_sides_that_slope_outwards_above_do_not_touch():
    shape = PrismShape(kind="prism", points=((-0.2, 0.0), (0.2, 0.0), (0.8, 0.5), (-0.8, 0.5)), height=0.3)
    low = -float(shape.corners[:, 1].min())
    bodies = [shape, BoxShape(kind="box", size=(3.0, 3.0, 0.2))]
    area, _, centre = touching(bodies, [(0.05, 0.02, 0.1 + low - DEEP), (0.0,) * 3], [(90.0, 0.0, 0.0), (0.0,) * 3])
    assert area == pytest.approx(0.4 * 0.3, rel=1e-6)
    assert centre[:2] == pytest.approx([0.05, 0.02], abs=1e-9)


@pytest.mark.parametrize("count", [4, 5, 6, 8, 12])
@pytest.mark.parametrize("shift", [0.0, 0.3, 0.7])
def test_floes_touch_face_to_face_where_their_sides_overlap(count, shift):
    """Upright, side to side, shifted along it by a share of its length; area and centre of the force are exact."""
    floe = PrismShape(kind="prism", points=regular(count, 0.5), height=0.2)
    side = math.tan(math.pi / count)
    places = [(shift * side, 0.0, 0.04), (0.0, -1.0 + DEEP, 0.0)]
    area, _, centre = touching([floe] * 2, places, [(0.0,) * 3, (0.0, 0.0, 180.0)])
    assert area == pytest.approx((1.0 - shift) * side * 0.16, rel=1e-6)
    assert centre[[0, 2]] == pytest.approx([0.5 * shift * side, 0.02], abs=1e-6)


@pytest.mark.parametrize("lens", [0.1, 0.05])
def test_what_overlaps_by_little_touches_by_little(lens):
    """Two prisms on each other by a corner: less than one element stands for."""
    floe = PrismShape(kind="prism", points=((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)), height=0.2)
    places = [(0.4 - lens, 0.4 - lens, 0.2 - 1e-6), (0.0,) * 3]
    area, _, _ = touching([floe] * 2, places, [(0.0,) * 3] * 2)
    assert area == pytest.approx(lens * lens, rel=1e-5)


@pytest.mark.parametrize("count", [5, 8, 24])
def test_a_polygon_of_a_plane_lies_with_its_side(count):
    """2D; on a box and on the floor."""
    points, side = regular(count, 0.2), 0.4 * math.tan(math.pi / count)
    shape = PolygonShape(kind="polygon", points=points)
    under = BoxShape(kind="box", size=(3.0, 1.0, 0.2))
    bodies = Bodies([shape, under], [1.0] * 2, [(0.01, 0.5, 0.3 - DEEP), (0.0, 0.5, 0.0)], planar=True)
    for walls, pair in (((), bodies), (("z_min",), Bodies([shape], [1.0], [(0.5, 0.5, 0.2 - DEEP)], planar=True))):
        given = case(walls=walls)
        given.dimensions, given.axes = 2, (0, 2)
        contacts = Contacts(pair, given)
        contacts._prepare(pair, pair.fixed, 0.0, 0.01)
        touch = contacts._touch()
        apart, *n = normal_of(contacts._table, touch, 0)
        assert measure(contacts._table, touch, 0, tuple(n), apart) == pytest.approx(side, rel=1e-6)


def test_the_normal_of_a_tall_pier_is_level():
    """A floe slides round a pier; forces do not jump as the nearest points of tall bodies are known to few digits."""
    pier, floe = CylinderShape(kind="cylinder", diameter=0.4, height=3.0), BoxShape(kind="box", size=(1.0, 1.0, 0.2))
    for across in np.linspace(0.45, 0.55, 41):
        bodies = Bodies([pier, floe], [1.0] * 2, [(0.0,) * 3, (0.7 - 1e-3, float(across), 0.3)])
        contacts = Contacts(bodies, case(walls=()))
        if contacts._prepare(bodies, bodies.fixed, 0.0, 0.01)[0]:
            assert abs(normal_of(contacts._table, contacts._touch(), 0)[3]) < 1e-12


@pytest.mark.parametrize("height", [0.6, 3.0, 10.0])
@pytest.mark.parametrize("at", [-0.21, 0.0, 0.13])
def test_a_pier_feels_the_thickness_of_a_floe_and_no_more(height, at):
    """Wherever along the pier the floe is; at its end the part that overlaps."""
    pier, floe = CylinderShape(kind="cylinder", diameter=0.4, height=height), BoxShape(kind="box", size=(1.0, 1.0, 0.2))
    for level in (at * height, 0.5 * height - 0.05):
        place = (0.7 - DEEP, 0.1, level)
        area, volume, centre = touching([pier, floe], [(0.0, 0.0, 0.0), place], [(0.0, 0.0, 0.0)] * 2)
        bottom, top = level - 0.1, min(level + 0.1, 0.5 * height)
        assert area == pytest.approx(4.0 / 3.0 * math.sqrt(2.0 * 0.2 * DEEP) * (top - bottom), rel=1e-6)
        assert volume == pytest.approx(DEEP * area, rel=1e-9)
        assert centre[2] == pytest.approx(0.5 * (bottom + top), abs=1e-9)


def test_a_pier_meets_a_tilted_face_along_what_is_within():
    """Depth grows linearly along the line, from where it enters the face to the face's edge."""
    pier = CylinderShape(kind="cylinder", diameter=0.4, height=3.0)
    floe, tilt = BoxShape(kind="box", size=(1.0, 1.0, 0.4)), math.radians(2.0)
    deepest = 0.009
    place = (0.2 + 0.5 * math.cos(tilt) + 0.2 * math.sin(tilt) - deepest, 0.0, 0.3)
    turns = [(0.0, 0.0, 0.0), (0.0, math.degrees(tilt), 0.0)]
    _, volume, centre = touching([pier, floe], [(0.0, 0.0, 0.0), place], turns)
    length = deepest / math.tan(tilt)
    assert volume == pytest.approx(4.0 / 3.0 * math.sqrt(2.0 * 0.2) * 0.4 * length * deepest**1.5, rel=0.01)
    assert place[2] - centre[2] == pytest.approx(0.2 - 0.4 * length, abs=0.02)


@pytest.mark.parametrize("height", [0.25, 3.0])
@pytest.mark.parametrize("level", [0.0, 0.27, 0.5])
def test_a_floe_that_hits_a_pier_is_stopped_by_its_own_thickness(height, level):
    """Elastic: v sqrt(pi/4 E* L m) of the length L that overlaps; crushed: at most its strength times what touches."""
    pier, floe = CylinderShape(kind="cylinder", diameter=0.4, height=height), BoxShape(kind="box", size=(1.0, 1.0, 0.2))
    length = min(0.1, 0.5 * height - level * height) + min(0.1, 0.5 * height + level * height)
    elastic, deepest = hit(pier, floe, level * height)
    assert elastic == pytest.approx(math.sqrt(math.pi / 4.0 * HALF_SPACE * length * 180.0), rel=0.01)
    for share in (0.5, 0.2):
        strength = share * elastic / (4.0 / 3.0 * math.sqrt(0.4 * deepest) * length)
        force, deep = hit(pier, floe, level * height, strength=strength)
        assert force == pytest.approx(
            strength * 4.0 / 3.0 * math.sqrt(0.4 * deep) * length, rel=0.03
        )  # hit below its middle it turns


def _stands(dice):
    size, high = dice.uniform(0.05, 0.2), dice.uniform(0.02, 0.1)
    if dice.random() < 0.3:
        return CylinderShape(kind="cylinder", diameter=size, height=high)
    angles = 2.0 * math.pi * (np.arange(6) + dice.uniform(0.0, 0.8, 6)) / 6.0
    return PrismShape(kind="prism", points=tuple((size * math.cos(t), size * math.sin(t)) for t in angles), height=high)


def test_what_lies_on_a_rim_is_as_deep_as_it_is():
    """Cores beside each other point from rim to rim: along that way 0.01 mm of depth were up to 4."""
    dice, touched = np.random.default_rng(1), 0
    for _ in range(150):
        shapes, deep = [_stands(dice), _stands(dice)], 10.0 ** dice.uniform(-5.0, -3.3)
        angle, far = dice.uniform(0.0, 2.0 * math.pi), dice.uniform(0.0, 0.3)
        high = 0.5 * (shapes[0].height + shapes[1].height) - deep
        place = 0.5 + far * math.cos(angle), 0.5 + far * math.sin(angle), 0.5 + high
        bodies = Bodies(shapes, [1.0, 1.0], [place, (0.5, 0.5, 0.5)])
        contacts = Contacts(bodies, case(walls=()))
        if contacts._prepare(bodies, bodies.fixed, 0.0, 0.0)[0]:
            apart = normal_of(contacts._table, contacts._touch(), 0)[0]
            assert -apart <= deep * (1.0 + 1e-9)
            touched += apart < 0.0
    assert touched > 50
