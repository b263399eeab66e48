"""Ice through planes, jams, blocks at a cover, forces on piers and arches, on made-up tracks."""

import math

import numpy as np
import pytest

from parsim.river import blocks, piers
from parsim.river.arches import arches, at_pier, gap, neighbours, outline
from parsim.river.jam import Jam, extent, jam, kind, window
from parsim.river.planes import discharge, mean_speed, passed, stored

TIMES = np.arange(0.0, 100.05, 0.1)
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def test_ice_that_passes_is_counted_once_and_back_again():
    x = np.array([[0.0, 0.9], [0.6, 1.1], [1.2, 0.8], [1.4, 1.3]])
    volume = np.array([2.0, 0.5])
    assert passed(x, volume, 1.0).tolist() == [0.0, 0.5, 2.0, 2.5]


def test_tracks_go_on_beyond_sides_that_repeat():
    """A floe that goes round a box of 4 m three times passes a plane three times."""
    x = np.linspace(0.5, 12.4, 50)[:, None]
    assert passed(x, np.array([0.3]), 3.0, 4.0)[-1] == pytest.approx(0.9)


def test_floes_come_and_go():
    """What is not there yet does not pass when it comes; what leaves beyond has passed, and does not come back."""
    nan = math.nan
    x = np.array([[0.5, nan], [1.5, nan], [nan, 1.2], [nan, 1.4]])
    assert passed(x, np.array([1.0, 10.0]), 1.0).tolist() == [0.0, 1.0, 1.0, 1.0]
    assert stored(np.array([[0.5, nan], [nan, nan]]), np.array([1.0, 10.0])).tolist() == [1.0, 0.0]


def test_the_discharge_is_the_volume_over_the_time():
    times = np.linspace(0.0, 10.0, 101)
    flow = discharge(times, 0.4 * times, 2.0)
    assert flow[1:] == pytest.approx(0.4) and flow[0] == 0.0


def test_the_speed_in_a_reach_is_that_of_the_volume_there():
    x = np.array([[0.5, 1.5, 9.0], [5.0, 6.0, 7.0]])
    u = np.array([[1.0, 2.0, 50.0], [1.0, 1.0, 1.0]])
    found = mean_speed(x, u, np.array([3.0, 1.0, 1.0]), (0.0, 2.0))
    assert found[0] == pytest.approx(1.25) and math.isnan(found[1])


def stood(*spans, supply=0.1, speed=0.5):
    """Passed volume and mean speed of ice that stands in the spans of TIMES and drifts in all others."""
    moves = np.ones(len(TIMES))
    for begin, end in spans:
        moves[np.abs(TIMES - 0.5 * (begin + end)) <= 0.5 * (end - begin) + 1e-9] = 0.0
    through = np.concatenate([[0.0], np.cumsum(np.diff(TIMES) * supply * 0.5 * (moves[1:] + moves[:-1]))])
    return through, speed * moves


@pytest.mark.parametrize(("spans", "lasts"), [
    ([(20.0, 60.0)], "held"), ([(20.0, 100.0)], "held"), ([(20.0, 28.0)], "transient"), ([(90.0, 100.0)], "open"),
])  # fmt: skip
def test_a_jam_is_found_with_its_time_and_whether_it_holds(spans, lasts):
    found = jam(TIMES, *stood(*spans), 0.1, 0.5, 5.0)
    # 5 % of the supply may pass in a window: it begins up to a 20th of the window before the ice stands
    assert found.lasts == lasts and found.begin == pytest.approx(spans[0][0], abs=0.31)
    assert found.end == pytest.approx(spans[0][1], abs=0.31)


def test_what_is_no_jam():
    assert jam(TIMES, *stood(), 0.1, 0.5, 5.0) is None
    assert jam(TIMES, *stood((20.0, 24.0)), 0.1, 0.5, 5.0) is None, "shorter than the window"
    through, speed = stood((20.0, 60.0))
    assert jam(TIMES, through, np.full(len(TIMES), 0.03), 0.1, 0.5, 5.0) is None, "it creeps"
    assert jam(TIMES, 0.006 * TIMES, speed, 0.1, 0.5, 5.0) is None, "it leaks"
    assert jam(TIMES, through, np.where(speed > 0.0, speed, np.nan), 0.1, 0.5, 5.0) is None, "there is no ice"
    assert jam(TIMES[:20], through[:20], 0.0 * speed[:20], 0.1, 0.5, 5.0) is None, "the run is shorter"
    assert jam(TIMES, through, 0.0 * speed, 0.1, 0.0, math.inf) is None, "nothing flows"
    assert jam(TIMES, *stood((0.0, 9.0)), 0.1, 0.5, 5.0) is None, "it rests at the start"
    assert jam(TIMES, *stood((0.0, 9.0), (20.0, 28.0)), 0.1, 0.5, 5.0).begin == pytest.approx(20.0, abs=0.31)


def test_ice_that_leaves_the_reach_empty_for_a_moment_only_interrupts_a_jam():
    through, speed = stood((10.0, 90.0))
    speed[500] = np.nan
    first = jam(TIMES, through, speed, 0.1, 0.5, 5.0)
    assert first.lasts == "held" and first.end == pytest.approx(50.0, abs=0.2)


def test_a_jam_that_holds_is_told_rather_than_one_before_that_let_go():
    found = jam(TIMES, *stood((10.0, 17.0), (30.0, 70.0), (80.0, 99.0)), 0.1, 0.5, 5.0)
    assert found.lasts == "held" and (found.begin, found.end) == pytest.approx((30.0, 70.0), abs=0.31)
    found = jam(TIMES, *stood((10.0, 17.0), (30.0, 38.0)), 0.1, 0.5, 5.0)
    assert found.lasts == "transient" and found.begin == pytest.approx(10.0, abs=0.31)


def test_a_jam_that_lasts_exactly_three_windows_holds():
    through = np.zeros(len(TIMES))
    speed = np.where(TIMES < 15.05, 0.0, 9.0)
    found = jam(TIMES, through, speed, 0.1, 0.5, 5.0)
    assert found == Jam(0.0, pytest.approx(15.0), "held")


def test_the_window_is_five_seconds_or_ten_floes():
    assert window(0.1, 0.5) == 5.0 and window(0.5, 0.5) == 10.0 and window(0.5, 0.0) == math.inf


def test_the_place_of_a_jam_reaches_to_the_first_ice_that_moves():
    x = np.arange(0.5, 10.0)
    speed = np.where((x > 4.0) & (x < 8.0), 0.01, 0.5)
    assert extent(x, speed, 0.5, 9.0) == (4.0, 8.0)
    assert extent(x, speed, 0.5, 6.0) == (4.0, 6.0)
    speed[x == 5.5] = np.nan
    assert extent(x, speed, 0.5, 9.0) == (6.0, 8.0)
    assert extent(x, speed, 0.5, 9.0, 1.0) == (4.0, 8.0), "no gap is less than a floe"
    assert all(math.isnan(end) for end in extent(x, np.full(10, 0.5), 0.5, 9.0))
    assert extent(x, np.zeros(10), 0.5, 20.0) == (0.0, 10.0)


def test_kinds_of_jam():
    assert [kind(1.2, False), kind(1.5, False), kind(1.2, True)] == ["surface", "thickened", "grounded"]
    assert [kind(math.nan, False), kind(math.nan, True)] == ["unknown", "grounded"]


COVER = blocks.Cover(2.0, 4.0)


def way(x, tilt):
    """The path of a block, row by row, a second each, below the cover."""
    return blocks.Path(np.arange(float(len(x))), np.array(x), np.array(tilt), np.ones(len(x), bool))


@pytest.mark.parametrize(("x", "tilt", "name"), [
    ((0.5, 1.5, 1.8, 1.8), (0.0, 2.0, 14.0, 5.0), "stable"),
    ((0.5, 1.5, 1.8, 1.8), (0.0, 2.0, 30.0, 20.0), "undecided"),
    ((0.5, 1.8, 2.15, 3.0), (0.0, 10.0, 40.0, 50.0), "submerged"),
    ((0.5, 1.8, 2.15, 9.0), (0.0, 10.0, 20.0, 5.0), "submerged"),
    ((0.5, 1.8, 2.05, 2.05), (0.0, 10.0, 40.0, 40.0), "stuck"),
    ((0.5, 1.8, 2.15, 2.6, 2.6), (0.0, 60.0, 60.0, 50.0, 50.0), "stuck"),
    ((0.5, 1.8, 2.2, 5.0), (0.0, 60.0, 70.0, 20.0), "passed"),
    ((0.5, 1.8, 2.2, 5.0), (0.0, 95.0, 170.0, 180.0), "under-turned"),
    ((0.5, 0.6, 0.6, 0.6), (0.0, 0.0, 0.0, 0.0), "undecided"),
    ((0.5, 1.5, 1.8, 1.85), (0.0, 2.0, 14.0, 5.0), "undecided"),  # it still moves
])  # fmt: skip
def test_what_becomes_of_a_block(x, tilt, name):
    """A block of 0.4 m; that centre is a quarter of its length under the cover at 2.1 m."""
    path = way(x, tilt)
    found = blocks.block(path, 0.4, COVER, 0.5)
    if name in ("submerged", "stuck"):
        beside = blocks.block(path._replace(below=np.zeros(len(x), bool)), 0.4, COVER, 0.5)
        assert beside.name == ("passed" if x[-1] > COVER.end else "undecided"), "it is over the cover or beside it"
    assert found.name == name and found.tilt == max(tilt)
    assert found.critical == (name not in ("stable", "undecided"))


def test_a_block_that_still_moves_is_undecided_and_one_that_left_is_known():
    assert blocks.block(way([1.5, 1.8], [0.0, 0.0]), 0.4, COVER, 0.5).name == "undecided"
    gone = way([1.8, 2.2, 4.5, math.nan], [0.0, 60.0, 50.0, math.nan])
    assert blocks.block(gone, 0.4, COVER, 0.5).name == "passed"
    beyond = blocks.block(way([4.5, 5.0], [0.0, 0.0]), 0.4, COVER, 0.5)
    assert beyond.name == "undecided" and not beyond.critical, "it began downstream of the cover"
    assert blocks.block(way([math.nan] * 3, [0.0] * 3), 0.4, COVER, 0.5).name == "undecided"
    swings = way([1.5, 1.8, 1.7, 1.8, 1.7, 1.8], [0.0] * 6)._replace(time=0.2 * np.arange(6.0))
    assert blocks.block(swings, 0.4, COVER, 0.5).name == "undecided", "though it is where it was before"


@pytest.mark.parametrize("start", [0.0, 30.0])
def test_a_tilt_is_told_from_where_a_block_began(start):
    """Quaternions of turns about y from a start that is turned about z, and tilted itself."""
    half = np.radians([start, start + 40.0, start + 100.0, start + 180.0]) / 2.0
    about_y = np.stack([np.cos(half), 0 * half, np.sin(half), 0 * half], 1)
    assert blocks.tilts(blocks.ups(about_y)) == pytest.approx([0.0, 40.0, 100.0, 180.0], abs=1e-5)
    about_z = np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], 1)
    assert blocks.tilts(blocks.ups(about_z)) == pytest.approx(0.0, abs=1e-5)


def peaks(force, dt, each):
    """`piers.Peaks` of a force (steps,) in rows of so many steps."""
    rows = force.reshape(-1, each)
    span = np.full(len(rows), each * dt)
    return piers.Peaks(np.cumsum(span), span, rows.sum(axis=1) * dt, rows.min(axis=1), rows.max(axis=1))


def test_means_over_short_times_are_those_of_all_steps():
    dice, dt = np.random.default_rng(5), 0.0005
    force = dice.normal(10.0, 50.0, 4000)
    seen = peaks(force, dt, 10)
    total = np.concatenate([[0.0], np.cumsum(force)])
    for length in (0.01, 0.1):
        steps = round(length / dt)
        ends = np.arange(steps, 4001, 10)
        assert piers.running_mean(seen, length) == pytest.approx((total[ends] - total[ends - steps]) / steps, abs=1e-9)
    assert len(piers.running_mean(seen, 3.0)) == 0


def test_no_peak_falls_between_rows():
    force = np.zeros(2000)
    force[777], force[1300] = -900.0, 500.0
    found = piers.percentiles(peaks(force, 0.0005, 20))
    assert found[0, 0] == 900.0 and found[1, 0] == pytest.approx(900.0 * 0.0005 / 0.01)
    assert found[2, 0] == pytest.approx(900.0 * 0.0005 / 0.1)
    assert (np.diff(found, axis=1) <= 0.0).all() and found[0, 3] == 0.0
    assert np.isnan(piers.percentiles(peaks(force[:40], 0.0005, 20), (0.1,))).all()


def test_percentiles_of_a_ramp():
    force = np.arange(1000.0)
    assert piers.percentiles(peaks(force, 0.001, 1), (0.0,))[0] == pytest.approx([999.0, 998.001, 989.01, 949.05])
    assert piers.percentiles(peaks(np.full(1000, -7.0), 0.001, 5)) == pytest.approx(7.0)


def test_rows_do_not_tell_of_means_over_less_than_them():
    """A hit of 900 N for 2 ms in a row of 50 ms: whether its mean over 10 ms is 180 N or less is not known."""
    force = np.zeros(2000)
    force[700:704] = 900.0
    found = piers.percentiles(peaks(force, 0.0005, 100))
    assert found[0, 0] == 900.0 and np.isnan(found[1]).all() and found[2, 0] == pytest.approx(18.0)


def test_arches_are_chains_from_pier_to_pier():
    pairs = [("P1", "a"), ("a", "b"), ("c", "b"), ("P2", "c"), ("c", "d"), ("P3", "e"), ("a", "c")]
    assert arches(pairs, ["P1", "P2", "P3"]) == [["P1", "a", "c", "P2"]]
    assert at_pier([*pairs, ("f", "P1"), ("P1", "a")], "P1") == 2 and at_pier(pairs, "P4") == 0


def test_no_arch_goes_through_a_pier_or_without_a_floe():
    assert arches([("P1", "a"), ("a", "P2"), ("P2", "b"), ("b", "P3")], ["P1", "P2", "P3"]) == [
        ["P1", "a", "P2"], ["P2", "b", "P3"],
    ]  # fmt: skip
    assert arches([("P1", "P2")], ["P1", "P2"]) == [] and arches([], ["P1"]) == []


def test_outlines_are_convex():
    points = np.concatenate([SQUARE, SQUARE, [[0.5, 0.5], [0.5, 0.0], [0.2, 0.9]]])
    found = outline(points)
    assert len(found) == 4 and {tuple(p) for p in found} == {tuple(p) for p in SQUARE}
    assert len(outline(SQUARE[:2])) == 2


@pytest.mark.parametrize(("move", "distance"), [
    ((1.3, 0.0), 0.3), ((1.3, 1.4), 0.5), ((0.5, 0.5), 0.0), ((1.0, 0.0), 0.0), ((0.0, 0.0), 0.0), ((0.0, -3.0), 2.0),
])  # fmt: skip
def test_gaps_of_squares(move, distance):
    assert gap(SQUARE, SQUARE + move) == pytest.approx(distance)


def test_a_cross_has_no_gap_and_a_corner_reaches_a_side():
    bar = (SQUARE - 0.5) * (4.0, 0.2)
    assert gap(bar, bar[:, ::-1][::-1]) == 0.0
    turned = (SQUARE - 0.5) @ np.array([[1.0, 1.0], [-1.0, 1.0]]) / math.sqrt(2.0)
    assert gap(SQUARE, turned + (1.0 + math.sqrt(0.5) + 0.1, 0.5)) == pytest.approx(0.1)


def test_neighbours_are_those_within_reach_round_the_box_too():
    outlines = [SQUARE, SQUARE + (1.04, 0.0), SQUARE + (2.2, 0.0), SQUARE + (8.97, 0.0)]
    assert neighbours(outlines, 0.05) == [(0, 1)]
    assert neighbours(outlines, 0.05, (10.0, math.inf)) == [(0, 1), (0, 3)]
    assert neighbours([], 0.05) == []
