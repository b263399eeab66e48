"""Case files: completed, checked at every documented spacing, and what is written reads back equal."""

import copy
import math
import tomllib

import numpy as np
import pytest
from example_cases import FLOWING, PLANE, ROOT, SPACE, write
from hypothesis import given, settings
from hypothesis import strategies as st

from parsim.case.model import Case, load, parse, schema
from parsim.errors import InputError

FILES = sorted((ROOT / "cases").rglob("[!_]*.toml"))
NAMES = [str(file.relative_to(ROOT / "cases")) for file in FILES]


# what cases are warned of: fills that the spacing does not divide or of few rows, bodies of few particles
KNOWN = {f"ice_release/{blocks}_blocks_10mm.toml": ["water.fill.1"] for blocks in (4, 9)}
KNOWN |= {f"marin/{spacing}mm.toml": ["water.fill.0"] for spacing in (20, 40)} | {"one_cube/50mm.toml": ["bodies.cube"]}
KNOWN |= {
    "arching/opening_01.toml": ["bodies.right and 1 more", "ice.fields.floe"],
    "arching/opening_04.toml": ["ice.fields.floe"],
    "jam/steady.toml": ["ice.supplies.floe"],
    "jam/surge.toml": ["ice.supplies.floe"],
    "piers/80mm.toml": ["bodies.pier_1 and 6 more", "bodies.floe_1 and 599 more"],
}


@pytest.fixture
def base(tmp_path):
    return write(tmp_path)


@pytest.mark.parametrize("file", FILES, ids=NAMES)
def test_case_files_are_valid_and_read_back_equal(tmp_path, file):
    case = load(file)
    told = [warning.split(";")[0].split(":")[0] for warning in case.warnings()]
    assert told == KNOWN.get(str(file.relative_to(ROOT / "cases")), [])
    (tmp_path / "case.toml").write_text(case.to_toml())
    assert load(tmp_path / "case.toml") == case


@pytest.mark.parametrize("file", [f for f in FILES if f.parent.name == "ice_release"], ids=lambda file: file.stem)
@pytest.mark.parametrize("spacing", [0.002, 0.0025, 0.005, 0.01])
def test_ice_release_facts_at_every_documented_spacing(file, spacing):
    case = load(file, [f"spacing={spacing}"])
    number = int(file.stem[0])
    assert len(case.bodies) == number
    assert sorted(b.name for b in case.bodies)[-1] == {4: "B2", 9: "C3"}[number]
    assert case.speed == pytest.approx(2.426, abs=1e-3)
    for one in case.bodies:
        assert case.density_of(one) == pytest.approx(868, abs=0.5)
        bottom = one.position[2] - one.shape.size[2] / 2
        assert 0.15 - bottom == pytest.approx(0.0195 * case.density_of(one) / 1000, rel=1e-12)
    gaps = {4: 0.005 / 3, 9: 0.0015}[number]
    xs = sorted({one.position[0] for one in case.bodies})
    edges = np.array([0, *[x + s * case.bodies[0].shape.size[0] / 2 for x in xs for s in (-1, 1)], 0.15])
    assert np.diff(edges)[::2] == pytest.approx(gaps, abs=1e-9)


def test_completion():
    case = load(ROOT / "cases/ice_release/4_blocks_25mm.toml")
    assert case.gate.bottom == 0 and case.wall_material == "acrylic" and case.start == -0.3
    assert {gauge.y for gauge in case.output.sensors} == {0.075}
    assert case.sound_speed == 10 * case.speed == 20 * math.sqrt(9.81 * 0.15)
    assert case.mass_of(case.bodies[0]) == 0.089
    square = load(ROOT / "cases/floating_square/half.toml")
    assert square.mass_of(square.bodies[0]) == pytest.approx(5.0) and square.axes == (0, 2)


def test_thin_bodies_are_doubted(base):
    assert "2 particles across" in load(base["3d"], ["spacing=0.01"]).warnings()[0]


def test_extends_merges_tables_and_replaces_lists(base):
    child = base["3d"].with_name("child.toml")
    child.write_text('extends = "space.toml"\n[water]\nviscosity = 0.5\n[[output.sensors]]\nname = "only"\nx = 0.3\n')
    case = load(child, ["output.sensors.only.y=0.01", "bodies.0.density=900", "title=a=b"])
    assert case.water.viscosity == 0.5 and len(case.water.fill) == 2 and case.title == "a=b"
    assert [(gauge.name, gauge.y) for gauge in case.output.sensors] == [("only", 0.01)]
    assert case.bodies[0].density == 900


@pytest.mark.parametrize("edges", [(0.7, 0.15, 0.3), (0.4572, 0.21, 0.17145), (1.0, 1 / 3, 2.0), (0.5, 0.25, 0.125)])
@settings(max_examples=30, deadline=None)
@given(spacing=st.floats(1e-3, 0.2))
def test_proposed_spacings_divide_the_box_and_are_nearest(edges, spacing):
    data = {"dimensions": 3, "spacing": spacing, "box": {"max": list(edges)}, "run": {"until": 1.0}}
    data["water"] = {"speed": 1.0}
    try:
        parse(data)
    except InputError as error:
        (message,) = error.messages
        if "no usable" in message:
            return
        proposed = [float(word) for word in message.split("that do: ")[1].split(", ")]
        for better in proposed:
            parse(data | {"spacing": better})
        assert len(proposed) == 1 or proposed[0] < spacing < proposed[1]


@pytest.mark.parametrize("profile", [
    {"kind": "linear"}, {"kind": "linear", "bottom": 0.3}, {"kind": "log", "roughness": 0.01},
    {"kind": "table", "heights": [0.0, 0.1, 0.4], "shares": [0.5, 1.0, 1.1]},
])  # fmt: skip
def test_profiles_read_back_equal(profile):
    data = tomllib.loads(PLANE)
    data["water"]["fill"][0]["profile"] = profile
    case = parse(data)
    assert parse(tomllib.loads(case.to_toml())) == case
    assert case.water.fill[0].profile.kind == profile["kind"]


def test_schema_describes_every_key():
    tables = [schema(), *schema()["$defs"].values()]
    tables = [table if "properties" in table else table["anyOf"][1] for table in tables]  # or a name alone
    assert len(tables) > 16
    for table in tables:
        for name, key in table["properties"].items():
            assert key.get("description"), name


def test_schema_and_models_know_the_same_keys():
    assert set(schema()["properties"]) == {*Case.model_fields, "extends"}


# complete, so that every key there is can be mutated
VALID = [tomllib.loads(parse(tomllib.loads(text)).to_toml()) for text in (SPACE, PLANE, FLOWING)]
VALUES = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5), st.just("float"), st.just([]),
    st.lists(st.floats(), max_size=4), st.lists(st.floats(-1, 1), min_size=3, max_size=3), st.floats(0, 1),
    st.dictionaries(st.text(max_size=3), st.floats(), max_size=2), st.integers(0, 10), st.integers(10**300),
)  # fmt: skip


def places(value, path=()):
    """Every place in a nested dict, with those of new keys."""
    if path:
        yield path
    if isinstance(value, dict):
        yield (*path, "new")
        for key, entry in value.items():
            yield from places(entry, (*path, key))
    if isinstance(value, list):
        for key, entry in enumerate(value):
            yield from places(entry, (*path, key))


@settings(max_examples=600, deadline=None)
@given(data=st.data(), kind=st.integers(0, 2))
def test_mutations_are_accepted_or_refused_but_never_crash(data, kind):
    case = copy.deepcopy(VALID[kind])
    for _ in range(data.draw(st.integers(1, 4))):
        *parents, last = data.draw(st.sampled_from(list(places(case))))
        table = case
        for step in parents:
            table = table[step]
        if data.draw(st.booleans()) or last == "new":
            table[last] = copy.deepcopy(data.draw(VALUES))
        else:
            del table[last]
    try:
        accepted = parse(case)
    except InputError as error:
        assert error.messages and all(error.messages)
    else:
        assert parse(tomllib.loads(accepted.to_toml())) == accepted
        assert accepted.sound_speed > 0


@settings(max_examples=100, deadline=None)
@given(
    title=st.text(st.characters(exclude_categories=["Cs"])),
    density=st.floats(1e-3, 999),
    young=st.floats(1e-30, 1e15),
    velocity=st.tuples(*[st.floats(-10.0, 10.0)] * 3),
    x=st.floats(0.02501, 0.07499),
    mass=st.booleans(),
)
def test_what_is_written_reads_back_equal(tmp_path_factory, title, density, young, velocity, x, mass):
    data = copy.deepcopy(VALID[0])
    data["title"] = title
    data["materials"]["polypropylene"]["young"] = young
    data["bodies"][0] |= {"density": density, "velocity": list(velocity), "position": [x, 0.05, "float"]}
    if mass:
        data["bodies"][0]["mass"] = data["bodies"][0].pop("density") * 5e-5
    case = parse(data)
    path = tmp_path_factory.getbasetemp() / "written.toml"
    path.write_text(case.to_toml(), encoding="utf-8")
    assert load(path) == case
