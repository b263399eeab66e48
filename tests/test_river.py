"""Measures of ice and water on columns, on made-up scenes whose answers are known."""

import math

import numpy as np
import pytest
from river_scenes import box, cylinder, sphere, still, surfaces

from parsim.river import ice
from parsim.river.columns import columns_of, means
from parsim.river.profiles import across, energy_slope, head, head_loss, mean_between, through
from parsim.river.raster import cuts_of
from parsim.river.water import water_of, window

PLAN = columns_of((0.0, 0.0, 0.0), (4.0, 2.0, 1.0), 0.5)


def seen(*bodies, columns=PLAN):
    return cuts_of(*surfaces(*bodies), columns)


def test_columns_fill_the_box_and_know_what_is_in_them():
    columns = columns_of((1.0, -1.0, 0.0), (3.0, 0.0, 1.0), 0.3, (True, False))
    assert columns.shape == (7, 3) and columns.step * columns.shape == pytest.approx([2.0, 1.0])
    number = columns.numbers(np.array([1.01, 2.99, 3.01, 2.0]), np.array([-0.99, -0.01, -0.5, 0.2]))
    assert number.tolist() == [0, 20, 1, -1]
    assert columns.numbers(columns.x.repeat(3), np.tile(columns.y, 7)).tolist() == list(range(21))
    assert columns_of((0.0, 0.0), (2.0, 1.0), 0.5, planar=True).shape == (4, 1)


def test_means_are_nan_where_there_is_nothing():
    number, values = np.array([0, 0, 5, -1]), np.array([1.0, 3.0, 7.0, 100.0])
    found = means(number, values, np.array([3.0, 1.0, 2.0, 1.0]), PLAN)
    assert found[0, 0] == 1.5 and found[1, 1] == 7.0 and np.isnan(found).sum() == found.size - 2


def test_a_floe_covers_its_own_area_and_has_its_own_volume():
    cuts = seen((box(0.75, 0.5, 0.2), (1.125, 0.75, 0.5)))
    found = ice.concentration(cuts, PLAN)
    assert found[1, 1] == 0.5 and found[2, 1] == 1.0 and found.sum() == 1.5
    assert ice.solid_thickness(cuts, PLAN) == pytest.approx(0.2 * found)


@pytest.mark.parametrize(("shape", "angles"), [
    (box(0.9, 0.7, 0.2), (0.0, 0.0, 0.0)), (box(0.9, 0.7, 0.2), (30.0, -50.0, 20.0)),
    (sphere(1.0), (0.0, 0.0, 0.0)), (cylinder(0.8, 0.3), (0.0, 0.0, 7.0)), (cylinder(0.8, 0.3), (0.0, 90.0, 33.0)),
])  # fmt: skip
def test_any_body_has_its_volume_wherever_it_is(shape, angles):
    """Footprints of all shapes are closed: a pixel that a line leaves is one that it enters, at any angle."""
    dice, fine = np.random.default_rng(3), columns_of((0.0, 0.0, 0.0), (4.0, 2.0, 1.0), 0.125)
    points, quads, _ = surfaces((shape, (0.0, 0.0, 0.0), angles))
    own = shape_volume(points, quads)
    for _ in range(5):
        cuts = seen((shape, (*dice.uniform((0.8, 0.8), (3.2, 1.2)), 0.5), angles), columns=fine)
        every = np.zeros(cuts.pixel.max() + 1)
        np.add.at(every, cuts.pixel, cuts.side)
        assert (every == 0.0).all()
        assert ice.solid_thickness(cuts, fine).sum() * 0.125**2 == pytest.approx(own, rel=0.03)


def shape_volume(points, quads):
    """Volume of a closed surface, by cones to its quads."""
    a, b, c, d = (points[quads[:, k]] for k in range(4))
    six = np.einsum("ij,ij->i", a, np.cross(b, c)) + np.einsum("ij,ij->i", a, np.cross(c, d))
    return six.sum() / 6.0


def test_faces_that_meet_on_a_pixel_count_once():
    """Edges and a diagonal run exactly through the middles of pixels."""
    size = 2 * 8 * PLAN.step[0] / 8
    middle = (1.0 + PLAN.step[0] / 16, 1.0 + PLAN.step[0] / 16, 0.5)
    cuts = seen((box(size, size, 0.1), middle))
    assert ice.solid_thickness(cuts, PLAN).sum() * 0.25 == pytest.approx(size * size * 0.1, rel=1e-12)


def test_a_union_counts_once_and_what_lies_over_it_adds_thickness():
    below, above = (box(0.5, 0.5, 0.1), (1.25, 0.75, 0.3)), (box(0.5, 0.5, 0.1), (1.25, 0.75, 0.6))
    cuts = seen(below, above)
    assert ice.concentration(cuts, PLAN)[2, 1] == 1.0 and ice.concentration(cuts, PLAN).sum() == 1.0
    assert ice.solid_thickness(cuts, PLAN)[2, 1] == pytest.approx(0.2)
    inner = ice.heights(cuts, PLAN)
    assert inner[2, 1] == pytest.approx([0.25 + 0.05 * 0.2, 0.65 - 0.05 * 0.2])
    jam = ice.jam_thickness(inner, 0.1)
    assert jam[2, 1] == pytest.approx(0.4 - 0.02 + 0.01)
    assert ice.porosity(ice.solid_thickness(cuts, PLAN), jam)[2, 1] == pytest.approx(1.0 - 0.2 / 0.39)
    assert ice.layers(ice.solid_thickness(cuts, PLAN), 0.1)[2, 1] == pytest.approx(2.0)
    assert np.isnan(inner).sum() == 2 * (PLAN.shape[0] * PLAN.shape[1] - 1)


@pytest.mark.parametrize("side", [0.5, 0.25])
def test_one_flat_floe_has_its_thickness_as_that_of_a_jam(side):
    cuts = seen((box(side, side, 0.08), (1.25, 0.75, 0.3)))
    assert ice.jam_thickness(ice.heights(cuts, PLAN), 0.08)[2, 1] == pytest.approx(0.08)


def test_the_speed_of_ice_is_that_of_its_volume():
    cuts = seen((box(0.5, 0.5, 0.3), (1.25, 0.75, 0.3)), (box(0.5, 0.5, 0.1), (1.25, 0.75, 0.6)))
    found = ice.speed(cuts, np.array([1.0, 3.0]), PLAN)
    assert found[2, 1] == pytest.approx(1.5) and np.isnan(found).sum() == found.size - 1


def test_a_floe_at_a_side_that_repeats_is_on_both_sides_of_the_plan():
    floe = (box(0.5, 0.5, 0.1), (0.0, 0.25, 0.5))
    round_ = columns_of((0.0, 0.0, 0.0), (4.0, 2.0, 1.0), 0.5, (True, False))
    found = ice.concentration(seen(floe, columns=round_), round_)
    assert found[0, 0] == 0.5 and found[-1, 0] == 0.5 and found.sum() == 1.0
    assert ice.concentration(seen(floe), PLAN).sum() == 0.5


def test_a_plane_has_columns_of_a_metre_across():
    columns = columns_of((0.0, 0.0, 0.0), (2.0, 1.0, 1.0), 0.1, planar=True)
    cuts = seen((box(0.35, 1.0, 0.2), (0.575, 0.5, 0.5)), columns=columns)
    assert ice.concentration(cuts, columns)[:, 0].sum() == pytest.approx(3.5)
    assert ice.solid_thickness(cuts, columns).sum() * 0.1 == pytest.approx(0.35 * 0.2)


def test_no_bodies_cover_nothing():
    cuts = cuts_of(np.zeros((0, 3)), np.zeros((0, 4), int), np.zeros(0, int), PLAN)
    assert ice.concentration(cuts, PLAN).sum() == 0.0 and np.isnan(ice.heights(cuts, PLAN)).all()
    assert np.isnan(ice.speed(cuts, np.zeros(0), PLAN)).all()


def test_the_level_is_that_of_the_pressure_under_ice_too():
    """A lattice that ends 0.1 m lower under a floe of that draught, whose pressures are those of one level."""
    columns = columns_of((0.0, 0.0, 0.0), (2.0, 0.4, 0.5), 0.2)
    frame = still(0.02, (0.0, 0.0, 0.0), (2.0, 0.4, 0.3), rise=0.001)
    covered = (frame["position"][:, 0] > 1.0) & (frame["position"][:, 2] > 0.2)
    frame = {name: values[~covered] for name, values in frame.items()}
    water = water_of(frame, columns, 0.02, 9810.0)
    assert water.level == pytest.approx(np.repeat(0.3 + 0.001 * columns.x[:, None], 2, axis=1), abs=1e-12)
    assert water.top[0] == pytest.approx(0.3) and water.top[-1] == pytest.approx(0.2)
    assert water.bottom == pytest.approx(0.0) and water.velocity == pytest.approx(0.5)


def test_noise_at_bed_and_surface_and_splash_do_not_reach_the_level():
    columns = columns_of((0.0, 0.0, 0.0), (0.4, 0.4, 0.5), 0.2)
    frame = still(0.02, (0.0, 0.0, 0.0), (0.4, 0.4, 0.2))
    z = frame["position"][:, 2]
    frame["pressure"][(z < 0.03) | (z > 0.17)] += 5000.0
    drop = {"position": [[0.1, 0.1, 0.45]], "velocity": [[9.0, 0.0, 0.0]], "pressure": [0.0], "class": [3]}
    frame = {name: np.concatenate([values, drop[name]]) for name, values in frame.items()}
    water = water_of(frame, columns, 0.02, 9810.0)
    assert water.level == pytest.approx(0.2, abs=1e-12) and water.velocity == pytest.approx(0.5)


def test_dry_columns_have_no_level():
    columns = columns_of((0.0, 0.0, 0.0), (0.4, 0.2, 0.5), 0.2)
    water = water_of(still(0.02, (0.0, 0.0, 0.0), (0.2, 0.2, 0.2)), columns, 0.02, 9810.0)
    assert np.isfinite(water.level[0]).all() and all(np.isnan(each[1]).all() for each in water)
    empty = water_of({"position": np.zeros((0, 3)), "velocity": np.zeros((0, 3)), "pressure": np.zeros(0),
                      "class": np.zeros(0)}, columns, 0.02, 9810.0)  # fmt: skip
    assert all(np.isnan(each).all() for each in empty)


def test_profiles_leave_out_what_is_not_there():
    values = np.array([[1.0, 2.0, 3.0, np.nan], [np.nan] * 4])
    found = across(values)
    assert found.mean[0] == 2.0 and found.middle[0] == 2.0
    assert (found.low[0], found.high[0]) == pytest.approx((1.2, 2.8))
    assert all(np.isnan(each[1]) for each in found)


def test_means_over_time_take_the_window_or_the_nearest():
    times, values = np.array([0.0, 1.0, 2.0, 3.0]), np.array([[1.0], [np.nan], [3.0], [9.0]])
    assert mean_between(times, values, 0.0, 2.0) == 2.0
    assert mean_between(times, values, 2.6, 2.9) == 9.0


def test_heads_fall_by_what_friction_takes():
    """A channel tilted by 0.002 in uniform flow loses that slope; one in which the level falls besides loses more."""
    x = np.linspace(0.05, 9.95, 100)
    level, speed = np.full(100, 0.2), np.full(100, 0.7)
    energy = head(level, speed, 9.81)
    assert energy == pytest.approx(0.2 + 0.49 / 19.62)
    assert energy_slope(x, energy, 0.002) == pytest.approx(0.002)
    assert head_loss(x, energy, ((2.0, 7.0)), 0.002) == pytest.approx(0.01)
    falling = head(level - 0.001 * x, speed, 9.81)
    assert energy_slope(x, falling, 0.002) == pytest.approx(0.003)
    assert head_loss(x, falling, (2.0, 7.0)) == pytest.approx(0.005)
    step = head(np.where(x < 5.0, 0.22, 0.2), speed, 9.81)
    assert head_loss(x, step, (2.0, 7.0)) == pytest.approx(0.02)
    step[50] = np.nan
    assert head_loss(x, step, (2.0, 7.0)) == pytest.approx(0.02)
    nothing = np.full(100, np.nan)
    assert math.isnan(head_loss(x, nothing, (2.0, 7.0))) and math.isnan(energy_slope(x, nothing))


def test_the_velocity_of_a_section_is_its_discharge_over_its_area():
    """A channel with a slow bank a quarter as deep as its middle."""
    velocity, depth = np.array([[0.2, 1.0, np.nan], [np.nan] * 3]), np.array([[0.5, 2.0, np.nan], [np.nan] * 3])
    found = through(velocity, depth)
    assert found[0] == pytest.approx((0.2 * 0.5 + 2.0) / 2.5) and math.isnan(found[1])


def test_the_window_of_levels_is_five_times_that_of_a_depth():
    assert window(0.2, 9.81) == pytest.approx(5.0 * math.sqrt(0.2 / 9.81))
