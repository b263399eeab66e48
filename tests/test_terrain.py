"""Ground from files: what every format gives, what lies between, how it is turned, and what is refused."""

import sys

import numpy as np
import pytest
from ground import X, Y, channel, field, plane, raster, scattered, sheet

from parsim import terrain
from parsim.errors import InputError
from parsim.terrain.frame import Frame, along
from parsim.terrain.height_field import HeightField, even
from parsim.terrain.triangles import Triangles

WHOLE = Frame((100.0, 200.0))
GRID = np.linspace(0.0, 4.0, 33), np.linspace(0.0, 2.0, 17)


def on_grid(surface, frame=WHOLE, grid=GRID):
    """Heights of a surface, and those of the plane there."""
    x, y = np.meshgrid(*grid, indexing="ij")
    return surface.on(*grid, frame).z, frame.height(plane(*frame.of_file(x, y)))


def tiff(folder, z=None, crs="EPSG:32188", **changed):
    """A GeoTIFF of the plane, whose cells have the nodes as their middles."""
    rasterio = pytest.importorskip("rasterio")
    z = field().z.T[::-1] if z is None else z
    turn = changed.pop("transform", rasterio.transform.from_origin(X[0] - 0.05, Y[-1] + 0.05, 0.1, 0.1))
    profile = {"driver": "GTiff", "width": z.shape[-1], "height": z.shape[-2], "count": 1, "dtype": "float64"}
    profile |= {"crs": crs, "transform": turn, "nodata": -9999.0} | changed
    with rasterio.open(folder / "ground.tif", "w", **profile) as file:
        for band in range(1, profile["count"] + 1):
            file.write(z, band)
    return folder / "ground.tif"


def points(folder, rows, form="%.17g", head=""):
    np.savetxt(folder / "ground.xyz", rows, form, header=head, comments="")
    return folder / "ground.xyz"


def on_nodes(folder):
    x, y = np.meshgrid(X, Y, indexing="ij")
    rows = np.stack([x, y, plane(x, y)], -1).reshape(-1, 3)
    return points(folder, np.random.default_rng(2).permutation(rows), "%.9f,%.9f,%.9f", "x,y,z")


def on_no_grid(folder):
    pytest.importorskip("scipy")
    return points(folder, scattered())


@pytest.mark.parametrize(("make", "off"), [
    (raster, 1e-12), (tiff, 1e-12), (on_nodes, 1e-8), (on_no_grid, 1e-12), (sheet, 1e-5),
], ids=["asc", "tif", "xyz on a grid", "xyz", "stl"])  # fmt: skip
@pytest.mark.parametrize("turned", [False, True])
def test_a_plane_is_a_plane_whatever_the_file_and_however_it_is_turned(tmp_path, make, off, turned):
    surface, frame, grid = terrain.read(make(tmp_path)), WHOLE, GRID
    if turned:  # a rectangle at 30 degrees within the ground
        frame = Frame((101.5, 200.2), 30.0, 4.5, 1.0)
        grid = np.linspace(0.0, 2.0, 21), np.linspace(0.0, 0.6, 13)
    got, exact = on_grid(surface, frame, grid)
    assert np.abs(got - exact).max() < off


def test_a_raster_covers_its_cells_to_their_edges(tmp_path):
    surface = terrain.read(raster(tmp_path))
    assert surface.low == pytest.approx((99.95, 199.95)) and surface.high == pytest.approx((104.05, 202.05))
    assert surface.at(np.array([99.95]), np.array([202.05])) == pytest.approx(plane(99.95, 202.05))


def test_corners_and_middles_of_cells_are_told_apart(tmp_path):
    for key, first in (("corner", 10.25), ("center", 10.0)):
        head = f"NCOLS 3\nNROWS 2\nXLL{key} 10\nyll{key} 20\ncellsize 0.5\nnodata_value -1\n"
        (tmp_path / "a.asc").write_text(head + "1 2 3\n4 -1 6\n")
        surface = terrain.read(tmp_path / "a.asc")
        assert surface.x == pytest.approx(first + np.arange(3) / 2) and surface.y[0] == pytest.approx(first + 10.0)
        assert surface.z[:, 1].tolist() == [1, 2, 3], "the first row is the northern one"
        assert np.isnan(surface.z[1, 0])


def test_feet_and_another_datum_are_told_by_the_frame():
    frame = Frame((10.0, 20.0), 90.0, 100.0, 0.3048)
    x, y = frame.of_file(np.array([3.048]), np.array([0.0]))
    assert (x[0], y[0]) == pytest.approx((10.0, 30.0)), "x of the case runs along y of the file"
    assert np.ravel(frame.of_case(x, y)) == pytest.approx((3.048, 0.0))
    assert frame.height(101.0) == pytest.approx(0.3048)
    assert along((1.0, 1.0), (2.0, 2.0)) == ((1.0, 1.0), pytest.approx(45.0))


def test_between_nodes_heights_are_bilinear():
    surface = field(lambda x, y: (x - 100.0) * (y - 200.0))
    assert surface.at(np.array([101.23]), np.array([200.77])) == pytest.approx(1.23 * 0.77)
    parabola = field(channel)
    assert parabola.at(np.array([101.0]), np.array([200.75])) == pytest.approx(channel(0, 200.75) + 0.3 * 0.05**2)


def test_of_surfaces_above_each_other_the_top_counts_and_walls_do_not():
    low = [[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]]
    high = [[1, 0, 3], [2, 0, 3], [2, 2, 3], [1, 2, 3]]
    faces = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 6, 7), (0, 1, 5)]
    rows = np.array([0.0, 0.5, 1.5]), np.array([0.5, 1.5])
    assert Triangles(np.array(low + high, float), np.array(faces)).on(*rows, Frame()).z.tolist() == [
        [1, 1],
        [1, 1],
        [3, 3],
    ]


@pytest.mark.parametrize("way", ["linear", "nearest"])
def test_holes_are_filled_and_that_is_told(way):
    holes = [(i, j) for i in range(10, 16) for j in range(5, 9)]
    z = field().z.copy()
    z[tuple(np.transpose(holes))] = np.nan
    filled, told = HeightField(X, Y, z).filled(way)
    off = np.abs(filled.z - field().z)
    assert told == "no data at 24 of 861 heights, the first at x = 101, y = 200.5 m; filled " + {
        "linear": "linearly", "nearest": "with the nearest"}[way]  # fmt: skip
    assert off[~np.isnan(z)].max() == 0.0
    assert off.max() < (1e-12 if way == "linear" else 0.1 * 0.2 + 0.02 * 0.1 + 1e-9)
    assert off.max() > 0.01 or way == "linear"


def test_a_hole_at_the_edge_has_the_height_of_the_nearest():
    z = np.array([[1.0, 2.0, 3.0], [np.nan, 5.0, 6.0], [7.0, 8.0, np.nan]])
    filled, told = HeightField(np.arange(3.0), np.arange(3.0), z).filled("linear")
    assert filled.z[1, 0] == 4.0 and filled.z[2, 2] in (6.0, 8.0)
    assert told.endswith("filled linearly, 1 at the edge with the nearest")


def test_no_data_is_refused_with_how_many_and_where():
    z = field().z.copy()
    z[3, 4] = z[20, 20] = np.nan
    with pytest.raises(
        InputError, match=r'^no data at 2 of 861 heights, the first at x = 100.3, y = 200.4 m; nodata = "'
    ):
        HeightField(X, Y, z).filled("refuse")
    with pytest.raises(InputError, match=r"y = 200 m$"):
        HeightField(X, Y, np.full(z.shape, np.nan)).filled("nearest")


def test_beside_a_node_without_data_there_is_none():
    surface = HeightField(np.arange(3.0), np.arange(2.0), np.array([[0.0, 0.0], [1.0, np.nan], [2.0, 2.0]]))
    got = surface.at(np.array([0.5, 0.5, 1.0, 2.0]), np.array([0.5, 0.0, 0.0, 1.0]))
    assert np.isnan(got[0]) and got[1:].tolist() == [0.5, 1.0, 2.0]


def test_a_grid_of_points_with_a_few_missing_has_holes(tmp_path):
    rows = np.loadtxt(on_nodes(tmp_path), delimiter=",", skiprows=1)
    surface = terrain.read(points(tmp_path, rows[5:]))
    assert isinstance(surface, HeightField) and np.isnan(surface.z).sum() == 5


@pytest.mark.parametrize(("head", "form"), [
    ("x,y,z", "{x},{y},{z},top of bank"),
    ("", "{x}, {y}, {z}"),
    ("id;X;Y;Z", "P1;{x};{y};{z}"),
    ('"z","y","x"', "{z},{y},{x}"),
    ("of 1999\nn y x z\n(-) (m) (m) (m)", "7 {y} {x} {z}"),
    ("Point,Northing,Easting,Elevation,Code", "12,{y},{x},{z},TB"),
])  # fmt: skip
def test_columns_are_those_that_a_head_names(tmp_path, head, form):
    rows = [form.format(x=x, y=y, z=x + 10 * y) for x in (1, 2, 3) for y in (5, 6)]
    (tmp_path / "a.csv").write_text("\n".join([head, *rows]))
    surface = terrain.read(tmp_path / "a.csv")
    assert surface.x.tolist() == [1, 2, 3] and surface.y.tolist() == [5, 6] and surface.z[2, 1] == 63


def test_points_are_on_a_grid_by_where_they_are_not_by_single_steps():
    assert even(np.round(np.arange(50) * 2 / 3, 3)), "rounded to millimetres"
    assert not even(np.cumsum([1.0004] * 200 + [0.9996] * 200)), "off by 0.08 steps amid"


def test_ascii_is_read_as_it_was_written(tmp_path):
    again = terrain.read(raster(tmp_path))
    assert np.array_equal(again.z, field().z) and again.x == pytest.approx(X) and again.y == pytest.approx(Y)


HEAD = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n"


@pytest.mark.parametrize(("name", "text", "said"), [
    ("a.dem", "", "no format of ground; allowed: asc, tif, tiff, xyz, txt, csv, stl, g01 to g99"),
    ("a.tfi", "", "; did you mean tif?"),
    ("a.asc", "1 2 3\n", "its head lacks ncols, nrows, cellsize, xllcorner or xllcenter, yllcorner or yllcenter"),
    ("a.asc", HEAD.replace("cellsize 1", "cellsize 0"), "ncols = 2, nrows = 2, cellsize = 0: must be greater than 0"),
    ("a.asc", HEAD.replace("cellsize 1", "cellsize one"), "cellsize one: must be a number"),
    ("a.asc", HEAD.replace("ncols 2", "ncols 2.7"), "ncols 2.7: must be a whole number"),
    ("a.asc", HEAD.replace("ncols 2", "ncols nan"), "ncols nan: must be finite"),
    ("a.asc", HEAD.replace("xllcorner 0", "XLLCORNER inf"), "XLLCORNER inf: must be finite"),
    ("a.asc", HEAD + "1 2 3\n", "holds 3 heights; ncols = 2, nrows = 2 need 4"),
    ("a.asc", HEAD + "1 2 3 x\n", "a height is no number: could not convert string to float: 'x'"),
    ("a.xyz", "1 2 3\n1 2\n", "line 2: 1 2: must be three numbers x, y, z"),
    ("a.xyz", "x y z\n1 2 3\n1 2 c\n", "line 3: 1 2 c: must be numbers x, y, z"),
    ("a.csv", "305600,12;5106300,50;65,25\n", "line 1: 305600,12;5106300,50;65,25: must have its decimals behind po"),
    ("a.xyz", "1 2 3\n4,5 6 7\n", "line 2: 4,5 6 7: must have its decimals behind points, not commas"),
    ("a.xyz", "1 2 3\n4 5 6\n", "holds 2 points; a surface needs three or more"),
    ("a.stl", "solid a\nendsolid a\n", "holds no triangles"),
    ("a.g1x", "", "no format of ground"),
])  # fmt: skip
def test_what_cannot_be_read_is_told(tmp_path, name, text, said):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError) as error:
        terrain.read(tmp_path / name)
    assert str(error.value).startswith(f"{tmp_path / name}: ") and said in str(error.value)


def test_a_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(InputError, match="a.asc: no such file"):
        terrain.read(tmp_path / "a.asc")


@pytest.mark.parametrize(("changed", "said"), [
    ({"count": 2}, "has 2 bands; heights are one band"),
    ({"crs": "EPSG:4326"}, r"its coordinates are degrees, EPSG:4326; project it to metres"),
    ({"transform": (0.1, 0.02, 100.0, 0.02, -0.1, 200.0)}, "is turned; must have north up"),
])  # fmt: skip
def test_a_geotiff_that_says_too_little_is_refused(tmp_path, changed, said):
    rasterio = pytest.importorskip("rasterio")
    if "transform" in changed:
        changed = {"transform": rasterio.Affine(*changed["transform"])}
    with pytest.raises(InputError, match=said):
        terrain.read(tiff(tmp_path, **changed))


def test_no_data_of_a_geotiff_is_none(tmp_path):
    z = field().z.T[::-1].copy()
    z[0, 0] = -9999.0
    surface = terrain.read(tiff(tmp_path, z))
    assert np.argwhere(np.isnan(surface.z)).tolist() == [[0, 20]]


def test_a_text_is_no_geotiff(tmp_path):
    pytest.importorskip("rasterio")
    (tmp_path / "a.tif").write_text("no")
    with pytest.raises(InputError, match="cannot be read as GeoTIFF"):
        terrain.read(tmp_path / "a.tif")


@pytest.mark.parametrize(("module", "said"), [
    ("rasterio", 'GeoTIFF needs rasterio: pip install "parsim[terrain]"'),
    ("scipy.spatial", 'triangles between them need SciPy: pip install "parsim[terrain]"'),
])  # fmt: skip
def test_what_an_extra_brings_is_told_where_it_is_missing(tmp_path, monkeypatch, module, said):
    monkeypatch.setitem(sys.modules, module, None)
    (tmp_path / "ground.tif").write_text("")
    path = tmp_path / "ground.tif" if module == "rasterio" else points(tmp_path, scattered())
    with pytest.raises(InputError) as error:
        terrain.read(path)
    assert said in str(error.value)


def test_an_empty_cell_is_a_hole(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("x,y,z,code\n0,0,1,7\n1,0,,7\n0,1,3,7\n1,1,4,7\n2,0,4,7\n2,1,5,7\n")
    assert np.array_equal(terrain.read(path).z, [[1.0, 3.0], [np.nan, 4.0], [4.0, 5.0]], equal_nan=True)


def test_rows_may_give_no_data_with_fewer_digits_than_the_head(tmp_path):
    path = tmp_path / "bed.asc"
    path.write_text("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -3.40282346639e+038\n"
                    "1 2\n-3.402823e+038 4\n")  # fmt: skip
    assert np.isnan(terrain.read(path).z).sum() == 1


def test_points_on_one_line_are_no_surface(tmp_path):
    pytest.importorskip("scipy")
    with pytest.raises(InputError, match="its points lie on one line"):
        terrain.read(points(tmp_path, [[0, 0, 1], [1, 1, 2], [3, 3, 4], [4, 4, 1]]))
