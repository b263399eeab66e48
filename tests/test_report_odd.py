"""Reports of runs that are not as usual: tables of others, odd names, many bodies, tanks far off or small."""

import importlib.util
from dataclasses import replace
from types import SimpleNamespace

import fake_run
import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

import parsim
from parsim.errors import InputError
from parsim.report import animation, pictures, scene
from parsim.report.build import LARGEST, Page, build
from parsim.report.measures import MANY, published, wall_time
from parsim.report.sections import bodies, counts, front, gauges, loads, speed

HEAD = "case,block,quantity,low,high,model,unit,time,source\n"


@pytest.fixture
def folder(tmp_path):
    return fake_run.make(tmp_path / "out", spacing=0.03, times=(0.0, 0.4), series=0.1)


@pytest.mark.parametrize(
    "text", [b"time,level\n0.0,0.1\n", b"", "Zeit;Höhe\n".encode("latin-1"), HEAD.encode() + b"dry_four,B1\n"]
)
def test_a_table_of_the_user_is_none_of_published_numbers(folder, text):
    (folder / "reference.csv").write_bytes(text)
    numbers = published(parsim.open(folder))
    assert [(n.quantity, n.low, n.source) for n in numbers] == [("", None, "")] * (b"B1" in text)


def test_published_numbers_are_read_from_what_editors_write(folder):
    row = "dry_four,B1,max X,0.18, ,0.3,m,1.5,Universit\xe9\n"
    (folder / "reference.csv").write_bytes(b"\xef\xbb\xbf# Of me.\r\n" + (HEAD + row).encode("latin-1"))
    (number,) = published(parsim.open(folder))
    assert (number.block, number.low, number.high, number.time) == ("B1", 0.18, None, 1.5)


@pytest.mark.parametrize("value", ['"0,18"', "nan", "n/a"])
def test_a_published_number_that_is_none_is_told(folder, value):
    (folder / "reference.csv").write_text(f"{HEAD}dry_four,B1,max X,{value},0.2,,m,1.5,me\n")
    with pytest.raises(InputError, match=r"reference.csv: dry_four, B1, max X: low = '.*': must be a finite number"):
        build(folder, vtk=False)


def test_the_page_has_a_name_from_within_the_folder(folder, monkeypatch):
    case = folder / "case.toml"
    case.write_text(case.read_text().replace("Four blocks released on a dry bed", ""))
    monkeypatch.chdir(folder)
    monkeypatch.setattr("parsim.report.build.SECTIONS", ())
    words = build(".", vtk=False).read_text()
    assert "<h1>out</h1>" in words and "parsim report of out</p>" in words


@pytest.mark.parametrize("name", ["inf", "NaN", "infinity"])
def test_a_name_may_read_as_a_number(folder, name):
    path = folder / "series/gauges.csv"
    path.write_text(path.read_text().replace("wall", name))
    run = parsim.open(folder)
    assert run.series("gauges")["gauge"].tolist() == [name] * len(run.series("gauges")["step"])
    assert gauges.gauges(run) is not None


def _copies(folder, name, count):
    """A series whose first body is there so many times, the last ones with the larger forces."""
    path = folder / f"series/{name}.csv"
    *head, rows = path.read_text().split("\n", 2)
    mine = [row.split(",") for row in rows.split("\n") if ",A1," in row]
    rows = [[*row[:2], f"b{k}", *row[3:]] for row in mine for k in range(count)]
    for row in rows if name == "loads" else ():
        row[4] = str(float(row[2][1:]) * (row[3] != "gravity"))
    path.write_text("\n".join([*head, *map(",".join, rows)]) + "\n")


def test_of_many_bodies_those_with_the_largest_forces_are_shown(folder):
    _copies(folder, "loads", MANY - 1)
    assert len(loads.loads(parsim.open(folder)).axes) == 2 * (MANY - 1)
    path = folder / "series/loads.csv"
    path.write_text(path.read_text().replace(",b0,", ",A1,"))
    _copies(folder, "loads", 400)
    told = [axes.get_ylabel() for axes in loads.loads(parsim.open(folder)).axes[::2]]
    assert told == [f"b{k} fx (N)" for k in range(400 - loads.MOST, 400)]


def test_a_tall_figure_is_drawn_coarser(folder):
    drawn = Figure(figsize=(1.0, 1000.0))
    page = Page(parsim.open(folder), vtk=False)
    assert page.figure("tall", drawn, "", "")
    assert imread(page.folder / "tall.png").shape[0] == pytest.approx(LARGEST, abs=1.0)


def test_bodies_that_are_not_there_have_no_place(folder, monkeypatch):
    run = parsim.open(folder)
    tracks = bodies.body_tracks(run)
    late = tracks["A1"]["time"] > 0.15
    tracks["A1"]["x"][late], tracks["A1"]["z"][late] = np.nan, np.nan  # it has left the box
    assert bodies.at_time(tracks["A1"], "x", 0.1) == pytest.approx(tracks["A1"]["x"][1])
    assert bodies.at_time(tracks["A1"], "x", 0.3) is None
    monkeypatch.setattr(bodies, "body_tracks", lambda run: tracks)
    names = {text.get_text().strip(): text.get_position()[0] for text in bodies.trajectories(run).axes[0].texts}
    assert names["A1"] == pytest.approx(0.1) and names["B1"] == pytest.approx(0.4)


def test_tracks_are_the_rows_of_each_body_in_the_order_of_the_case(folder):
    run = parsim.open(folder)
    tracks, series = bodies.body_tracks(run), run.series("bodies")
    assert [*tracks] == list(fake_run.NAMES)
    for name, track in tracks.items():
        assert (track["x"] == series["x"][series["body"] == name]).all() and (np.diff(track["time"]) > 0.0).all()


def test_without_water_nothing_floats(folder):
    run = parsim.open(folder)
    assert bodies.archimedes_draught(run, "A1") == pytest.approx(0.868 * 0.0195)
    dry = SimpleNamespace(case=run.case | {"water": {"scheme": {"kind": "none"}}}, body_names=run.body_names)
    assert bodies.archimedes_draught(dry, "A1") is None


@pytest.mark.parametrize(("length", "told"), [(0.15, "0.05 m"), (1.2, "0.5 m"), (30.0, "10 m")])
def test_the_ruler_tells_its_marks_apart(folder, length, told):
    moment = scene.load(parsim.open(folder), 0)
    small = replace(moment, tank=(np.zeros(3), length * np.array([1.0, 0.5, 0.5])))
    axes = Figure().add_subplot()
    pictures._ruler(axes, small, scene.OBLIQUE)
    marks = [text.get_text() for text in axes.texts]
    assert told in marks and len(set(marks)) == len(marks)


@pytest.mark.skipif(importlib.util.find_spec("pyvista") is None, reason="without pyvista there is nothing to see")
@pytest.mark.long
def test_vtk_sees_a_tank_wherever_it_stands(folder):
    views, shift = {(1, name): pictures.Quality(200, 1) for name in scene.VIEWS}, np.array([0.0, -50.0, 65.0])
    here = pictures._by_vtk(parsim.open(folder), views)
    if not here:
        pytest.skip("VTK draws nothing on this machine")
    for path in folder.glob("frames/*.vtkhdf"):
        with h5py.File(path, "r+") as file:
            for name in ("VTKHDF/Points", "VTKHDF/FieldData/position"):
                if name in file:
                    file[name][:] = file[name][:] + shift
    case = folder / "case.toml"
    text = case.read_text().replace("min = [0.0, 0.0, 0.0], max = [0.7, 0.15, 0.3]", "min = {}, max = {}", 1)
    ends = (shift.tolist(), (fake_run.TANK + shift).tolist())
    text = text.replace("min = {}, max = {}", "min = {}, max = {}".format(*ends))
    case.write_text(text.replace("bottom = 0.0", "bottom = 65.0"))
    there = pictures._by_vtk(parsim.open(folder), views)
    for key, image in here.items():
        assert (there[key][..., 3] > 0.0).mean() == pytest.approx((image[..., 3] > 0.0).mean(), rel=0.05)


@pytest.mark.filterwarnings("error")
def test_of_no_water_at_the_start_no_share_is_told(folder):
    path = folder / "series/counts.csv"
    head, *rows = (line.split(",") for line in path.read_text().split("\n")[1:-1])
    rows[0][head.index("volume")] = "0.0"
    path.write_text("# units\n" + "\n".join(map(",".join, [head, *rows])) + "\n")
    run = parsim.open(folder)
    assert counts.lines(run)[0].startswith("Particles at most 0 in walls")
    assert counts.volume(run).axes[0].get_ylabel() == "volume (l)"


@pytest.mark.parametrize(("name", "text", "said"), [
    ("case.toml", b"garbage = [", "cannot be read as the case of a run"),
    ("case.toml", b"title = '\xe9'", "cannot be read as the case of a run"),
    ("case.toml", None, "case.toml is gone"),
    ("series/front.csv", b"", "has no line of units and names"),
    ("series/front.csv", b"# units: -, s, m\nstep,time,x\n0,0.0,0.1\n1,0.1\n2,0.2,0.3\n", "line 4 has 2 values for 3"),
    ("series/front.csv", b"# units: -, s, m\nstep,time,x\n0,0.0,0.1\n\0\0\0\xff\n", "line 4 has 1 values for 3"),
    ("water.vtkhdf.series", b"{}", "cannot be read as an index of frames"),
    ("water.vtkhdf.series", b"\xff", "cannot be read as an index of frames"),
    ("bodies.vtkhdf.series", b'{"files": [3]}', "cannot be read as an index of frames"),
])  # fmt: skip
def test_a_damaged_output_is_told_with_the_remedy(folder, name, text, said):
    (folder / name).unlink()
    if text is not None:
        (folder / name).write_bytes(text)
    with pytest.raises(InputError, match=rf"{said}.*; `parsim resume`, of a run that is done"):
        build(folder, vtk=False)


def test_times_are_those_of_all_pieces():
    pieces = [{"wall_s": 2.0}, {"wall_s": 1.5}, {"ended": "killed"}]
    run = SimpleNamespace(info={"wall_s": 1.5, "time": 0.5, "pieces": pieces}, case={"run": {"settle": 0.2}})
    assert wall_time(run) == 3.5 and dict(speed.speed(run))["wall seconds per simulated second"] == pytest.approx(5.0)
    run.info["time"] = -0.2
    assert "wall seconds per simulated second" not in dict(speed.speed(run))


def test_a_film_of_a_tall_box_is_no_larger_than_an_encoder_takes():
    assert max(animation._pixels(Figure(figsize=(8, 800))).shape) <= animation.LARGEST


def test_a_mesh_that_is_not_here_has_no_draught():
    shape = {"kind": "mesh", "file": "nowhere.stl"}
    body = {"name": "a", "shape": shape, "density": 1.0, "material": "m", "position": [0.0, 0.0, 0.0]}
    assert bodies._if_known(lambda: bodies._shape(body).reach([0.0, 0.0, -1.0])) is None


@pytest.mark.parametrize(("faces", "word"), [
    ({}, "wall"), ({"x_max": "open"}, "of the box"), ({"x_max": {"kind": "wall", "velocity": [0, 1, 0]}}, "wall"),
])  # fmt: skip
def test_the_end_of_a_tank_is_a_wall_or_not(faces, word):
    assert front.end(SimpleNamespace(case={"box": {"faces": faces}})) == word
