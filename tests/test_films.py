"""Water in gaps too thin for a particle: what a body feels of it on the bed, against another body, under a drop."""

import numpy as np
import pytest
from test_water import POOL, SQUARE, TANK, simulation

from parsim.coupling.gaps import gap_to_plane
from parsim.errors import InputError
from parsim.geometry.nearby import near_bodies
from parsim.particles.state import SHUT_IN
from parsim.solid.shapes import BoxShape
from parsim.solid.shapes.forms import forms_of
from parsim.solid.shapes.kernels import ahead

WEIGHT = 9810.0 * 0.06**2  # of the water that the square displaces, N/m
SPREAD = 0.1  # of the lift of a fixed body six particles thick, also in the open; without films it is -4 on the bed
FIXED = SQUARE | {"fixed": True}


def mean_load(bodies, data=POOL, until=0.3):
    """Mean load of the water on each body between 0.1 s and `until`: (bodies, 6)."""
    s = simulation(data | {"bodies": bodies, "run": {"until": 1.0, "settle": 1.0}})
    loads = []
    while s.time < until:
        s.step()
        if s.time > 0.1:
            loads.append(s.bodies.water_load.copy())
    return np.mean(loads, axis=0)


@pytest.mark.long
def test_a_body_on_the_bed_is_lifted_like_any_other():
    (load,) = mean_load([FIXED | {"position": [0.2, 0.5, 0.03]}])
    assert load[2] == pytest.approx(WEIGHT, rel=SPREAD)
    assert abs(load[0]) < 0.1 * WEIGHT and abs(load[4]) < 0.1 * WEIGHT * 0.03


@pytest.mark.long
def test_a_body_at_a_wall_is_not_held_there():
    (load,) = mean_load([FIXED | {"position": [0.03, 0.5, 0.15]}])
    push = 9810.0 * 0.15 * 0.06  # of the water on its other side
    assert abs(load[0]) < 0.1 * push
    assert load[2] == pytest.approx(WEIGHT, rel=SPREAD)


@pytest.mark.long
def test_touching_bodies_are_not_pressed_together():
    left, right = mean_load(
        [
            FIXED | {"name": "left", "position": [0.17, 0.5, 0.15]},
            FIXED | {"name": "right", "position": [0.23, 0.5, 0.15]},
        ]
    )
    push = 9810.0 * 0.15 * 0.06
    assert abs(left[0]) < 0.1 * push and abs(right[0]) < 0.1 * push
    assert left[2] + right[2] == pytest.approx(2 * WEIGHT, rel=SPREAD)


@pytest.mark.long
@pytest.mark.parametrize("count", [2, pytest.param(3, marks=pytest.mark.long)])
def test_touching_bodies_on_the_bed_are_lifted_too(count):
    loads = mean_load([FIXED | {"name": f"b{k}", "position": [0.14 + 0.06 * k, 0.5, 0.03]} for k in range(count)])
    assert loads[:, 2] == pytest.approx(WEIGHT, rel=2 * SPREAD)
    assert np.abs(loads[:, 0]).max() < 0.1 * 9810.0 * 0.27 * 0.06


@pytest.mark.long
def test_touching_bodies_do_not_drive_themselves():
    small = FIXED | {"name": "small", "position": [0.14, 0.5, 0.3]}
    large = FIXED | {"name": "large", "position": [0.23, 0.5, 0.3], "shape": {"size": [0.12, 1.0, 0.12]}}
    loads = mean_load([small, large])
    assert abs(loads[0, 0]) < 0.2 * 0.5 * 9810.0 * 0.03**2 and abs(loads[:, 0].sum()) < 0.2 * 0.5 * 9810.0 * 0.06**2


def test_a_drop_does_not_lift_what_it_falls_on():
    drop = {"fill": [{"min": [0.1, 0.0, 0.06], "max": [0.11, 1.0, 0.07]}], "speed": 2.0}
    (load,) = mean_load([FIXED | {"position": [0.1, 0.5, 0.03]}], TANK | {"water": drop}, until=0.2)
    assert load[2] < 0.02 * WEIGHT


@pytest.mark.parametrize("speed", [
    pytest.param(0.0, marks=pytest.mark.slow), pytest.param(0.3, marks=pytest.mark.long),
])  # fmt: skip
def test_a_plate_that_sinks_comes_to_lie_on_the_bed_and_not_on_the_drops_under_it(speed):
    """Drops shut in under it carried it like balls: it slid on for seconds, and the tank rang by spacings of head."""
    plate = SQUARE | {"shape": {"size": [0.16, 1.0, 0.03]}, "density": 2800.0, "position": [0.14, 0.5, 0.05]}
    s = simulation(POOL | {"bodies": [plate | {"velocity": [speed, 0.0, 0.0]}]})
    rows = []
    while s.time < 1.5:
        s.step()
        if s.time > 1.2:
            rows.append([s.bodies.contact_load[0, 2], abs(s.bodies.velocity[0, 0])])
    up, slide = np.mean(rows, axis=0)
    assert up == pytest.approx(1800.0 * 9.81 * 0.16 * 0.03, rel=0.05) and slide < 1e-4


def test_patches_cover_the_body():
    films = simulation(POOL | {"bodies": [FIXED | {"position": [0.2, 0.5, 0.15]}]}).solids.films
    assert films._area.sum() == pytest.approx(4 * 0.06)
    assert films._rim.sum() == 8, "in 2D the rim of a face is its two ends"


@pytest.mark.parametrize("period", [(np.inf, np.inf, np.inf), (2.0, np.inf, np.inf), (2.0, 2.0, np.inf)])
def test_bodies_that_are_near_each_other_are_found(period):
    rng, period = np.random.default_rng(7), np.array(period)
    place, span = rng.uniform(-1.0, 1.0, (60, 3)), rng.uniform(0.02, 0.3, 60)
    first, others = near_bodies(place, span, period)
    apart = place[:, None] - place[None, :]
    for axis in np.flatnonzero(np.isfinite(period)):
        apart[:, :, axis] -= period[axis] * np.rint(apart[:, :, axis] / period[axis])
    close = ((apart**2).sum(2) < (span[:, None] + span) ** 2) & ~np.eye(60, dtype=bool)
    for b in range(60):
        assert sorted(others[first[b] : first[b + 1]]) == list(np.flatnonzero(close[b]))


def test_gaps_are_measured_along_the_normal():
    ends = [-np.inf, -np.inf, -np.inf, 0.3, np.inf, np.inf]
    floor, side = np.array([0.0, 0.0, 1.0, 0.0, *ends]), np.array([-1.0, 0.0, 0.0, -0.5, *ends])
    down, slanted = (0.0, 0.0, -1.0), (0.0, 0.6, -0.8)
    assert gap_to_plane((0.2, 0.0, 0.03), down, floor) == pytest.approx(0.03)
    assert gap_to_plane((0.2, 0.0, 0.04), slanted, floor) == pytest.approx(0.05)
    assert gap_to_plane((0.2, 0.0, 0.03), down, side) == np.inf
    assert gap_to_plane((0.31, 0.0, 0.03), down, floor) == np.inf, "beyond the open side"
    forms = forms_of([BoxShape(size=(0.2, 0.4, 0.6))], False)
    assert ahead(forms, 0, (0.0, 0.0, 0.35), down, 0.01) == pytest.approx(0.05)
    assert ahead(forms, 0, (0.0, 0.0, 0.295), down, 0.01) == pytest.approx(-0.005), "an overlap closes the gap"
    assert ahead(forms, 0, (0.11, 0.0, 0.35), down, 0.01) == np.inf, "beside it"
    assert ahead(forms, 0, (0.0, 0.0, -0.4), down, 0.01) == np.inf, "behind"


def test_water_inside_a_body_is_turned_out_through_the_nearest_face():
    s = simulation(POOL | {"bodies": [SQUARE | {"position": [0.2, 0.5, 0.15], "velocity": [0.0, 0.0, 0.5]}]})
    p, near, b = s.domain.particles, s.near, s.bodies
    inside, outside = near.fluid[np.argsort(np.hypot(p.x[near.fluid] - 0.2, p.z[near.fluid] - 0.15))[:2]]
    p.x[inside], p.z[inside], p.w[inside] = 0.2, 0.178, -1.0
    pose = b.position, b.quaternion
    s.solids.stray.turn_out(s.flow(), pose, s.solids.films.around(np.zeros(4), *pose), 1e-4)
    assert p.w[inside] == pytest.approx(0.5 + 0.002 / (5 * 0.01 / s.case.speed)) and p.u[inside] == 0.0
    assert p.w[outside] == p.u[outside] == 0.0


def led(bodies, place):
    """Class of a particle of water put at `place` (x, z), m, and how it is led, (2,), m/s."""
    s = simulation(POOL | {"bodies": bodies})
    p, b, stray = s.domain.particles, s.bodies, s.solids.stray
    row = np.argmin(np.hypot(p.x[stray.beside] - place[0], p.z[stray.beside] - place[1]))
    i, pose = stray.beside[row], (b.position, b.quaternion)
    p.x[i], p.z[i] = place
    stray.turn_out(s.flow(), pose, s.solids.films.around(np.zeros(4), *pose), 1e-3)
    return p.surface[i], stray._lead[row, [0, 2]]


def test_what_is_shut_in_is_led_away_from_where_solids_touch():
    disc = FIXED | {"shape": {"kind": "disc", "diameter": 0.12}, "position": [0.2, 0.5, 0.06]}
    wide = FIXED | {"shape": {"size": [0.12, 1.0, 0.06]}, "position": [0.2, 0.5, 0.034]}
    for side in (-1.0, 1.0):
        for body in (disc, wide):
            found, way = led([body], (0.2 + side * 0.02, 0.002))
            assert found == SHUT_IN and side * way[0] > 0.2 and abs(way[1]) < 0.12
    leaning = wide | {"angles": [0.0, 4.0, 0.0], "position": [0.2, 0.5, 0.0343]}
    found, way = led([leaning], (0.19, 0.002))
    assert found == SHUT_IN and way[0] < -0.2, "the gap is wider upstream, as the body leans downstream"
    left, right = (FIXED | {"name": name, "position": [x, 0.5, 0.15]} for name, x in (("left", 0.17), ("right", 0.234)))
    found, way = led([left, right], (0.202, 0.17))
    assert found == SHUT_IN and way[1] < -0.2, "not up between them"


def test_what_is_shut_in_does_not_meet_in_one_place():
    """Three drops under a plate, a 50th of a spacing apart: in a pocket, two came to one place, and were no numbers."""
    wide = FIXED | {"shape": {"size": [0.12, 1.0, 0.06]}, "position": [0.2, 0.5, 0.034]}
    s = simulation(POOL | {"bodies": [wide]})
    p, b, stray = s.domain.particles, s.bodies, s.solids.stray
    at = stray.beside[np.argsort(np.hypot(p.x[stray.beside] - 0.18, p.z[stray.beside]))[:3]]
    p.x[at], p.z[at], pose = 0.18 + 0.0002 * np.arange(3), 0.002, (b.position, b.quaternion)
    for _ in range(40):
        stray.turn_out(s.flow(), pose, s.solids.films.around(np.zeros(4), *pose), 1e-3)
        stray.lead_out(p, 1e-3)
    assert (p.surface[at] == SHUT_IN).all() and np.diff(np.sort(p.x[at])).min() > 0.2 * s.case.spacing


def test_water_on_bodies_that_stand_in_each_other_is_not_shut_in():
    left, right = (FIXED | {"name": name, "position": [x, 0.5, 0.15]} for name, x in (("left", 0.18), ("right", 0.22)))
    assert led([left, right], (0.2, 0.184))[0] != SHUT_IN


@pytest.mark.parametrize("x", [0.01, 0.031, 0.37])
def test_a_body_that_begins_at_a_periodic_side_is_refused_by_name(x):
    sides = {"max": POOL["box"]["max"], "faces": {"x_min": "periodic", "x_max": "periodic"}}
    with pytest.raises(InputError, match="bodies.square.position = .*: reaches the periodic side"):
        simulation(POOL | {"box": sides, "bodies": [SQUARE | {"position": [x, 0.5, 0.15]}]})


@pytest.mark.long
def test_a_body_off_a_periodic_side_is_carried():
    sides = {"max": POOL["box"]["max"], "faces": {"x_min": "periodic", "x_max": "periodic"}}
    (load,) = mean_load([FIXED | {"position": [0.2, 0.5, 0.03]}], POOL | {"box": sides}, until=0.15)
    assert load[2] == pytest.approx(WEIGHT, rel=SPREAD) and abs(load[0]) < SPREAD * WEIGHT
