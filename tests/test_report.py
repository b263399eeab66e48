"""The report of a made-up run: right numbers, whole page, pictures with and without VTK."""

import base64
import io
import re
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import fake_run
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

import parsim
from parsim.__main__ import main
from parsim.errors import InputError, WriteError
from parsim.output import series
from parsim.report import animation, measures, painter, pictures, scene
from parsim.report.build import build, summary
from parsim.report.measures import moments
from parsim.report.page import table
from parsim.report.sections import bodies, flow, front, profiles, published, speed
from parsim.report.sections.energy import energy_created

VOID = {"meta", "img", "br"}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return parsim.open(fake_run.make(tmp_path_factory.mktemp("report") / "out", times=np.arange(-0.1, 1.25, 0.2)))


class Checker(HTMLParser):
    """Every tag closed in its turn; collects the sources and alternatives of pictures."""

    def __init__(self, words):
        super().__init__()
        self.open, self.sources, self.alternatives = [], [], []
        self.feed(words)

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        attrs = dict(attrs)
        if tag in ("img", "video"):
            self.sources.append(attrs["src"])
            self.alternatives.append(attrs.get("alt") or attrs.get("aria-label"))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def check_page(path, figures):
    words = path.read_text(encoding="utf-8")
    page = Checker(words)
    assert not page.open and len(page.sources) == figures and all(page.alternatives)
    assert not re.search(r"(src|href)=\"(?!data:)|https?://|url\(", words)
    for source in page.sources:
        if source.startswith("data:image/png"):
            picture = imread(io.BytesIO(base64.b64decode(source.partition(",")[2])))
            assert picture[..., :3].std() > 0.02
    return words


def test_the_page_is_whole_without_vtk(run, monkeypatch):
    monkeypatch.setattr(pictures, "SNAPSHOT", pictures.Quality(300, 1))
    monkeypatch.setattr(pictures, "ANIMATION", pictures.Quality(200, 1))
    words = check_page(build(run.folder, vtk=False), figures=12)
    for said in ("pictures by our own painter", "Four blocks released on a dry bed", "block B1 is 3 spacings thin",
                 "front arrives at the end wall", "inside the experiments&#x27; spread", "spacing = 0.015",
                 "The front reached the end wall at", "t = 0.300 s", "t = 1.100 s"):  # fmt: skip
        assert said in words, said
    assert {"index.html", "trajectories.png", "energy.png"} <= {path.name for path in run.folder.glob("report/*")}
    assert next(iter(run.folder.glob("report/animation.*"))).stat().st_size < 4e6


def test_vtk_draws_or_the_painter_does(run):
    wanted = {(3, view): pictures.Quality(240, 1) for view in scene.VIEWS}
    gallery = pictures.Gallery(run, wanted)
    if gallery.method != "pyvista":
        pytest.skip("pyvista or a GL library is missing: drawn by " + gallery.method)
    moment = scene.load(run, 3)
    for view in scene.VIEWS.values():
        drawn, painted = gallery.picture(moment, 3, view)[0], painter.paint(moment, view, 240)[0]
        # the two must show the same things in the same places
        same = (drawn[..., 3] > 0.5)[: len(painted)] == (painted[..., 3] > 0.5)[: len(drawn)]
        assert same.mean() > 0.85, view.name


@pytest.mark.parametrize("command", ["raise SystemExit(1)", "import os; os.abort()"])
def test_a_crash_of_vtk_is_survived(run, monkeypatch, command):
    real = subprocess.run

    def crash(arguments, **options):
        assert arguments[2] == "parsim.report.vtk_worker"
        return real([sys.executable, "-c", command], **options)

    monkeypatch.setattr(pictures.importlib.util, "find_spec", lambda name: True)
    monkeypatch.setattr(pictures.subprocess, "run", crash)
    gallery = pictures.Gallery(run, {(0, "front"): pictures.Quality(80, 1)})
    assert gallery.method == "our own painter"
    assert gallery.picture(scene.load(run, 0), 0, scene.FRONT)[0].shape[1:] == (80, 4)


def test_the_painter_puts_things_where_they_are(run):
    moment = scene.load(run, 0)
    image, extent = painter.paint(moment, scene.FRONT, 700)

    def pixel(x, z):
        row = int((extent[3] - z) / (extent[3] - extent[2]) * len(image))
        return image[row, int((x - extent[0]) / (extent[1] - extent[0]) * image.shape[1])]

    water, block, air, gate = pixel(0.075, 0.06), pixel(0.02, 0.143), pixel(0.4, 0.2), pixel(0.1525, 0.25)
    assert water[2] > water[0] + 0.2 and water[3] > 0.5
    assert block[0] > block[2] + 0.2 and block[3] == 1
    assert air[3] == 0
    assert np.ptp(gate[:3]) < 0.1 and gate[3] > 0.3


@pytest.mark.long
def test_spheres_without_water_have_a_page(tmp_path):
    case = Path(__file__).parents[1] / "cases" / "bouncing_sphere" / "impulse.toml"
    assert main(["run", str(case), "-o", str(tmp_path / "out"), "--until", "0.05"]) == 0
    assert main(["report", str(tmp_path / "out")]) == 0
    text = (tmp_path / "out" / "report" / "index.html").read_text()
    assert "Trajectories of the bodies" in text and "Front" not in text and "Volume and particles" not in text


def test_the_gate_rises_at_its_speed():
    case = {"gate": {"bottom": 0.01, "speed": 0.4, "opens": 0.1}, "box": {"min": [0, 0, 0]}}
    assert [scene.gate_bottom(case, time) for time in (-1, 0.1, 0.6)] == [0.01, 0.01, pytest.approx(0.21)]
    assert scene.gate_bottom({}, 0.0) is None


def test_views_are_right_handed_and_keep_lengths():
    for view in scene.VIEWS.values():
        axes = np.array([view.right, view.up, view.away])
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
        np.testing.assert_allclose(np.cross(view.right, view.up), -np.array(view.away), atol=1e-14)


def test_measures_are_those_of_the_series(run):
    tracks = bodies.body_tracks(run)
    assert list(tracks) == list(fake_run.NAMES)
    assert bodies.draught(run, "B1", tracks["B1"]) == pytest.approx(0.868 * 0.0195)
    assert bodies.archimedes_draught(run, "B1") == pytest.approx(0.868 * 0.0195)
    assert bodies.at_time(tracks["A2"], "x", 0.5) == pytest.approx(fake_run.poses(0.5)[0][1, 0], abs=1e-4)
    assert bodies.at_time(tracks["A2"], "x", 3.0) is None
    assert front.front_arrival(run) == pytest.approx((0.7 - 2 * 0.015 - 0.15) / 1.35, abs=0.02)
    numbers = measures.published(run)
    assert [(number.block, number.quantity) for number in numbers] == [
        ("B1", "max X"), ("", "front arrives at the end wall"), ("A2", "X")]  # fmt: skip
    assert numbers[2].model is None and numbers[0].model == 0.30


def test_a_wet_bed_has_no_front_that_arrives(tmp_path):
    wet = parsim.open(fake_run.make(tmp_path / "wet", times=(0.0, 0.4), spacing=0.03))
    path = wet.folder / "series/front.csv"
    titles, rows = path.read_text().splitlines()[:2], path.read_text().splitlines()[2:]
    assert front.front_arrival(wet) is not None
    path.write_text("\n".join([*titles, *(row.rpartition(",")[0] + ",0.69" for row in rows)]) + "\n")
    assert front.front_arrival(wet) is None


def test_a_tilted_block_reaches_deeper(run):
    track = {key: np.array([value]) for key, value in
             {"time": 0.0, "x": 0.05, "y": 0.05, "z": 0.15, "q0": np.cos(np.pi / 8), "q1": 0.0, "q2": np.sin(np.pi / 8),
              "q3": 0.0}.items()}  # fmt: skip
    expected = (0.0725 + 0.0195) / 2 * np.sqrt(0.5)
    assert bodies.draught(run, "A1", track) == pytest.approx(expected)


def test_energy_created_takes_work_off():
    energy = {"time": [-1.0, 0.0, 1.0], "total": [9.0, 2.0, 3.0], "work_driven": [5.0, 1.0, 1.5]}
    energy = {name: np.array(values) for name, values in energy.items()}
    times, created = energy_created(energy)
    np.testing.assert_array_equal(created, [0.0, 0.25])
    np.testing.assert_array_equal(times, [0.0, 1.0])


def test_verdicts():
    number = measures.Published("B1", "max X", 0.2, 0.25, None, "m", 1.2, "")
    assert measures.verdict(0.22, number) == "inside the experiments' spread"
    assert measures.verdict(0.3, number) == "0.05 m above (+20%)"
    assert measures.verdict(0.1, number) == "0.1 m below (-50%)"
    assert measures.verdict(None, number) == "not compared"


def test_the_profile_leaves_splash_out():
    position = np.array([[0.005, 0.0, 0.10], [0.006, 0.0, 0.02], [0.015, 0.0, 0.05], [0.02, 0.0, 0.07]])
    water = {"position": position, "class": np.array([3, 2, 2, 0], np.uint8)}
    middles, heights = profiles.profile(water, 0.01, 0.0, 0.04)
    np.testing.assert_allclose(middles, [0.005, 0.015, 0.025, 0.035])
    np.testing.assert_allclose(heights, [0.025, 0.055, 0.075, np.nan])


def test_the_profile_stops_where_bodies_cover_it(run):
    moment, level = scene.load(run, 0), 0.15
    x = np.arange(0.0005, 0.15, 0.001)
    position = np.stack([x, np.full_like(x, 0.037), np.full_like(x, level - 0.02)], 1)
    under = profiles.covered(position, moment)
    covers = (np.abs(x - 0.038) < 0.0725 / 2) | (np.abs(x - 0.112) < 0.0725 / 2)
    assert (under == covers).all() and 0 < under.sum() < len(x)
    assert not profiles.covered(position + [0.0, 0.0, 0.05], moment).any(), "water on top of a body is a surface"
    middles, heights = profiles.profile({"position": position, "class": np.zeros(len(x))}, 0.001, 0.0, 0.15, under)
    assert (np.isnan(heights) == covers).all()


def test_small_shares_have_digits(tmp_path):
    (tmp_path / "series").mkdir()
    (tmp_path / "run.json").write_text("{}")
    for name, column, values in (("energy", "total", (2.0, 2.0 + 6e-7)), ("counts", "volume", (1.0, 1.0 - 4e-8))):
        table = series.Table(tmp_path / f"series/{name}.csv", {"step": "-", "time": "s", column: "-"})
        for step, value in enumerate(values):
            table.row(step, float(step), value)
        table.close()
    energy, volume = summary(parsim.open(tmp_path))[1:]
    assert "at most: 3e-05 % of" in energy and "within 4e-06 % of" in volume


def test_nothing_is_said_of_times_after_the_end(run, tmp_path):
    words = published.compared(run) + bodies.told(run)
    assert "largest X to 1.1 s (m)" in words and "max X (here to 1.1 s)" in words and "1.5 s (m)" not in words
    long = parsim.open(fake_run.make(tmp_path / "long", times=(0.0, 1.6), spacing=0.03))
    assert "largest X to 1.5 s (m)" in bodies.told(long) and "here to" not in published.compared(long)


def test_moments_are_reached_ones():
    times = np.arange(0, 1.01, 0.05)
    assert moments(times, (0.4, 0.8, 1.2)) == [8, 16]
    assert moments(times[:4], (0.4, 0.8)) == [1, 2, 3]
    assert moments(np.zeros(0), (0.4,)) == []
    assert animation.chosen(300)[-1] == 299 and len(animation.chosen(300)) == animation.MOST_FRAMES


def test_a_two_dimensional_run_and_a_stopped_one(run, tmp_path):
    fake_run.make(tmp_path / "plane", times=(0.0, 0.2, 0.4), spacing=0.03)
    case = tmp_path / "plane/case.toml"
    case.write_text(case.read_text().replace("dimensions = 3", "dimensions = 2"))
    check_page(build(tmp_path / "plane"), figures=10)
    (tmp_path / "stopped/series").mkdir(parents=True)
    (tmp_path / "stopped/run.json").write_text("{}")
    (tmp_path / "stopped/case.toml").write_text('title = "Stopped"\n')
    (tmp_path / "stopped/series/energy.csv").write_text("# units: -, s, J\nstep,time,total\n")
    assert "Status: unknown" in check_page(build(tmp_path / "stopped"), figures=0)
    (tmp_path / "stopped/run.json").write_text('{"status": "failed", "error": "RunError: a particle < all has left"}')
    assert "It ended with: RunError: a particle &lt; all has left" in check_page(build(tmp_path / "stopped"), figures=0)


def test_a_gif_replaces_a_missing_encoder(run, monkeypatch):
    def missing(pictures, fps):
        raise ImportError("no encoder")

    monkeypatch.setattr(animation, "_mp4", missing)
    gallery = pictures.Gallery(run, pictures.wanted(run, [], [0, 1]), vtk=False)
    data, suffix = animation.animate(run, gallery, [0, 1])
    assert suffix == "gif" and data[:4] == b"GIF8"


def test_bad_folders_and_full_ones(tmp_path, run):
    with pytest.raises(InputError, match="not an output folder"):
        build(tmp_path)
    (tmp_path / "run.json").write_text("{}")
    (tmp_path / "report").write_text("")
    with pytest.raises(WriteError):
        build(tmp_path)


def test_words_are_escaped_and_empty_tables_left_out(run):
    assert table(("a",), []) == ""
    assert "&lt;script&gt;" in table(("a", "b"), [("<script>", 1.0)])
    assert speed.phases(run) is not None


def test_a_body_that_has_left_is_not_named(run):
    moment = scene.load(run, 0)
    there, position = moment.body != 1, moment.position.copy()
    position[1] = np.nan
    left = replace(moment, quads=moment.quads[there], body=moment.body[there], position=position)
    for view in scene.VIEWS.values():
        axes = Figure().add_subplot()
        pictures._names(axes, left, view)
        assert len(axes.texts) == len(left.names) - 1


def test_what_flows_through_a_channel_is_shown(tmp_path):
    run = parsim.open(fake_run.make(tmp_path / "out"))
    assert not flow.lines(run) and flow.openings(run) is None is flow.channel(run) is flow.ice(run)
    times = np.linspace(0.0, 1.0, 11)
    opened = [(i, t, 10 * i, 8 * i, 100 + 2 * i, 100, 0.2, 0.1, 0.21, 0.09, 0.0) for i, t in enumerate(times)]
    iced = [
        (i, t, i, i // 2, i - i // 2, 0.1 * i, 0.05 * i, 0.05 * i, 0.0, 1, 2, 0.3, 0.01) for i, t in enumerate(times)
    ]
    driven = [(i, t, 0.1, 0.11, 0.01, 0.02, 0.002) for i, t in enumerate(times)]
    for name, rows in (("openings", opened), ("ice", iced), ("channel", driven)):
        fake_run._table(run.folder / "series", name, rows)
    run = parsim.open(run.folder)
    said = flow.lines(run)
    assert said[0] == "100 particles came in, 80 went out; the account is off by 0."
    assert said[1].startswith(
        "10 floes came in, 5 went out, 5 are inside; the way in was blocked for 0.3 s, 2 were due"
    )
    assert [len(drawn.axes) for drawn in (flow.openings(run), flow.channel(run), flow.ice(run))] == [2, 2, 2]


def test_many_bodies_are_told_together_and_fixed_ones_not(run, monkeypatch):
    """Quantiles in place of a row for each."""
    track = next(iter(bodies.body_tracks(run).values()))
    tracks = {f"b{k}": track | {"x": track["x"] + 0.01 * k} for k in range(21)}
    case = run.case | {"bodies": [{"name": "b20", "fixed": True}]}
    many = SimpleNamespace(case=case, body_names=[*tracks], folder=run.folder, info=run.info)
    monkeypatch.setattr(bodies, "body_tracks", lambda run: tracks)
    monkeypatch.setattr(bodies, "draught", lambda run, name, track: None)
    monkeypatch.setattr(bodies, "archimedes_draught", lambda run, name: 0.017)
    monkeypatch.setattr(bodies, "compared_until", lambda run: 1.1)
    words = bodies.told(many)
    first = float(track["x"][track["time"] >= 0].max())
    assert "b7" not in words and words.count("<tr>") == 6, "by Archimedes, X at two times, largest X, when"
    assert f'<td class="number">20</td><td class="number">{first:.4g}</td>' in words
    assert f'<td class="number">{first + 0.19:.4g}</td></tr>' in words, "without the fixed one"
    assert not [*bodies.trajectories(many).axes[0].texts]


def test_of_water_that_flows_through_no_loss_is_told(run, monkeypatch):
    before = summary(run)
    assert any("Energy created" in line for line in before) and any("Volume within" in line for line in before)
    faces = run.case["box"].get("faces", {}) | {"x_min": {"kind": "inlet", "discharge": 0.1}}
    monkeypatch.setitem(run.case["box"], "faces", faces)
    after = summary(run)
    assert not any("Energy created" in line or "Volume within" in line for line in after)
    assert any(line.startswith("Particles at most 0 in walls") for line in after)
