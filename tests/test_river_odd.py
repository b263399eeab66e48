"""The measures of rivers that are out of the ordinary: driven, dry, short, still, settled, with a bed."""

import math

import fake_river
import numpy as np
import pytest
from fake_river import ICE, PIER, SPEED
from ground import channel, raster
from matplotlib.text import Text

import parsim
from parsim.errors import InputError
from parsim.report import river as pictures
from parsim.report.build import Page
from parsim.report.sections import river as section
from parsim.river import tables
from parsim.river.arches import arches, at_pier
from parsim.river.reader import River
from parsim.river.verdicts import blocks, on_the_bed, outlines, pairs, verdict
from parsim.study.outcomes import jam_forms

SECTIONS = {"reach": [0.5, 3.5], "head_loss": [1.0, 3.0]}

JAM = {"control": {"end": 3.9}, "jam": {"control": "end", "reach": [0.5, 3.5]}}


def river(folder):
    return River(parsim.open(folder))


def words(river):
    return section.parts(Page(river.run, vtk=False))


def test_a_channel_that_holds_a_discharge_loses_what_drives_it(tmp_path):
    """Its level is even: all that is lost is what the force along x, 0.003 g from 5 s on, has put in."""
    folder = fake_river.make_odd(tmp_path / "out", np.arange(0.0, 10.1, 1.0), [0.0, 10.0], measure=SECTIONS)
    rows = [(k, 0.1 * k, 0.2, 0.2, 0.0, 0.03, 0.003 if k > 50 else 0.0) for k in range(101)]
    fake_river.series(folder, "channel", rows)
    means = river(folder).reach_means(10.0)
    assert means["energy_slope"] == pytest.approx(0.003) and means["head_loss"] == pytest.approx(0.006)
    assert river(folder).reach_means(4.0)["energy_slope"] == pytest.approx(0.0, abs=1e-12)


def test_a_tilted_channel_loses_its_slope(tmp_path):
    folder = fake_river.make_odd(
        tmp_path / "out", [0.0, 1.0], [0.0, 1.0], measure=SECTIONS, gravity=[9.81 * 0.002, 0.0, -9.81]
    )
    fake_river.series(folder, "channel", [])
    assert river(folder).reach_means(1.0)["energy_slope"] == pytest.approx(0.002)


def test_frames_far_apart_have_a_level_before(tmp_path):
    """The first frame, of step 0, has no pressures, and is the only one in the time before."""
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 5.0, 10.0], [0.0, 10.0], first=0)
    seen = river(folder)
    assert seen.before[1] < 5.0 and np.isnan(seen.along(0.0)["level"]).all()
    assert seen.rise(10.0) == pytest.approx(0.0, abs=1e-12) and seen.drift == pytest.approx(SPEED)


def test_a_reach_shorter_than_a_column_is_that_column(tmp_path):
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], measure={"reach": [1.01, 1.02]})
    seen = river(folder)
    means = seen.reach_means(1.0)
    assert (means["velocity"], means["rise"], seen.drift) == pytest.approx((SPEED, 0.0, SPEED))
    assert math.isnan(means["energy_slope"]) and math.isnan(means["head_loss"]) and seen.within.sum() == 1


@pytest.mark.parametrize("bodies", [(), (PIER,), (ICE,)])
def test_a_run_may_lack_bodies_ice_or_piers(tmp_path, bodies):
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], bodies)
    seen = river(folder)
    assert words(seen).count("<img") == (1 if not seen.loose.any() else 4)
    assert np.isfinite(seen.along(1.0)["level"]).all()


def test_ice_that_settles_is_no_jam(tmp_path):
    """It stands still for 8 s before 0, where bodies are damped; loads of that time are none on piers either."""
    folder = fake_river.make_odd(
        tmp_path / "out", [0.0, 1.0], np.arange(0.0, 30.1, 0.5), measure=JAM, run={"until": 60.0, "settle": 8.0}
    )
    floe, still = (1.0, 0.5, 0.36, 1.0, 0.0, 0.0, 0.0), [0.0] * 6
    moves = [(time, floe[0] + SPEED * max(time, 0.0), SPEED * (time >= 0.0)) for time in np.arange(-8.0, 30.1, 0.5)]
    rows = [(k, float(t), "floe", float(x), *floe[1:], float(u), *still[1:]) for k, (t, x, u) in enumerate(moves)]
    fake_river.series(folder, "bodies", rows)
    pushes = [(k, 0.5 * k - 7.5, "all", "pier", "water", 0.5, *[99.0 if k < 16 else 1.0] * 24) for k in range(20)]
    fake_river.series(folder, "peaks", pushes)
    seen = river(folder)
    assert verdict(seen).jam is None and seen.tracks.time[0] == 0.0
    assert seen.peaks("pier", "water", "fx").largest.tolist() == [1.0] * 4


def test_a_run_that_was_stopped_while_it_settled_has_a_page(tmp_path):
    folder = fake_river.make_odd(
        tmp_path / "out", [-8.0], np.arange(-8.0, -7.0, 0.5), measure=JAM, run={"until": 60.0, "settle": 8.0}, first=0
    )
    seen = river(folder)
    assert verdict(seen) is None and section.lines(seen.run) == [] and words(seen)


def test_water_that_stands_before_is_no_measure_of_a_jam(tmp_path):
    rows = np.arange(0.0, 30.1, 0.5)
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0, 1.0], rows, speed=0.0, drift=0.0, measure=JAM))
    assert verdict(seen).jam is None and "is not known" in section.lines(seen.run)[0]
    with pytest.raises(InputError, match="no water flows down the reach"):
        jam_forms(seen.run)


def test_a_jam_that_no_frame_shows_is_told_without_its_place(tmp_path):
    """In the frames the floe rocks, over the rows it stands."""
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 10.0], [0.0], measure=JAM)
    floe = (1.0, 0.5, 0.36, 1.0, *[0.0] * 9)
    fake_river.series(folder, "bodies", [(k, 0.5 * k, "floe", *floe) for k in range(61)])
    seen = river(folder)
    (told,) = section.lines(seen.run)
    assert verdict(seen).kind == "unknown" and told == "Ice jam (unknown) from 0 to 29.77 s: it held."


def test_a_bed_is_no_pier_and_floes_ground_on_it(tmp_path):
    """The ground is a parabola across, 0.3 m high at 0.5 m; one floe is 0.04 m over it, the other one 0.2 m."""
    bed = {"file": str(raster(tmp_path, channel)), "origin": [100.0, 200.5], "datum": 3.7, "resolution": 0.25}
    low, high = (
        ICE | {"name": name, "position": [x, 0.5, z]} for name, x, z in (("low", 1.0, 0.43), ("high", 2.0, 0.58))
    )
    pier = PIER | {"shape": {"size": [0.2, 0.2, 0.4]}, "position": [3.0, 0.5, 0.7]}
    folder = fake_river.make_odd(
        tmp_path / "out", [0.0], [0.0], (pier, low, high), bed=bed, box={"max": [4.0, 1.0, 1.2]},
        water={"speed": 5.0, "fill": [{"min": [0.0, 0.0, 0.0], "max": [4.0, 1.0, 0.6]}]},
    )  # fmt: skip
    seen = river(folder)
    names = seen.run.body_names
    assert [names[k] for k in seen.piers] == ["pier"] and pairs(seen, 0) == []
    assert {names[k] for k in outlines(seen, 0)} == {"pier", "low", "high"}
    assert [names[k] for k in np.flatnonzero(on_the_bed(seen, 0, (0.0, 4.0)))] == ["low"]


def test_only_floes_make_an_arch_and_stand_at_a_pier(tmp_path):
    """A wall touches both piers, and a floe the first of them."""
    two = PIER | {"name": "two", "position": [3.0, 0.1, 0.4]}
    wall = PIER | {"name": "wall", "shape": {"size": [0.2, 0.2, 0.8]}, "position": [3.0, 0.3, 0.4]}
    floe = ICE | {"position": [3.0 - 0.25, 0.5, 0.36]}
    measure = {"piers": ["pier", "two"]}
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0], [0.0], (PIER, two, wall, floe), measure=measure))
    near = pairs(seen, 0)
    assert at_pier(near, 0) == 1 and at_pier(near, 1) == 0 and arches(near, seen.piers) == []


def test_floes_faster_than_the_water_keep_their_colours_apart(tmp_path):
    rocks = ICE | {"name": "other", "position": [2.0, 0.5, 0.36]}
    seen = river(
        fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], (PIER, ICE, rocks), speed=0.0, drift=2.0)
    )
    assert pictures.plan(seen, 1.0).axes[0].collections[0].get_clim() == (0.0, 2.0)


def test_a_plan_that_all_ice_has_left_has_a_scale(tmp_path, monkeypatch):
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0]))
    real = seen.run.bodies

    def left(frame):
        bodies = real(frame)
        there = bodies["body"] == 0
        return bodies | {"quads": bodies["quads"][there], "body": bodies["body"][there]}

    monkeypatch.setattr(seen.run, "bodies", left)
    (picture,) = pictures.plan(seen, 1.0).axes[2].images
    assert picture.get_clim() == (0.0, pytest.approx(0.16)) and pictures.time_distance(seen) is None


def test_ice_that_goes_back_is_in_the_picture_of_the_balance(tmp_path):
    measure = {"control": {"plane": 0.8}}
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], drift=-SPEED, measure=measure))
    (axes,) = pictures.balance(seen).axes
    assert axes.get_ylim()[0] <= seen.passed(0.8)[-1] < 0.0


def test_the_legend_of_the_long_section_is_clear_of_its_title(tmp_path):
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0]))
    drawn = pictures.long_section(seen, 60.0)
    drawn.draw_without_rendering()
    (title,) = drawn.findobj(lambda each: isinstance(each, Text) and each.get_text().startswith("mean of"))
    assert not drawn.axes[0].get_legend().get_window_extent().overlaps(title.get_window_extent())


def test_a_drifting_floe_has_the_porosity_of_the_frames_that_show_it(tmp_path):
    """It fills the width and three columns, and is there in half the frames of the window: not half empty for that."""
    floe = ICE | {"shape": {"size": [0.6, 1.0, 0.16]}, "position": [1.3, 0.5, 0.36]}
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0, 0.9], [0.0, 0.9], (floe,), drift=2.0 / 0.9))
    along = seen.along(0.9)
    assert along["solid_thickness"][6] == pytest.approx(0.08)
    assert along["porosity"][6] == pytest.approx(0.0, abs=1e-9) and np.isfinite(along["porosity"]).sum() == 6


def test_ice_that_left_between_two_rows_has_passed_the_planes_before(tmp_path):
    """Its last row is 0.5 m upstream of a plane at 3.5 m, and the one after has it no more."""
    faces = {"x_min": "wall", "x_max": "open"}
    folder = fake_river.make_odd(
        tmp_path / "out", [0.0, 1.0], [0.0], (ICE,), measure={"control": {"plane": 3.5, "end": 4.0}},
        box={"max": [4.0, 1.0, 0.8], "faces": faces},
    )  # fmt: skip
    place = (0.5, 0.36, 1.0, 0.0, 0.0, 0.0)
    rows = [(0, 0.0, "floe", 1.0, *place, *[0.0] * 6), (5, 5.0, "floe", 3.0, *place, *[0.0] * 6)]
    fake_river.series(folder, "bodies", [*rows, (10, 10.0, "floe", *[math.nan] * 13)])
    fake_river.series(folder, "lost", [(2, 2.0, "water", 17, *[0.0] * 6), (8, 8.0, "body floe", 0, 4.2, *[0.0] * 5)])
    seen, volume = river(folder), math.prod(fake_river.FLOE)
    assert seen.passed(3.5) == pytest.approx([0.0, 0.0, volume]) == seen.passed(4.0)
    assert seen.stored() == pytest.approx([volume, volume, 0.0])


def test_a_run_whose_bed_is_gone_has_a_page_that_says_so(tmp_path):
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], measure=JAM)
    case = folder / "case.toml"
    case.write_text(
        case.read_text().replace(
            "[[bodies]]",
            """[[bodies]]
name = "rock"
shape = {kind = "mesh", file = "gone.stl"}
density = 2000.0
material = "ice"
position = [2.0, 0.5, 0.4]
fixed = true

[[bodies]]""",
            1,
        )
    )
    run = parsim.open(folder)
    told = section.parts(Page(run, vtk=False))
    assert "gone.stl" in told and "<img" not in told and section.lines(run) == []


def test_a_long_series_is_read_once(tmp_path, monkeypatch):
    """Each pier has twelve tables of the series of peaks, which is the longest of all."""
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0])
    fake_river.series(
        folder, "peaks", [(1, 0.5, "all", "pier", kind, 0.5, *[1.0] * 24) for kind in ("water", "contact")]
    )
    seen, real, read = river(folder), parsim.open(folder).series, []
    monkeypatch.setattr(seen.run, "series", lambda name: read.append(name) or real(name))
    assert tables.piers_table(seen).count("\n") == 2 + 2 * 6 * 3 and read == ["peaks"]


def test_floes_of_any_shape_have_their_size_in_plan(tmp_path):
    ball, disc = (ICE | {"name": kind, "shape": {"kind": kind, "diameter": 0.3} | more, "position": [x, 0.5, 0.36]}
                  for kind, more, x in (("sphere", {}, 1.0), ("cylinder", {"height": 0.16}, 2.0)))  # fmt: skip
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0], [0.0], (ball, disc)))
    assert seen.size == pytest.approx(0.3)


def test_ice_of_one_column_is_in_the_long_section(tmp_path):
    floe = ICE | {"shape": {"size": [0.18, 0.3, 0.16]}, "position": [1.1, 0.5, 0.36]}
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], (floe,), drift=0.0))
    top, bottom = pictures.long_section(seen, 1.0).axes
    (ice,) = (bar for bar in top.patches if np.isfinite(bar.get_height()))
    assert (ice.get_x(), ice.get_width(), ice.get_y()) == pytest.approx((1.0, 0.2, 0.28 + 0.05 * 0.16))
    assert ice.get_facecolor()[3] == pytest.approx(0.2 + 0.8 * seen.along(1.0)["concentration"][5])
    assert {line.get_label(): line.get_marker() for line in bottom.lines}["ice"] == "."


def test_a_floe_over_a_side_that_repeats_is_on_both_sides_of_the_plan(tmp_path):
    floe = ICE | {"position": [0.3, 0.5, 0.36]}
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], (floe,), drift=-0.3)
    shown = pictures.plan(river(folder), 1.0).axes[0].collections[0]
    reach = [(path.vertices[:, 0].min(), path.vertices[:, 0].max()) for path in shown.get_paths()]
    assert sorted(reach)[1:] == [pytest.approx((-0.15, 0.15)), pytest.approx((3.85, 4.15))]
    assert len(shown.get_array()) == len(reach) == 3


def test_heads_take_the_velocity_of_the_section(tmp_path):
    """The depth of one half of the width is a quarter of that of the other, and its water slower."""
    seen = river(fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0]))
    half = np.arange(seen.columns.shape[1]) < 2
    seen.fields = seen.fields._replace(
        velocity=np.where(half, 0.2, 1.0) + 0.0 * seen.fields.velocity,
        top=np.where(half, 0.1, 0.4) + 0.0 * seen.fields.top,
    )
    assert seen.columns.shape[1] == 5
    flow, area = 2 * 0.2 * 0.1 + 3 * 0.4, 2 * 0.1 + 3 * 0.4
    assert seen.heads(1.0) == pytest.approx(0.4 + (flow / area) ** 2 / 19.62)


def test_a_block_that_comes_in_later_is_known_by_its_shape(tmp_path, monkeypatch):
    """It is in no row before 2 s, and rests at the cover from 4 s on; another one never comes."""
    lid = ICE | {"name": "lid", "position": [3.0, 0.5, 0.36], "fixed": True}
    later = ICE | {"name": "later", "position": [2.0, 0.5, 0.36]}
    folder = fake_river.make_odd(tmp_path / "out", [0.0], [0.0], (lid, ICE, later), measure={"cover": "lid"})
    none, turn = [math.nan] * 13, (1.0, *[0.0] * 3)
    rows = [(k, float(k), "lid", 3.0, 0.5, 0.36, *turn, *[0.0] * 6) for k in range(9)]
    rows += [(k, float(k), name, *none) for k in range(9) for name in ("floe", "later") if k < 2 or name == "later"]
    rows += [(k, float(k), "floe", min(1.7 + 0.5 * (k - 2), 2.69), 0.5, 0.36, *turn, *[0.0] * 6) for k in range(2, 9)]
    fake_river.series(folder, "bodies", rows)
    seen, real = river(folder), parsim.open(folder).bodies(0)
    lids = real["body"] == 0
    monkeypatch.setattr(seen.run, "bodies", lambda _: real | {"quads": real["quads"][lids], "body": real["body"][lids]})
    assert {name: each.name for name, each in blocks(seen).items()} == {"floe": "stable", "later": "undecided"}
