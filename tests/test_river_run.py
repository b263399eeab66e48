"""The measures of whole runs, made up so that they are known: what is read, told, drawn and refused."""

import csv
import math
import re
from types import SimpleNamespace

import fake_river
import numpy as np
import pytest
from fake_river import DEPTH, FLOE, LANES, PLANE, ROWS, SPEED

import parsim
from parsim.errors import InputError
from parsim.report import river as pictures
from parsim.report.build import Page
from parsim.report.sections import river as section
from parsim.river.arches import arches, at_pier
from parsim.river.reader import River, river_of
from parsim.river.verdicts import blocks, on_the_bed, pairs, verdict
from parsim.study.outcomes import block_goes_under, jam_forms, jam_holds
from parsim.validate.river_measures import jam_length, reach_mean, reach_most

VOLUME = math.prod(FLOE)


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    return River(parsim.open(fake_river.make(tmp_path_factory.mktemp("river") / "channel")))


@pytest.fixture(scope="module")
def covered(tmp_path_factory):
    return River(parsim.open(fake_river.make_cover(tmp_path_factory.mktemp("river") / "cover")))


def test_levels_rise_upstream_and_head_is_lost_at_the_piers(channel):
    upstream = channel.columns.x < PLANE
    assert channel.window == pytest.approx(5.0 * math.sqrt(DEPTH / 9.81)) and channel.drift == pytest.approx(SPEED)
    assert channel.rise(20.0) == pytest.approx(0.0, abs=1e-12)
    assert channel.rise(60.0) == pytest.approx(np.where(upstream, 0.02, 0.0), abs=1e-12)
    along = channel.along(60.0)
    assert along["level"] == pytest.approx(np.where(upstream, 0.42, 0.40))
    assert along["head"] == pytest.approx(along["level"] + SPEED**2 / 19.62)
    assert (along["bed"] == 0.0).all() and along["water_top"] == pytest.approx(DEPTH)
    reach = channel.reach_means(60.0)
    assert reach["head_loss"] == pytest.approx(0.02) and reach["rise"] == pytest.approx(0.02)
    assert reach["energy_slope"] == pytest.approx(0.0, abs=1e-12) and reach["ice_speed"] == pytest.approx(0.0, abs=0.01)


def test_ice_is_all_there_in_every_frame(channel):
    """The raster keeps the volume of the floes, as they go round the box too, within a pixel along each edge."""
    area = np.prod(channel.columns.step)
    volume = channel.fields.solid.sum(axis=(1, 2)) * area
    assert volume == pytest.approx(LANES * ROWS * VOLUME, rel=0.05)
    assert channel.stored() == pytest.approx(LANES * ROWS * VOLUME)
    assert channel.floe == pytest.approx(0.16) and channel.size[3] == pytest.approx(math.sqrt(4 / math.pi * 0.09))
    assert np.nanmax(channel.fields.jam[-1]) == pytest.approx(0.9 * 0.33 + 0.1 * 0.16, abs=0.01)


def test_the_floe_that_goes_through_is_counted_at_each_round(channel):
    """It is at 9 m after 3.2, 27.2 and 51.2 s; all others stay upstream."""
    passed, time = channel.passed(PLANE), channel.tracks.time
    rounds = (time >= 3.2).astype(int) + (time >= 27.2) + (time >= 51.2)
    assert passed == pytest.approx(VOLUME * rounds)


def test_the_jam_is_found(channel):
    """The last floe stops at 12.3 s; ice stands from 6.81 m, where that floe ends, to 8.7 m, two floes thick."""
    found = verdict(channel)
    assert found.jam.lasts == "held" and 12.3 - found.window < found.jam.begin < 12.3
    assert (found.head, found.toe) == pytest.approx((6.81, 8.7), abs=0.2)
    assert found.kind == "thickened" and found.layers == pytest.approx(2.0, abs=0.1)
    assert found.water == pytest.approx(SPEED) and found.window == pytest.approx(10.0 * channel.size[3] / SPEED)
    assert not on_the_bed(channel, 30, (0.0, 12.0)).any()


def test_floes_on_the_bed_ground_a_jam(channel, monkeypatch):
    real = channel.run.bodies

    def sunk(frame):
        bodies = real(frame)
        return bodies | {"points": bodies["points"] - [0.0, 0.0, 0.11]}

    monkeypatch.setattr(channel.run, "bodies", sunk)
    assert on_the_bed(channel, 30, (0.0, 12.0)).sum() == LANES * ROWS // 2
    assert on_the_bed(channel, 30, (0.0, 5.0)).sum() == 0 and verdict(channel).kind == "grounded"


def test_no_jam_is_told_where_none_is_sought_or_where_ice_goes_on(channel, covered, monkeypatch):
    assert verdict(covered) is None
    monkeypatch.setattr(channel, "tracks", channel.tracks._replace(speed=np.full_like(channel.tracks.speed, SPEED)))
    found = verdict(channel)
    assert found.jam is None and found.kind == "none" and section._jam(found) == ["No ice jam."]


def test_a_jam_is_not_known_where_the_run_is_too_short_for_one(channel, monkeypatch):
    short = channel.tracks.time < channel.wait
    rows = {name: getattr(channel.tracks, name)[short] for name in ("time", "x", "home", "speed", "quaternion")}
    monkeypatch.setattr(channel, "tracks", channel.tracks._replace(**rows))
    found = verdict(channel)
    assert found.kind == "unknown" and "is not known: the run is shorter than the" in section._jam(found)[0]


def test_floes_left_behind_are_no_jam(channel, monkeypatch):
    """All but one are gone when the others of the made up run have come to stand."""
    tracks, stands = channel.tracks, verdict(channel).jam.begin
    x, home, speed = tracks.x.copy(), tracks.home.copy(), tracks.speed.copy()
    gone = np.ix_(tracks.time >= stands, np.flatnonzero(channel.loose)[1:])
    x[gone], home[gone], speed[gone] = np.nan, np.nan, np.nan
    monkeypatch.setattr(channel, "tracks", tracks._replace(x=x, home=home, speed=speed))
    assert verdict(channel).jam is None


def test_ice_that_is_first_seen_beyond_a_plane_has_passed_it(channel, monkeypatch):
    tracks, body = channel.tracks, int(np.flatnonzero(channel.loose)[0])
    x = tracks.x.copy()
    x[:5, body], x[5:, body] = np.nan, PLANE + 1.0
    monkeypatch.setattr(channel, "period", (np.inf, np.inf))
    whole = channel.passed(PLANE)
    monkeypatch.setattr(channel, "tracks", tracks._replace(x=x))
    assert channel.passed(PLANE)[5] - whole[5] == pytest.approx(VOLUME)


def test_the_block_that_turned_is_told(covered):
    found = blocks(covered)
    assert list(found) == ["block"] and found["block"].name == "under-turned" and found["block"].critical
    assert found["block"].tilt == pytest.approx(120.0)
    assert covered.piers == [] and pairs(covered, 0) == []


def test_floes_side_by_side_are_neighbours(channel):
    """Floes of a lane are 0.02 m apart, lanes 0.05 m, half a spacing; the piers stand 0.2 m downstream of all."""
    near = pairs(channel, 30)
    names = [{channel.run.body_names[k] for k in pair} for pair in near]
    assert {"floe1_0", "floe2_0"} in names and {"floe1_0", "floe5_0"} not in names
    assert channel.piers == [0, 1, 2] and at_pier(near, 0) == 0 and arches(near, channel.piers) == []


def test_forces_on_piers_come_from_the_peaks(channel):
    ice = channel.peaks("pier1", "contact", "fx")
    assert ice.largest.max() == 800.0 and ice.impulse.sum() == pytest.approx(4.0)
    assert channel.peaks("pier1", "water", "my").impulse.sum() == pytest.approx(2.0 * 60.0)
    assert channel.peaks("floe0_0", "water", "fx") is None


def test_a_run_without_ice_or_frames_has_measures_too(tmp_path):
    case = fake_river.channel()
    dry = fake_river.write(tmp_path / "no", case, [], [], None, None)
    river = River(parsim.open(dry))
    assert river.fields.time.size == 0 and river.fields.level.shape == (0, 60, 10)
    page = SimpleNamespace(run=parsim.open(dry))
    assert section.parts(page) == "" and section.lines(page.run) == []


def rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        units = file.readline().removeprefix("# units: ").strip().split(", ")
        titles, *found = csv.reader(file)
    assert len(units) == len(titles)
    return [dict(zip(titles, row, strict=True)) for row in found], dict(zip(titles, units, strict=True))


def test_the_page_has_pictures_and_tables(channel):
    page = Page(channel.run, vtk=False)
    words = section.parts(page)
    assert words.count("<img") == 5 and "Ice jam (thickened)" in words and "it held" in words
    assert "Floes within half a spacing of a pier at 60 s: pier0 0, pier1 0, pier2 0. Arches: none." in words
    assert section.lines(channel.run) == section._jam(verdict(channel))
    along, units = rows(page.folder / "river.csv")
    assert len(along) == 2 * 60 and {row["time"] for row in along} == {"20.0", "60.0"}
    assert (units["level_90"], units["velocity_10"], units["porosity"]) == ("m", "m/s", "-")
    last = [float(row["rise"]) for row in along if row["time"] == "60.0"]
    assert last == pytest.approx(np.where(channel.columns.x < PLANE, 0.02, 0.0), abs=1e-12)
    ((jam,), units) = rows(page.folder / "jam.csv")
    assert (jam["verdict"], jam["kind"]) == ("held", "thickened") and units["supply"] == "m3/s"
    piers, _ = rows(page.folder / "piers.csv")
    (hit,) = (r for r in piers if (r["body"], r["kind"], r["part"], r["window"]) == ("pier0", "contact", "fx", "0.0"))
    assert float(hit["p100"]) == 800.0 and float(hit["p95"]) == 0.0 and len(piers) == 3 * 2 * 6 * 3
    balance, _ = rows(page.folder / "ice_balance.csv")
    assert float(balance[-1]["passed_piers"]) == pytest.approx(3 * VOLUME)
    through = [float(row["discharge_piers"]) for row in balance]
    assert max(through[20:]) == pytest.approx(VOLUME / channel.wait, rel=1e-6) and through[-20] == 0.0
    assert len(rows(page.folder / "reach.csv")[0]) == 2
    assert not list(page.folder.glob(".*")), "nothing half written is left"


def test_the_page_of_a_plane_has_its_block(covered):
    words = section.parts(Page(covered.run, vtk=False))
    told = re.sub('src="[^"]*"', "", words)
    assert "under-turned" in told and told.count("<img") == 3 and "Ice jam" not in told and "nan" not in told
    (block,), units = rows(covered.run.folder / "report" / "blocks.csv")
    assert block["class"] == "under-turned" and block["critical"] == "True" and units["tilt"] == "degrees"
    assert pictures.plan(covered, 8.0) is None and pictures.pier_forces(covered) is None


def test_a_case_that_asks_for_nothing_has_no_such_section():
    run = SimpleNamespace(case={"title": "x"}, series_names=["bodies"])
    assert section.parts(SimpleNamespace(run=run)) == "" and section.lines(run) == []


def test_what_became_of_many_blocks_is_told_by_kind(covered, monkeypatch):
    one = next(iter(blocks(covered).values()))
    many = {f"b{k}": one._replace(name="stable" if k < 5 else "passed", critical=k >= 5) for k in range(20)}
    monkeypatch.setattr(section, "blocks", lambda river: many)
    told = section._blocks(covered)
    assert told.count("<tr>") == 3 and "b7" not in told
    assert '<td>passed</td><td>yes</td><td class="number">15</td>' in told
    assert '<td>stable</td><td>no</td><td class="number">5</td>' in told


def test_a_study_asks_for_jams_and_blocks(channel, covered):
    assert jam_forms(channel.run) is True and jam_holds(channel.run) is True
    assert block_goes_under(covered.run, "block") is True
    with pytest.raises(InputError, match="body = 'lid': no block that drifts"):
        block_goes_under(covered.run, "lid")
    with pytest.raises(InputError, match="looks for no jam"):
        jam_forms(covered.run)
    with pytest.raises(InputError, match="has no table measure"):
        jam_forms(SimpleNamespace(case={}))


def test_bars_ask_for_the_reach_and_the_jam(channel, covered):
    """At the end: 0.02 m of rise upstream, two floes of 0.16 m on each other from 6.81 to 8.7 m."""
    assert reach_mean(channel.run, "rise") == pytest.approx(0.02)
    assert reach_mean(channel.run, "head_loss") == pytest.approx(0.02)
    assert reach_most(channel.run, "jam_thickness") == pytest.approx(0.9 * 0.33 + 0.1 * 0.16, abs=0.03)
    assert jam_length(channel.run) == pytest.approx(8.7 - 6.81, abs=0.3)
    assert math.isnan(jam_length(covered.run))
    with pytest.raises(InputError, match="name = 'rize': there is no such one; did you mean rise"):
        reach_mean(channel.run, "rize")


def test_a_run_is_measured_once(channel):
    assert river_of(channel.run) is river_of(channel.run)


@pytest.mark.parametrize(("changes", "words"), [
    ({"grid": 0.05}, "measure.grid = 0.05: must be at least the spacing, 0.1 m"),
    ({"reach": [9.0, 4.0]}, "measure.reach = [9.0, 4.0]: must rise within 0.0 to 12.0"),
    ({"head_loss": [2.0, 13.0]}, "measure.head_loss = [2.0, 13.0]: must rise within 0.0 to 12.0"),
    ({"before": [0.0, 61.0]}, "measure.before = [0.0, 61.0]: must rise within 0.0 to 60.0"),
    ({"control": {"piers": 13.0}}, "measure.control.piers = 13.0: outside the box; must be 0.0 to 12.0"),
    ({"jam": {"control": "pier", "reach": [4.7, 8.7]}},
     'measure.jam.control = "pier": no such plane in measure.control; allowed: piers; did you mean piers?'),
    ({"jam": {"control": "piers", "reach": [5.0, 9.5]}}, "must end upstream of measure.control.piers, 9.0 m"),
    ({"jam": {"control": "piers", "reach": [5.0, 8.0]}}, "must be two widths of the channel long, 4 m, at least"),
    ({"jam": {"control": "piers", "reach": [-1.0, 8.0]}}, "measure.jam.reach = [-1.0, 8.0]: must rise within"),
    ({"jam": {"reach": [4.7, 8.7]}}, "measure.jam.control: missing"),
    ({"cover": "lid"}, 'measure.cover = "lid": no such body'),
    ({"cover": "floe0_0"}, 'measure.cover = "floe0_0": must be a fixed body'),
    ({"piers": ["peir1"]}, 'measure.piers = "peir1": no such body; allowed: pier0, pier1, pier2, floe0_0'),
    ({"cover": "pier0", "piers": ["pier0"]}, 'measure.piers = "pier0": is the cover; leave it out'),
    ({"jams": {}}, "measure.jams: unknown key; did you mean measure.jam?"),
])  # fmt: skip
def test_what_is_wrong_with_the_table_is_told(changes, words):
    with pytest.raises(InputError) as told:
        fake_river.channel(**changes)
    assert words in str(told.value)


def test_a_river_needs_its_weight_downward():
    case = fake_river.channel().model_dump(exclude_none=True) | {"gravity": (0.0, 0.0, 0.0)}
    with pytest.raises(InputError, match="measure: needs gravity along -z"):
        parsim.case.model.parse(case)


def test_piers_may_be_named():
    case = fake_river.channel(piers=["pier2"])
    assert case.measure.piers == ("pier2",)
