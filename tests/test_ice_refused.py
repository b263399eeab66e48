"""A wrong field of ice is refused in words that name key, value and what is allowed."""

import pytest
from ice_cases import BASIN, basin, field, plane

from parsim.case.model import load, parse
from parsim.errors import InputError

LOG = {"kind": "lognormal", "median": 0.2, "sigma": 0.3, "min": 0.1, "max": 0.4}
LONG = "a" * 60
DRY = {"water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [1.2, 1.0, 0.2]}]}}
STEPS = {"water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [1.2, 1.0, 0.2]},
                            {"min": [1.2, 0.0, 0.0], "max": [2.4, 1.0, 0.1]}]}}  # fmt: skip
SHALLOW = {"water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [2.4, 1.0, 0.04]}]}}

# changes of the field, changes of the case, what is told
WRONG = {
    "no concentration": ({"concentration": 0.0}, {}, "ice.fields.ice.concentration = 0.0: must be greater than 0"),
    "too dense": ({"concentration": 0.95}, {}, "ice.fields.ice.concentration = 0.95: must be at most 0.9"),
    "unknown law": ({"size": LOG | {"kind": "lognorml"}}, {},
                    "size.kind = 'lognorml': must be 'list', 'uniform', 'lognormal', 'power' or 'histogram' (one of "
                    "'list', 'uniform', 'lognormal', 'power', 'histogram'); did you mean lognormal?"),
    "no law": ({"size": {"median": 0.2}}, {}, "ice.fields.ice.size.kind: missing; one of 'list'"),
    "law of thickness for a size": ({"size": {"kind": "ratio", "ratio": 0.1}}, {}, "size.kind = 'ratio': must be"),
    "key of another law": ({"size": LOG | {"exponent": 2.0}}, {}, "size.exponent: belongs to kind = 'power'"),
    "misspelt key of a law": ({"size": {"kind": "uniform", "min": 0.1, "maxx": 0.2}}, {},
                              "size.maxx: unknown key; did you mean ice.fields.ice.size.max?"),
    "negative size": ({"size": -0.2}, {}, "ice.fields.ice.size = -0.2: must be at least 1e-09 (size, m"),
    "no values": ({"size": {"kind": "list", "values": []}}, {}, "size.values = []: must be at least one"),
    "text for a law": ({"size": "large"}, {}, "ice.fields.ice.size = 'large': must be a table"),
    "limits swapped": ({"size": LOG | {"min": 0.5}}, {}, "size.min = 0.5: must not be greater than max = 0.4"),
    "negative sigma": ({"size": LOG | {"sigma": -1.0}}, {}, "size.sigma = -1.0: must be greater than 0"),
    "shares": ({"size": {"kind": "list", "values": [0.1, 0.2], "shares": [0.5, 0.6]}}, {}, "their sum is 1.1; must"),
    "negative share": ({"size": {"kind": "list", "values": [0.1], "shares": [-1.0]}}, {}, "shares.0 = -1.0: must be"),
    "no file": ({"size": {"kind": "histogram", "file": "/none.csv"}}, {}, "size: file = '/none.csv': cannot be read"),
    "thickness by area": ({"thickness": {"kind": "uniform", "min": 0.05, "max": 0.1, "weight": "area"}}, {},
                          'thickness.weight = "area": is for size'),
    "aspect below 1": ({"aspect": {"kind": "uniform", "min": 0.5, "max": 2.0}}, {}, "aspect: reaches down to 0.5"),
    "aspect of a list": (
        {"aspect": {"kind": "list", "values": [2.0, 0.5]}}, {}, "aspect: reaches down to 0.5; must be at least 1"
    ),
    "aspect of discs": ({"aspect": 1.5, "shape": "disc"}, {}, "aspect: discs have none; leave it out"),
    "unknown shape": ({"shape": "polygn"}, {}, "shape = 'polygn': must be 'box', 'disc' or 'polygon' (what the floes "
                                               "are; in 2D box); did you mean polygon?"),
    "outside the box": ({"max": [2.6, 1.0]}, {}, "max = [2.6, 1.0]: x is outside the box, 0.0 to 2.4"),
    "empty": ({"min": [0.5, 1.0]}, {}, "max = [2.4, 1.0]: empty, y must be greater than that of min = [0.5, 1.0]"),
    "one coordinate in 3D": ({"min": [0.5]}, {}, "must have 2 entries, x and y each"),
    "no coordinate": ({"min": []}, {}, "min = [], max = [2.4, 1.0]: must have 2 entries"),
    "no water": ({}, DRY, "no water beneath at x = 1.8, y = 0.5; the rectangle must be over water.fill"),
    "two levels": ({}, STEPS, "the water beneath is at levels from 0.1 to 0.2; must be at one"),
    "too shallow": ({"density": 990.0}, SHALLOW, "a draught of 0.0594 m, more than the depth of water there, 0.04 m"),
    "sinks": ({"density": 1000.0}, {}, "density = 1000.0: does not float; must be below that of the water, 1000.0"),
    "unknown material": ({"material": "ics"}, {}, 'ice.fields.ice.material = "ics": no such material; allowed: ice'),
    "supersonic": ({"velocity": [0.0, 90.0, 0.0]}, {}, "velocity = [0.0, 90.0, 0.0]: must be slower than the sound"),
    "too large": ({"size": 1.5}, {}, "floes do not fit into the rectangle, the largest of 1.5 m into 2.38 by 0.98 m"),
    "too thin": ({"thickness": 0.02}, {}, "floes are thinner than two particles at spacing = 0.02, the thinnest 0.02"),
    "too narrow": ({"size": 0.1, "aspect": 6.0, "shape": "box"}, {}, "thinner than two particles"),
    "too little": ({"size": 0.9, "concentration": 0.01}, {}, "asks for 0.024 m2, less than half of the first floe"),
    "too many": ({"size": 0.0005}, {}, "size: more than 100000 floes cover 1.2 m2"),
    "no room": ({"concentration": 0.9, "shape": "disc", "size": 0.3}, {}, "concentration = 0.9: no room for"),
    "no room is left of it": ({"max": [0.01, 1.0], "size": 0.05}, {}, "nothing of the rectangle is left"),
    "floes that are not there": ({"floes": 3}, {}, "floes = 3: there are 0 bodies ice_1 to ice_3; leave floes out"),
    "long name": ({"name": LONG}, {}, f"ice.fields.{LONG}.name: 60 letters; at most 56"),
    "unknown key": ({"concentrtion": 0.4}, {}, "ice.fields.ice.concentrtion: unknown key; did you mean ice.fields"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_refused(name):
    of_field, of_case, told = WRONG[name]
    with pytest.raises(InputError) as found:
        parse(basin(field(**of_field), **of_case))
    assert told in str(found.value)
    assert len(found.value.messages) <= 2, "told once, not for every floe"


@pytest.mark.parametrize(("change", "told"), [
    ({"min": [0.0, 0.0]}, "must have 1 entry, x, in a 2D case each"),
    ({"shape": "disc"}, 'shape = "disc": must be "box" in a 2D case'),
    ({"aspect": 2.0}, "aspect: floes of a 2D case have none"),
    ({"velocity": [0.0, 0.1, 0.0]}, "velocity = [0.0, 0.1, 0.0]: y must be 0"),
    ({"size": 1.99}, "1 of 1 floes do not fit into the rectangle, the largest of 1.99 m into 1.98"),
    ({"concentration": 0.9, "gap": 0.05}, "there was for 0."),
])  # fmt: skip
def test_refused_in_a_plane(change, told):
    with pytest.raises(InputError, match="ice.fields.ice.") as found:
        parse(plane(change))
    assert told in str(found.value)


def test_two_fields_of_one_name():
    with pytest.raises(InputError, match='ice: name = "ice" is given more than once'):
        parse(basin(field(max=[1.0, 1.0]), field(min=[1.2, 0.0])))


def test_no_water_at_all():
    case = basin(field(), spacing=None, water={})
    with pytest.raises(InputError, match=r"ice\.fields\.ice\.min, max: there is no spacing, and no water to float in"):
        parse({key: value for key, value in case.items() if value is not None})


def test_what_a_crowd_is_told():
    with pytest.raises(InputError) as found:
        parse(basin(field(concentration=0.9, shape="disc", size=0.3)))
    text = str(found.value)
    reached = float(text.split("there was for ")[1].split(". Ask")[0])
    assert 0.5 < reached < 0.85 and "or for polygons" in text
    parse(basin(field(concentration=reached - 0.04, shape="disc", size=0.3)))


def test_files_of_laws_are_found_beside_the_case(tmp_path):
    (tmp_path / "sizes.csv").write_text("0.1,0\n0.2,0.6\n0.3,0.4\n")
    text = "\n".join([
        'dimensions = 3', "spacing = 0.02", "[box]", "max = [2.4, 1.0, 0.4]", "[water]",
        "fill = [{min = [0.0, 0.0, 0.0], max = [2.4, 1.0, 0.2]}]", "[materials.ice]",
        *(f"{key} = {value}" for key, value in BASIN["materials"]["ice"].items()), "[[ice.fields]]", 'name = "ice"',
        "min = [0.0, 0.0]", "max = [2.4, 1.0]", "concentration = 0.3",
        'size = {kind = "histogram", file = "sizes.csv"}',
        "thickness = 0.06", "density = 900", 'material = "ice"', "[run]", "until = 0.1"])  # fmt: skip
    (tmp_path / "case.toml").write_text(text)
    case = load(tmp_path / "case.toml")
    assert case.ice.fields[0].size.edges == (0.1, 0.2, 0.3)
    again = tmp_path / "elsewhere.toml"
    again.write_text(case.to_toml())
    (tmp_path / "sizes.csv").unlink()
    assert load(again) == case, "what is stored needs no file"
