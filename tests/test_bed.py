"""A bed in a case: what body it becomes, what water and bodies meet there, and what is refused."""

import numpy as np
import pytest
from ground import channel, plane, raster, reach, scattered

from parsim.case.model import load
from parsim.coupling.openings import Openings
from parsim.errors import InputError
from parsim.solid.bodies import from_case
from parsim.solid.shapes.bed import BedShape

CASE = """
dimensions = 3
spacing = 0.1
[box]
max = [2.0, 1.6, 1.2]
[bed]
file = "ground.asc"
origin = [101.0, 200.2]
datum = 3.7
[water]
fill = [{min = [0.0, 0.0, 0.0], max = [2.0, 1.6, 0.7]}]
[materials.rock]
young = 1e9
poisson = 0.3
friction = 0.5
restitution = 0.3
[run]
until = 1.0
"""


def made(folder, shape=channel, holes=(), *changes):
    """The case over a raster of a shape."""
    raster(folder, shape, holes)
    (folder / "case.toml").write_text(CASE)
    return load(folder / "case.toml", changes)


def bed_of(case):
    (body,) = case.bodies
    return body.shape


def test_a_bed_becomes_a_fixed_body_that_reads_back(tmp_path):
    case = made(tmp_path)
    (body,) = case.bodies
    assert case.bed is None and body.name == "bed" and body.fixed and body.material == "rock"
    assert body.position == (1.0, 0.8, 0.0) and body.shape.file == str(tmp_path / "ground.asc")
    (tmp_path / "whole.toml").write_text(case.to_toml())
    assert load(tmp_path / "whole.toml") == case
    raster(tmp_path, plane)
    with pytest.raises(InputError, match="has changed; its SHA-256 is not"):
        load(tmp_path / "whole.toml")


def test_its_heights_are_those_of_the_file_in_the_frame_of_the_case(tmp_path):
    shape = bed_of(made(tmp_path))
    x, y = np.meshgrid(np.linspace(0.0, 2.0, 21), np.linspace(0.0, 1.6, 17), indexing="ij")
    assert shape.heights.x == pytest.approx(x[:, 0]) and shape.heights.y == pytest.approx(y[0])
    assert shape.heights.z == pytest.approx(0.3 + 0.3 * (y - 0.8) ** 2)
    # of a parabola between nodes h apart the mean is h^2 / 6 times its coefficient over it
    assert shape.volume == pytest.approx(2.0 * 1.6 * (0.3 + 0.3 * (0.8**2 / 3 + 0.1**2 / 6)))


@pytest.mark.parametrize("key", ["axis", "angle"])
def test_an_axis_of_two_places_is_an_origin_and_an_angle(tmp_path, key):
    """The plane falls across the case, turned by a quarter: x of the case runs along y of the file."""
    given = {
        "axis": ["bed.axis=[[103.0,200.1],[103.0,201.0]]"],
        "angle": ["bed.angle=90.0", "bed.origin=[103.0,200.1]"],
    }[key]
    raster(tmp_path, plane)
    (tmp_path / "case.toml").write_text(CASE.replace("origin = [101.0, 200.2]\n", ""))
    shape = bed_of(load(tmp_path / "case.toml", [*given, "bed.datum=4.5", "box.max=[1.8,2.6,1.2]", "water.fill=[]"]))
    x, y = np.meshgrid(shape.heights.x, shape.heights.y, indexing="ij")
    assert np.abs(shape.heights.z - (plane(103.0 - y, 200.1 + x) - 4.5)).max() < 1e-12


def test_distances_are_those_from_a_ground_that_has_no_end(tmp_path):
    """Also beside the sides of the box and near its floor: no way out leads through them."""
    shape = bed_of(made(tmp_path, plane, (), "bed.datum=4.7", "water.fill=[]"))
    slope = np.array([0.02, -0.1, 1.0]) / np.sqrt(1.0 + 0.02**2 + 0.1**2)
    dice = np.random.default_rng(3)
    points = dice.uniform([0.0, 0.0, 0.05], [2.0, 1.6, 0.6], (500, 3))
    exact = (points[:, 2] - (plane(101.0 + points[:, 0], 200.2 + points[:, 1]) - 4.7)) * slope[2]
    off = np.abs(shape.away(points - shape.centre) - exact)
    inner = (points[:, :2] > 0.6).all(axis=1) & (points[:, 0] < 1.4) & (points[:, 1] < 1.0)
    assert inner.sum() > 20 and off[inner].max() < 1e-9
    assert off.max() < 0.01, "beyond the sides it goes on level"


def test_samples_hang_in_columns_under_the_ground_and_fill_it(tmp_path):
    case = made(tmp_path)
    shape = bed_of(case)
    every = shape.samples(0.1, 1e9, False)
    assert every.shares.sum() * 0.1**3 == pytest.approx(shape.volume, rel=1e-3)
    assert (shape.away(every.offsets) < 0.0).all() and every.shares.min() > 0.8 and every.shares.max() < 1.2
    tops = every.offsets[every.sample]
    assert np.hypot(*(tops - every.place).T[:2]).max() < 1e-12, "a patch is over its sample"
    assert every.place[:, 2] - tops[:, 2] == pytest.approx(0.05, rel=0.2)
    y = every.place[:, 1]  # from the middle of the box on
    steep = np.sqrt(1.0 + (0.6 * y) ** 2)
    assert np.abs(every.normal[:, 1] + 0.6 * y / steep).max() < 0.02 and (every.normal[:, 2] > 0.9).all()
    assert every.area == pytest.approx(0.01 * steep, rel=0.02)
    thin = shape.samples(0.1, 0.2, False)
    assert len(thin.shares) < 0.9 * len(every.shares) and (-shape.away(thin.offsets)).max() < 0.35
    assert shape.number_of_samples(0.1, 0.2, False) == len(thin.shares)


def test_its_surface_is_closed_and_looks_out(tmp_path):
    import trimesh

    points, quads = bed_of(made(tmp_path)).surface()
    solid = trimesh.Trimesh(points, quads[:, :3], process=False)
    assert solid.is_watertight and solid.is_winding_consistent
    assert solid.volume == pytest.approx(bed_of(made(tmp_path)).volume)


def test_bodies_touch_it_at_its_heights_which_share_its_area(tmp_path):
    elements, cell = bed_of(made(tmp_path)).elements(False)
    assert len(elements) == 21 * 17 and cell == [0.1] * 3
    assert elements[:, 5].sum() == pytest.approx(2.0 * 1.6) and abs(elements[:, 3:5].sum()) < 1e-9


def test_a_body_in_the_bed_is_refused_and_one_over_it_is_not(tmp_path):
    raster(tmp_path, channel)
    block = (
        '[[bodies]]\nname = "a"\nshape = {size = [0.3, 0.3, 0.2]}\ndensity = 900.0\nmaterial = "rock"\n'
        "position = [1.0, 0.8, %s]\n"
    )
    (tmp_path / "case.toml").write_text(CASE + block % "0.41")
    assert len(load(tmp_path / "case.toml").bodies) == 2
    (tmp_path / "case.toml").write_text(CASE + block % "0.36")
    with pytest.raises(InputError, match="overlaps bodies.a by 0.0"):
        load(tmp_path / "case.toml")
    (tmp_path / "case.toml").write_text(CASE + block % "0.36" + "fixed = true\n")
    assert len(load(tmp_path / "case.toml").bodies) == 2, "a pier"


def test_what_was_filled_and_what_is_too_fine_are_doubts(tmp_path):
    case = made(tmp_path, channel, [(20, 10)], 'bed.nodata="linear"')
    (told,) = (text for text in case.warnings() if "no data" in text)
    assert told.startswith(f'bed: "{tmp_path}/ground.asc": no data at 1 of 357 heights, the first at x = 1, y = 0.8 m')
    assert not [text for text in case.warnings() if "resolve" in text]
    rough = made(tmp_path, lambda x, y: 4.2 + 0.12 * np.cos(10.0 * np.pi * (x - 101.0)) + 0.0 * y, (), "spacing=0.2")
    (told,) = (text for text in rough.warnings() if "resolve" in text)
    assert "between heights 0.2 m apart the ground of the file differs by up to 0.24 m from the bed" in told


def test_a_bed_may_be_of_sections_or_points(tmp_path):
    pytest.importorskip("scipy")
    made(tmp_path)
    np.savetxt(tmp_path / "ground.xyz", scattered())
    shape = bed_of(load(tmp_path / "case.toml", ['bed.file="%s"' % (tmp_path / "ground.xyz"), "bed.datum=4.5"]))
    assert shape.heights.z[0, 0] == pytest.approx(plane(101.0, 200.2) - 4.5)
    path = reach(tmp_path)
    changes = [f'bed.file="{path}"', "bed.datum=8.0", "bed.origin=[10.0,-4.0]", "box.max=[40,8,5]", "spacing=1.0"]
    shape = bed_of(load(tmp_path / "case.toml", [*changes, "water.fill=[]", "water.speed=5.0"]))
    assert shape.heights.z[:, 4] == pytest.approx(1.99 - 0.001 * np.arange(41))


@pytest.mark.parametrize(("changes", "said"), [
    (["box.max=[4.0,1.6,1.2]"], "does not cover the box: 24% of it is outside, such as x = 3.1, y = 0 m, which is "
     "(104.1, 200.2) in the file; this reaches from (99.95, 199.95) to (104.05, 202.05)"),
    (["bed.datum=3.95"], "its lowest ground is at z = 0.05 m; must be a spacing, 0.1 m, or more over the floor"),
    (["bed.datum=2.7"], "its ground reaches up to z = 1.492 m, the box to 1.2; change box.max or datum"),
    (['bed.file="gone.asc"'], "gone.asc: no such file"),
    (['bed.nodata="filled"'], "must be 'refuse', 'nearest' or 'linear'"),
    (["bed.axis=[[0,0],[1,0]]"], "bed.axis: stands in place of bed.origin and bed.angle; give one or the other"),
    (['bed.material="rocks"'], 'bodies.bed.material = "rocks": no such material; allowed: rock; did you mean rock?'),
    (["materials={}"], "bed.material: missing; a bed needs a material"),
    (["dimensions=2"], "bed: a 2D case has none; a polygon that is fixed is one"),
    (["bed.resolution=1e-5"], 'ground.asc": bed.resolution = 1e-05: makes 3.2e+10 heights; at most 6.4e+07'),
    (["bed.resolution=0.001", "box.max=[2.0,1.6,20.0]"], ": bed.resolution = 0.001: makes a field of 1.58e+09 nodes"),
    (['box.faces={x_min="periodic",x_max="periodic"}'], 'box.faces.x_min = "periodic" cannot be with it'),
    (["bed.dautm=1.0"], "bed.dautm: unknown key; did you mean bed.datum?"),
])  # fmt: skip
def test_what_is_wrong_with_a_bed_is_told(tmp_path, changes, said):
    with pytest.raises(InputError) as error:
        made(tmp_path, channel, (), *changes)
    assert said in str(error.value)


def test_no_data_is_refused_unless_it_is_to_be_filled(tmp_path):
    with pytest.raises(
        InputError, match=r"bed.file = .*: no data at 1 of 357 heights.*; nodata = \"nearest\" or \"linear\""
    ):
        made(tmp_path, channel, [(20, 10)])


def test_without_spacing_the_distance_of_heights_is_asked_for(tmp_path):
    raster(tmp_path, channel)
    (tmp_path / "case.toml").write_text(CASE.replace("spacing = 0.1\n", "").replace("fill = [{min", "# "))
    with pytest.raises(InputError, match="bed.resolution: missing; distance between its heights"):
        load(tmp_path / "case.toml")
    assert bed_of(load(tmp_path / "case.toml", ["bed.resolution=0.2"])).heights.z.shape == (11, 9)


@pytest.mark.parametrize(("change", "said"), [
    ("bodies.bed.fixed=false", "bodies.bed: a bed must be fixed = true"),
    ("bodies.bed.angles=[0,0,3.0]", "bodies.bed: a bed must be fixed = true, with angles"),
    ("bodies.bed.position=[1.0,0.8,0.01]", "must be the middle of its floor, [1.0, 0.8, 0.0]"),
])  # fmt: skip
def test_a_bed_in_a_completed_case_stays_where_it_is(tmp_path, change, said):
    (tmp_path / "whole.toml").write_text(made(tmp_path).to_toml())
    with pytest.raises(InputError) as error:
        load(tmp_path / "whole.toml", [change])
    assert said in str(error.value)


def test_a_bed_has_no_shape_in_a_plane(tmp_path):
    shape = bed_of(made(tmp_path))
    assert isinstance(shape, BedShape) and list(shape.faults(True)) == ['shape.kind = "bed": a 2D case has none']


@pytest.mark.parametrize(("face", "said"), [
    ('x_max = {kind = "outlet", level = 0.25}', "x_max.level = 0.25: must be above the bed, 0.3"),
    ('x_min = {kind = "inlet", discharge = 0.1, level = 0.35}', "x_min.level = 0.35: must be more than a spacing"),
])  # fmt: skip
def test_a_level_below_the_bed_is_told(face, said, tmp_path):
    raster(tmp_path, channel)
    (tmp_path / "case.toml").write_text(CASE.replace("[bed]", f"[box.faces]\n{face}\n[bed]"))
    with pytest.raises(InputError) as error:
        load(tmp_path / "case.toml")
    assert said in str(error.value)


def test_an_inlet_over_a_bed_gives_water_above_it_only(tmp_path):
    raster(tmp_path, channel)
    face = 'x_min = {kind = "inlet", discharge = 0.1, profile = {kind = "log", roughness = 0.05}}'
    (tmp_path / "case.toml").write_text(CASE.replace("[bed]", f"[box.faces]\n{face}\n[bed]"))
    case = load(tmp_path / "case.toml")
    bodies = from_case(case)
    inlet = Openings(case, case.layers, bodies).inlet
    ground = bed_of(case).heights.at(np.full(inlet._y.size, 0.05), inlet._y)
    assert (inlet.solid == (inlet._z < ground)).mean() > 0.98 and not inlet.awake[inlet.solid].any()
    inlet.follow(0.7, 0.0, 1.0, 0.1)
    assert inlet.speed.sum() * 0.01 == pytest.approx(0.1) and inlet.speed[inlet._z < ground - 0.01].max() == 0.0


def test_floes_come_in_over_a_bed_and_clear_of_its_banks(tmp_path):
    raster(tmp_path, channel)
    face = 'x_min = {kind = "inlet", discharge = 0.1}'
    floes = (
        '[[ice.supplies]]\nname = "run"\nconcentration = 0.5\nshape = "polygon"\nsize = 0.3\nthickness = 0.2\n'
        'density = 900.0\nmaterial = "rock"\n'
    )
    (tmp_path / "case.toml").write_text(CASE.replace("[bed]", f"[box.faces]\n{face}\n[bed]") + floes)
    case = load(tmp_path / "case.toml")
    bodies = from_case(case)
    passage = Openings(case, case.layers, bodies).passage
    passage.queues[0].wanted = 0.2
    passage.turn(0.5)
    came = passage.queues[0].rows[: passage.queues[0].next]
    assert len(came) >= 1 and np.isfinite(bodies.lead[came]).all()
    heights = bed_of(case.model_copy(update={"bodies": tuple(b for b in case.bodies if b.name == "bed")})).heights
    for row in came:
        x, y, z = bodies.position[row]
        assert x + bodies.radius[row] < 0.3 and z == pytest.approx(0.7 - 0.18 + 0.1)
        assert heights.at(np.zeros(1), np.array([y]))[0] < z - 0.1
