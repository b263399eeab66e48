"""What a run writes reads back exactly, by VTK and by our reader; compare finds one changed bit."""

import shutil
import subprocess
import sys

import fake_run
import h5py
import numpy as np
import pytest

import parsim
from parsim.errors import InputError, WriteError
from parsim.output import compare, frames
from parsim.output.series import Table


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    return fake_run.make(tmp_path_factory.mktemp("output") / "a", times=(0.0, 0.4))


@pytest.fixture
def pair(written, tmp_path):
    return written, shutil.copytree(written, tmp_path / "b")


def vtk_read(path):
    hdf = pytest.importorskip("vtkmodules.vtkIOHDF", reason="vtk is not installed")
    reader = hdf.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def vtk_array(values):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(values)


def test_vtk_reads_the_water(written):
    centre, _ = fake_run.poses(0.4)
    points, fields = fake_run.water(0.015, 0.4, centre)
    mesh = vtk_read(written / "frames/water_000001.vtkhdf")
    assert mesh.GetNumberOfVerts() == len(points)
    np.testing.assert_array_equal(vtk_array(mesh.GetPoints().GetData()), points)
    np.testing.assert_array_equal(vtk_array(mesh.GetVerts().GetConnectivityArray()), np.arange(len(points)))
    for name, values in fields.items():
        np.testing.assert_array_equal(vtk_array(mesh.GetPointData().GetArray(name)), values)
    assert mesh.GetFieldData().GetArray("time").GetValue(0) == 0.4


def test_vtk_reads_the_bodies_as_closed_surfaces(written):
    mesh = vtk_read(written / "frames/bodies_000001.vtkhdf")
    centre, quaternion = fake_run.poses(0.4)
    np.testing.assert_array_equal(vtk_array(mesh.GetFieldData().GetArray("quaternion")), quaternion)
    np.testing.assert_array_equal(vtk_array(mesh.GetCellData().GetArray("body")), np.repeat(np.arange(4), 6))
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties, vtkTriangleFilter

    edges = vtkFeatureEdges()
    edges.SetInputData(mesh)
    edges.FeatureEdgesOff()
    edges.Update()
    assert edges.GetOutput().GetNumberOfCells() == 0
    triangles, mass = vtkTriangleFilter(), vtkMassProperties()
    triangles.SetInputData(mesh)
    mass.SetInputConnection(triangles.GetOutputPort())
    assert mass.GetVolume() == pytest.approx(4 * np.prod(fake_run.BLOCK), rel=1e-6)


def test_vtk_reads_a_frame_without_water(tmp_path):
    frames.write_water(tmp_path / "dry.vtkhdf", np.zeros((0, 3)), {"id": np.zeros(0, int)}, 0.0, 0)
    assert vtk_read(tmp_path / "dry.vtkhdf").GetNumberOfPoints() == 0


def test_parts_make_the_same_file_as_the_whole(tmp_path):
    points, fields = fake_run.water(0.015, 0.4, fake_run.poses(0.4)[0])
    frames.write_water(tmp_path / "whole", points, fields, 0.4, 7)
    spec = frames.specification(fields)
    with frames.WaterFrame(tmp_path / "parts", len(points), spec, 0.4, 7) as frame:
        for rows in np.array_split(np.arange(len(points)), 5):
            frame.append(points[rows], {name: values[rows] for name, values in fields.items()})
            assert not (tmp_path / "parts").exists()
    assert (tmp_path / "whole").read_bytes() == (tmp_path / "parts").read_bytes()


@pytest.mark.parametrize("count", [2, 4])
def test_a_frame_with_another_number_of_points_is_not_left_behind(tmp_path, count):
    with pytest.raises(ValueError, match="point"), frames.WaterFrame(tmp_path / "wrong", 3, {}, 0.0, 0) as frame:
        frame.append(np.zeros((count, 3)), {})
    assert not list(tmp_path.iterdir())


def test_a_full_disk_is_a_write_error_and_leaves_nothing(tmp_path):
    script = f"""
import resource, numpy as np
from parsim.errors import WriteError
from parsim.output.frames import write_water
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
try:
    write_water({str(tmp_path / "full")!r}, np.zeros((20_000, 3)), {{}}, 0.0, 0)
except WriteError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == f"cannot write {tmp_path / 'full'}: File too large\n"
    assert not list(tmp_path.iterdir())


def test_an_unwritable_folder_is_a_write_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError, match="File exists .*file.$"):
        frames.write_index(tmp_path / "file" / "water.vtkhdf.series", [])
    with pytest.raises(WriteError):
        Table(tmp_path / "file" / "energy.csv", {"step": "-"})


def test_the_index_reads_back(written):
    entries = frames.read_index(written / "water.vtkhdf.series")
    assert entries == [("frames/water_000000.vtkhdf", 0.0), ("frames/water_000001.vtkhdf", 0.4)]
    assert frames.read_index(written / "nothing.series") == []


def test_the_reader_gives_what_was_written(written):
    run = parsim.open(written)
    centre, quaternion = fake_run.poses(0.4)
    points, fields = fake_run.water(0.015, 0.4, centre)
    frame = run.water(-1)
    np.testing.assert_array_equal(frame["position"], points)
    np.testing.assert_array_equal(frame["velocity"], fields["velocity"])
    assert (frame["time"], frame["step"]) == (0.4, 100)
    bodies = run.bodies(run.nearest(0.35))
    np.testing.assert_array_equal(bodies["quaternion"], quaternion)
    assert bodies["quads"].shape == (24, 4) and bodies["points"].shape == (32, 3)
    assert run.body_names == ["A1", "A2", "B1", "B2"] and run.info["ranks"] == 2
    series = run.series("bodies")
    assert set(series["body"]) == {"A1", "A2", "B1", "B2"} and series["step"].dtype == np.int64


def test_series_keep_every_bit_and_a_torn_row_is_not_read(tmp_path):
    values = np.random.default_rng(0).normal(size=50) * 10.0 ** np.arange(-25, 25)
    table = Table(tmp_path / "series/energy.csv", {"step": "-", "value": "J"})
    for step, value in enumerate([*values, np.nan, np.float64(-0.0)]):
        table.row(step, value)
    table.close()
    with (tmp_path / "series/energy.csv").open("a") as file:
        file.write("52,0.12")
    (tmp_path / "run.json").write_text("{}")
    read = parsim.open(tmp_path).series("energy")
    assert not compare.different(read["value"], np.array([*values, np.nan, -0.0])).any()
    assert len(read["step"]) == 52


def test_a_resumed_table_equals_an_uninterrupted_one(tmp_path):
    def fill(path, steps, **options):
        table = Table(path, {"step": "-", "x": "m"}, **options)
        for step in steps:
            table.row(step, step / 7)
        table.close()

    fill(tmp_path / "a.csv", range(20))
    fill(tmp_path / "b.csv", range(15))
    fill(tmp_path / "b.csv", range(11, 20), resume=10)
    assert (tmp_path / "a.csv").read_text() == (tmp_path / "b.csv").read_text()


def test_a_folder_that_is_no_output_is_refused_with_the_nearest(written, tmp_path):
    with pytest.raises(InputError, match=r"no such folder.*did you mean .*/parts\?$"):
        shutil.copytree(written, written.parent / "parts")
        parsim.open(written.parent / "part")
    with pytest.raises(InputError, match=r"no such folder\)$"):
        parsim.open(written.parent / "q")
    with pytest.raises(InputError, match=r"did you mean .*/a\?$"):
        parsim.open(written / "frames")
    with pytest.raises(InputError, match=r"did you mean .*/a\?$"):
        parsim.open(written.parent)
    with pytest.raises(InputError, match="neither run.json nor a checkpoint"):
        parsim.open(tmp_path)
    with pytest.raises(InputError, match="did you mean energy"):
        parsim.open(written).series("enrgy")
    with pytest.raises(InputError, match="series = 3: .*there are: bodies, counts, energy"):
        parsim.open(written).series(3)


@pytest.mark.parametrize("frame", ["a", 2, -3, 0.4, None])
def test_a_frame_that_is_not_there_is_refused_with_what_is(written, frame):
    with pytest.raises(InputError, match=rf"frame = {frame!r}: must be .* has 2 \(0 to 0.4 s\) of water"):
        parsim.open(written).water(frame)
    assert parsim.open(written).bodies(np.int64(1))["time"] == 0.4


def test_kinds_and_times_that_are_none_are_refused(written):
    run = parsim.open(written)
    with pytest.raises(InputError, match="kind = 'watr': .* must be 'water' or 'bodies'; did you mean water"):
        run.times("watr")
    with pytest.raises(InputError, match="time = 'end': must be a number"):
        run.nearest("end")


def test_a_run_says_what_it_is(written, tmp_path):
    said = repr(parsim.open(written))
    for part in (str(written), "done", "2 (0 to 0.4 s) of water", "of bodies", "bodies, counts, energy"):
        assert part in said
    (tmp_path / "run.json").write_text("{}")
    assert repr(parsim.open(tmp_path)).endswith("status unknown; frames: none of water, none of bodies; series: none>")


def test_equal_outputs_compare_equal_in_any_order_of_particles(pair, capsys):
    points, fields = fake_run.water(0.015, 0.4, fake_run.poses(0.4)[0])
    mixed = np.random.default_rng(0).permutation(len(points))
    fields = {name: values[mixed] for name, values in fields.items()}
    frames.write_water(pair[1] / "frames/water_000001.vtkhdf", points[mixed], fields, 0.4, 100)
    (pair[1] / "series/timings.csv").write_text("# units: -\nstep\n1\n")
    assert compare.compare_outputs(*pair) == 0
    assert "equal bits: 4 frames, 6 series" in capsys.readouterr().out


def test_one_unit_in_the_last_place_is_found(pair, capsys):
    with h5py.File(pair[1] / "frames/water_000001.vtkhdf", "r+") as file:
        velocity = file["VTKHDF/PointData/velocity"]
        row = int(np.flatnonzero(file["VTKHDF/PointData/id"][:] == 321)[0])
        velocity[row, 0] = np.nextafter(velocity[row, 0], np.inf)
    assert compare.compare_outputs(*pair) == 3
    first = capsys.readouterr().out.splitlines()[0]
    assert "frames of water: velocity at step 100, id 321, component 0" in first and "(1 ulp)" in first


def test_a_changed_series_row_and_a_missing_frame_are_found(pair, capsys):
    path = pair[1] / "series/bodies.csv"
    lines = path.read_text().splitlines()
    lines[12] = lines[12].replace("B1", "B2")
    path.write_text("\n".join(lines) + "\n")
    frames.write_index(pair[1] / "water.vtkhdf.series", frames.read_index(pair[1] / "water.vtkhdf.series")[:1])
    assert compare.compare_outputs(*pair) == 3
    told = capsys.readouterr().out
    assert "series bodies: body at step 2" in told and "number of frames: 1 differ" in told


def test_a_lost_particle_is_found(pair, capsys):
    points, fields = fake_run.water(0.015, 0.4, fake_run.poses(0.4)[0])
    frames.write_water(
        pair[1] / "frames/water_000001.vtkhdf", points[1:], {name: v[1:] for name, v in fields.items()}, 0.4, 100
    )
    assert compare.compare_outputs(*pair) == 3
    told = capsys.readouterr().out
    assert "id 0: only in the first" in told and "velocity" not in told


@pytest.mark.parametrize(
    ("a", "b", "distance"),
    [(1.0, 1.0 + 2**-52, 1), (0.0, -0.0, 0), (5e-324, -5e-324, 2), (-1.0, -1.0 - 2**-52, 1), (2.0, 1.0, 2**52)],
)
def test_ulps_count_the_floats_between(a, b, distance):
    a, b = np.array([a]), np.array([b])
    assert compare.different(a, b).all() and compare.ulps(a, b)[0] == distance
    assert compare.ulps(a, np.array([np.nan])) is None
    assert not compare.different(np.array([np.nan]), np.array([np.nan])).any()


def test_comparing_nothing_is_refused(written, tmp_path):
    (tmp_path / "run.json").write_text("{}")
    with pytest.raises(InputError, match="nothing to compare"):
        compare.compare_outputs(tmp_path, written)
