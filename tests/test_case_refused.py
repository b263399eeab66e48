"""A wrong case file is refused before anything is written, in words that name key, value and what is allowed."""

import pytest
from example_cases import bodies, write

from parsim.__main__ import main
from parsim.case.model import load
from parsim.errors import nearest, suggestion


def profile(words):
    """The change that gives the first fill a profile with these words."""
    return ["water.fill.0.profile={" + words + "}"]


# base case, changes, fragments of the messages
BROKEN = {
    "unknown key in a table": ("3d", ["water.scheme.suport=3"],
                               ["water.scheme.suport: unknown key", "did you mean water.scheme.support?"]),
    "unknown key of a body": ("3d", ["bodies.A1.densty=3"], ["bodies.A1.densty: unknown key", "bodies.A1.density?"]),
    "edge of a body that is nothing": ("3d", ["bodies.A1.shape.size=[5e-324,0.05,0.02]"],
                                       ["bodies.A1.shape.size.0 = 5e-324: must be at least 1e-09"]),
    "key in the wrong table": ("3d", ["until=3.0"], ["until: unknown key", "did you mean run.until?"]),
    "unknown table": ("3d", ["wind.speed=3.0"], ["wind: unknown key", "allowed: title, dimensions"]),
    "key of another table": ("3d", ["run.restitution=0.5"], ["run.restitution: unknown key; did you mean"]),
    "text for a number": ("3d", ["spacing=fine"], ["spacing = 'fine': must be a number", "l0, m"]),
    "switch for a number": ("3d", ["run.cfl=true"], ["run.cfl = True: must be a number"]),
    "number for a switch": ("3d", ["water.scheme.shifting=1"], ["water.scheme.shifting = 1: must be true or false"]),
    "number for a text": ("3d", ["title=1"], ["title = 1: must be a text"]),
    "number for a whole number": ("3d", ["run.rebuild_at_most=2.5"], ["run.rebuild_at_most = 2.5: must be a whole"]),
    "number for a table": ("3d", ["gate=1"], ["gate = 1: must be a table"]),
    "number for a list": ("3d", ["bodies=1"], ["bodies = 1: must be a list"]),
    "value inside a value": ("3d", ["spacing.x=1"], ["--set spacing.x=1: spacing is a single value"]),
    "too many entries": ("3d", ["gravity=[0,0,0,1]"], ["gravity = [0, 0, 0, 1]: must have 3 entries"]),
    "too few entries": ("3d", ["gravity=[0,0]"], ["gravity.2: missing"]),
    "not a number": ("3d", ["run.until=nan"], ["run.until = nan: must be", "finite"]),
    "infinite": ("3d", ["gravity=[0,0,-inf]"], ["gravity.2 = -inf: must be", "finite"]),
    "zero end": ("3d", ["run.until=0"], ["run.until = 0: must be greater than 0"]),
    "negative settling": ("3d", ["run.settle=-1"], ["run.settle = -1: must be at least 0"]),
    "cfl too large": ("3d", ["run.cfl=2"], ["run.cfl = 2: must be at most 1.75"]),
    "support too small": ("3d", ["water.scheme.support=1.5"], ["water.scheme.support = 1.5: must be at least 2.1"]),
    "frames of no time": ("3d", ["output.frames=0"], ["output.frames = 0: must be greater than 0"]),
    "frames of next to no time": ("3d", ["output.frames=1e-310"],
                                  ["output.frames = 1e-310: must be greater than 0, 1e-30 or more"]),
    "steps of next to nothing": ("3d", ["run.cfl=1e-320"], ["run.cfl = 1e-320: must be greater than 0, 1e-30 or more"]),
    "file without a name": ("3d", ['bed={file="\\u0000.asc"}'], ["bed.file = '\\x00.asc': must be the path of a file"]),
    "mesh without a name": ("3d", ['bodies.A1.shape={kind="mesh",file="\\u0000"}'],
                            ["bodies.0.shape.file = '\\x00': must"]),
    "course without a name": ("3d", ['channel.discharge={file="\\u0000.csv"}'],
                              ["channel.discharge.file", "cannot be read"]),
    "poisson out of range": ("3d", ["materials.polypropylene.poisson=0.5"], ["poisson = 0.5: must be less than 0.5"]),
    "unknown scheme": ("3d", ["water.scheme.kind=sph"], ["water.scheme.kind = 'sph': must be 'wcmps'"]),
    "unknown face": ("3d", ["box.faces.x_min=glass"], ["x_min = 'glass': must be 'wall', 'open', 'periodic', 'inlet'"]),
    "gate faster than sound": ("3d", ["gate.speed=500.0"], ["gate.speed: 500 m/s; must be less than the speed"]),
    "body faster than sound": ("3d", ["bodies.A1.velocity=[0,0,-900]"], ["bodies.A1.velocity, spin: 900 m/s; must be"]),
    "joint faster than sound": ("3d", ['joints=[{kind="steady",body="A1",velocity=[900.0,0,0]}]'],
                                ["joints.0: 900 m/s; must be less than the speed"]),
    "schedule faster than sound": ("3d", ['joints=[{kind="schedule",body="A1",rows=[[0,0,0,0],[0.01,9,0,0]]}]'],
                                   ["joints.0: 900 m/s; must be less than the speed"]),
    "schedule of one row": ("3d", ['joints=[{kind="schedule",body="A1",rows=[[0,0,0,0]]}]'],
                            ["joints.0.rows = [[0, 0, 0, 0]]: must have at least 2 entries"]),
    "velocity of what is held": ("3d", ["bodies.A1.released=0.1", "bodies.A1.velocity=[0.1,0,0]"],
                                 ["bodies.A1.released = 0.1: velocity = [0.1, 0.0, 0.0] and spin"]),
    "leaf": ("3d", ["bodies.A1.shape.size=[0.05,0.05,0.00001]"], ["as far apart as its thinnest edge, would be 5e+07"]),
    "mesh that is not there": ("3d", ['bodies.A1.shape={kind="mesh",file="nix.stl"}', "run.until=0"],
                               ["run.until = 0: must be"]),
    "mesh that is not there, and more": ("3d", ['bodies.A1.shape={kind="mesh",file="nix.stl"}', "gate.min_x=9.0"],
                                         ["bodies.A1.shape: ", "nix.stl: no such file", "gate.max_x ="]),
    "four dimensions": ("3d", ["dimensions=4"], ["dimensions = 4: must be 2 or 3"]),
    "spacing": ("3d", ["spacing=0.007"],
                ["spacing = 0.007: does not divide box x = 0.4", "that do: 0.006666666666666667, 0.00714285"]),
    "spacing above all edges": ("3d", ["spacing=0.9"], ["spacing = 0.9: does not divide", "that do: 0.1"]),
    "no common measure": ("3d", ["box.max=[0.4,0.1,0.2001]"], ["no usable common measure"]),
    "box inside out": ("3d", ["box.min=[0,0,0.3]"], ["box.max", "z must be greater than that of box.min"]),
    "half periodic": ("3d", ["box.faces.y_min=periodic"], ['box.faces.y_max = "wall"', 'both or none must be "per']),
    "fill outside": ("3d", ["water.fill.1.max=[0.5,0.1,0.02]"], ["water.fill.1.max = [0.5, 0.1, 0.02]: x is outside"]),
    "empty fill": ("3d", ["water.fill.0.max=[0.1,0.1,0.0]"], ["water.fill.0.max", "empty, z must be greater"]),
    "fill faster than sound": ("3d", ["water.fill.0.velocity=[0.0,0.0,-19.9]"],
                               ["water.fill.0.velocity = [0.0, 0.0, -19.9]: reaches 19.9 m/s, must be less than",
                                "sound in the model, 19.81 m/s", "give water.speed"]),
    "top of a profile faster than sound": ("3d", ["water.fill.0.velocity=[10.0,0.0,0.0]", *profile('kind="linear"')],
                                           ["velocity = [10.0, 0.0, 0.0]: reaches 19.99 m/s, must be less than"]),
    "fills overlap": ("3d", ["water.fill.1.min=[0.05,0,0]"], ["water.fill.1: overlaps water.fill.0"]),
    "unknown key of a profile": ("3d", profile('kind="log", rougness=1e-3'),
                                 ["0.profile.rougness: unknown key; did you mean water.fill.0.profile.roughness?"]),
    "key that no profile has": ("3d", profile('kind="linear", breeze=1.0'),
                                ["0.profile.breeze: unknown key; allowed: kind, bottom"]),
    "profile of no kind": ("3d", profile("bottom=0.5"), ["0.profile.kind: missing; one of 'linear', 'log', 'table'"]),
    "unknown profile": ("3d", profile('kind="cubic"'), ["profile.kind = 'cubic': must be 'linear', 'log' or 'table'"]),
    "number for a profile": ("3d", ["water.fill.0.profile=1"], ["water.fill.0.profile = 1: must be a table"]),
    "text in a profile": ("3d", profile('kind="table", heights=[0.0, "top"], shares=[1.0, 1.0]'),
                          ["water.fill.0.profile.heights.1 = 'top': must be a number"]),
    "profile that runs back": ("3d", profile('kind="linear", bottom=2.5'), ["bottom = 2.5: must be at most 2"]),
    "log of no roughness": ("3d", profile('kind="log"'), ["profile.roughness: missing; roughness ks of the bed, m"]),
    "log over boulders": ("3d", profile('kind="log", roughness=9.0'),
                          ["profile.roughness = 9.0: must be less than ten depths of the fill, 1 m"]),
    "table of one height": ("3d", profile('kind="table", heights=[0.1], shares=[1.0]'),
                            ["water.fill.0.profile.heights = [0.1]: must be two or more, ascending"]),
    "table of nothing": ("3d", profile('kind="table"'), ["profile.heights: missing; heights above",
                                                         "profile.shares: missing; shares of the mean"]),
    "table upside down": ("3d", profile('kind="table", heights=[0.1, 0.0], shares=[1.0, 1.0]'),
                          ["profile.heights = [0.1, 0.0]: must be two or more, ascending"]),
    "long table upside down": ("3d", profile(f'kind="table", heights={[1.0] * 999}, shares={[1.0] * 999}'),
                               ["1.0, 1.0, 1...: must be two or more, ascending"]),
    "table with a gap": ("3d", profile('kind="table", heights=[0.0, 0.1, 0.2], shares=[1.0, 1.0]'),
                         ["water.fill.0.profile.shares: 2 entries for 3 heights; must be as many"]),
    "table above the water": ("3d", profile('kind="table", heights=[0.0, 0.11], shares=[1.0, 1.0]'),
                              ["profile.heights = [0.0, 0.11]: must be heights in the fill, 0 to 0.1 m above its b"]),
    "table below the bed": ("3d", profile('kind="table", heights=[-0.01, 0.1], shares=[1.0, 1.0]'),
                            ["profile.heights = [-0.01, 0.1]: must be heights in the fill, 0 to 0.1 m"]),
    "keys of another profile": ("3d", profile('kind="linear", roughness=1e-3, shares=[1.0]'),
                                ["profile.roughness: belongs to kind = 'log'; allowed: kind, bottom"]),
    "key of a linear profile": ("3d", profile('kind="table", heights=[0.0, 0.1], shares=[1.0, 1.0], bottom=0.5'),
                                ["profile.bottom: belongs to kind = 'linear'; allowed: kind, heights, shares"]),
    "unknown weight": ("3d", ["water.scheme.weight=gauss"], ["'gauss': must be 'wendland_c4', 'wendland_c2' or 'mps'"]),
    "too much damping": ("3d", ["water.scheme.noise_damping=0.1"],
                         ["water.scheme.noise_damping = 0.1: must be at most 0.005"]),
    "damping that was": ("3d", ["water.damping_viscosity=0.01"], ["water.damping_viscosity: unknown key"]),
    "too much disorder": ("3d", ["water.disorder=0.6"], ["water.disorder = 0.6: must be at most 0.5"]),
    "no gravity, no speed": ("3d", ["gravity=[0,0,0]"], ["water.speed: missing", "without gravity"]),
    "no water, no speed": ("3d", ["water.fill=[]", "bodies=[]", 'water.scheme={kind="wcmps"}'],
                           ["water.speed: missing", "without fill"]),
    "water and none": ("3d", ['water.scheme={kind="none"}'], ['water.scheme.kind = "none": there is water']),
    "gate outside": ("3d", ["gate.max_x=0.41"], ["gate.max_x = 0.41: outside the tank; must be 0.0 to 0.4"]),
    "gate inside out": ("3d", ["gate.max_x=0.09"], ["gate.max_x = 0.09: must be greater than gate.min_x = 0.1"]),
    "gate without walls": ("3d", ["box.faces.y_max=open"], ["gate: needs walls", 'y_max = "open"']),
    "gate without place": ("3d", ["gate={min_x=0.1}"], ["gate.max_x: missing; downstream face, m"]),
    "body in the gate": ("3d", [bodies(("A1", "[0.08,0.05,0.1]", "[0,0,0]"))], ["A1: is in the gate", "0.005 m"]),
    "bodies overlap": ("3d", [bodies(("A1", "[0.03,0.03,0.1]", "[0,0,0]"), ("A2", "[0.07,0.07,0.1]", "[0,0,0]"))],
                       ["bodies.A2: overlaps bodies.A1"]),
    "same name twice": ("3d", [bodies(("A1", "[0.03,0.03,0.1]", "[0,0,0]"), ("A1", "[0.2,0.05,0.1]", "[0,0,0]"))],
                        ['name = "A1" is given more']),
    "body outside": ("3d", [bodies(("A1", "[0.2,0.09,0.1]", "[0,0,0]"))], ["A1.position", "outside", "0.0 to 0.1"]),
    "corner outside": ("3d", [bodies(("A1", "[0.2,0.026,0.1]", "[0,0,10]"))], ["outside the box, reaches"]),
    "spacing larger than a body": ("3d", ["spacing=0.02"], ["bodies.A1.shape.size", "thinner than two particles"]),
    "bad name": ("3d", [bodies(("A 1", "[0.2,0.05,0.1]", "[0,0,0]"))],
                 ["bodies.A 1.name = 'A 1': must be a letter followed by"]),
    "density and mass": ("3d", ["bodies.A1.mass=0.1"], ["bodies.A1.density, mass: exactly one", "density = 868.0 and"]),
    "unknown material": ("3d", ["bodies.A1.material=polypropilene"],
                         ['bodies.A1.material = "polypropilene": no such material', 'mean polypropylene?']),
    "unknown wall material": ("3d", ["wall_material=glass"], ['wall_material = "glass": no such material; allowed']),
    "heavy body afloat": ("3d", ["bodies.A1.density=1000"], ["bodies.A1.position", "does not float"]),
    "afloat on the floor": ("3d", ["bodies.A1.position=[0.2,0.05,'float']", "water.fill.1.max=[0.4,0.1,0.01]"],
                            ["draught 0.01736 m is more than the depth of water there, 0.01 m"]),
    "afloat without water": ("3d", ["bodies.A1.position=[0.1025,0.05,'float']"], ["no fill under its centre x ="]),
    "wrong word for a height": ("3d", ["bodies.A1.position=[0.05,0.05,'flot']"],
                                ["bodies.A1.position.2 = 'flot': must be a number or 'float'"]),
    "fixed but moving": ("3d", ["bodies.A1.fixed=true", "bodies.A1.spin=[0,0,1]"], ["bodies.A1.fixed = true", "zero"]),
    "gauge outside": ("3d", ["output.sensors.middle.x=0.5"], ["output.sensors.middle.x = 0.5: outside the box"]),
    "no such body": ("3d", ["bodies.A2.density=900"], ["--set bodies.A2.density=900: bodies has no entry A2", "A1"]),
    "no such place": ("3d", ["water.fill.7.max=[1,1,1]"], ["water.fill has no entry 7; allowed: 0, 1"]),
    "set without a value": ("3d", ["spacing"], ["--set spacing: must be key.path=value"]),
    "plane: tilt about x": ("2d", ["bodies.square.angles=[5,0,0]"], ["angles = [5.0, 0.0, 0.0]: x and z must be 0"]),
    "plane: spin about z": ("2d", ["bodies.square.spin=[0,0,1]"], ["spin = [0.0, 0.0, 1.0]: x and z must be 0"]),
    "plane: body width": ("2d", ["bodies.square.shape.size=[0.1,0.5,0.1]"], ["y must be 1 in a 2D case"]),
    "plane: body place": ("2d", ["bodies.square.position=[0.25,0.4,0.4]"], ["y must be 0.5 in a 2D case"]),
    "plane: water across": ("2d", ["water.fill.0.velocity=[0.1,0.2,0.0]"], ["[0.1, 0.2, 0.0]: y must be 0 in a 2D"]),
    "plane: box width": ("2d", ["box.max=[0.5,2.0,0.6]"], ["y = 0.0 to 2.0: must be 0 to 1 in a 2D case"]),
    "plane: y faces": ("2d", ["box.faces.y_min=open"], ["a 2D case has none; leave them out"]),
    "several at once": ("3d", ["water.suport=3.1", "spacing=0.007", "gate.max_x=7", "wall_material=glass"],
                        ["water.scheme.support?", "spacing = 0.007", "gate.max_x = 7", 'wall_material = "glass"']),
}  # fmt: skip

# text of a whole file, fragments of the messages
UNREADABLE = {
    "empty": ("", ["dimensions: missing", "box: missing", "run: missing"]),
    "no spacing": (
        "dimensions = 2\nrun.until = 1\nbox.max = [1.0, 1.0, 1.0]\n[[water.fill]]\nmin = [0.0, 0.0, 0.0]\n"
        "max = [1.0, 1.0, 0.5]\n",
        ["spacing: missing; particle spacing l0, m; required where there is water"],
    ),
    "syntax": ("spacing = 1\nrun = [}\n", ["not valid TOML", "line 2"]),
    "key twice": ("spacing = 1\nspacing = 2\n", ["not valid TOML: spacing is given twice, again on line 2"]),
    "long value twice": (
        "[water]\nfill = [1]\nspeed = 1\nfill = [ # again\n  2,\n  3,\n]\n",
        ["water.fill is given twice, again on line 4"],
    ),
    "key of a body twice": (
        '[[bodies]]\nname = "a"\n[[bodies]]\nname = "b"\nmass = 1\nname = "c"\n',
        ["bodies.name is given twice, again on line 6"],
    ),
    "table twice": ("[box]\n[run]\n[ box ] # again\n", ["box is given twice, again on line 3"]),
    "table that is a value": ("gate = {min_x = 1}\n[gate]\n", ["gate is given twice, again on line 2"]),
    "dotted key twice": (
        "[run]\nuntil = 1\n[box]\nfaces.z_max = 1\nfaces.z_max = 2\n",
        ["box.faces.z_max is given twice, again on line 5"],
    ),
    "key twice between braces": ("gate = {min_x = 1, max_x = 2, min_x = 3}\n", ["min_x is given twice", "line 1"]),
    "deep": ("a = " + "[" * 5000 + "]" * 5000, ["not valid TOML"]),
    "long number": ("spacing = " + "9" * 5000, ["not valid TOML"]),
    "huge number": ("spacing = " + "9" * 400, ["spacing = 999"]),
    "bytes": (b"\xff\xfe\x00", ["not a text file in UTF-8"]),
    "extends itself": ('extends = "case.toml"\n', ["extends = loops", "case.toml -> case.toml"]),
    "extends nothing": ('extends = "other.toml"\n', ["other.toml: no such file"]),
    "extends nothing like what there is": ('extends = "x.toml"\n', ["x.toml: no such file\n"]),
    "extends a path that is none": ('extends = "a\\u0000b"\n', ["must be the path of a case file"]),
    "extends a number": ("extends = 1\n", ["extends = 1: must be the path of a case file"]),
}


@pytest.fixture
def base(tmp_path):
    return write(tmp_path)


def refused(capsys, path, changes, fragments):
    """The command line refuses the case twice over: exit code 2, no traceback, nothing written."""
    before = sorted(path.parent.rglob("*"))
    options = [word for change in changes for word in ("--set", change)]
    for words in (["check", str(path)], ["run", str(path), "-o", str(path.parent / "out")]):
        assert main(words + options) == 2
        output = capsys.readouterr()
        assert all(line.startswith("error: ") for line in output.err.splitlines())
        assert not output.out
        for fragment in fragments:
            assert fragment in output.err
    assert sorted(path.parent.rglob("*")) == before
    return output.err


@pytest.mark.parametrize("kind", ["3d", "2d"])
def test_the_cases_the_broken_ones_are_made_from_are_valid(base, kind):
    assert load(base[kind]).warnings() == []


@pytest.mark.parametrize("name", BROKEN)
def test_broken_values_are_refused(capsys, base, name):
    kind, changes, fragments = BROKEN[name]
    refused(capsys, base[kind], changes, fragments)


@pytest.mark.parametrize("name", UNREADABLE)
def test_broken_files_are_refused(capsys, tmp_path, name):
    content, fragments = UNREADABLE[name]
    path = tmp_path / "case.toml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    refused(capsys, path, [], fragments)


def test_a_byte_order_mark_is_read_over(base):
    marked = base["3d"].with_name("marked.toml")
    marked.write_bytes(b"\xef\xbb\xbf" + base["3d"].read_bytes().replace(b"\n", b"\r\n"))
    assert load(marked) == load(base["3d"])


@pytest.mark.parametrize(("name", "known", "meant"), [
    ("suport", ["support", "speed"], "support"), ("x", ["gy", "half"], None), ("wind", ["water", "run"], None),
    ("glass", ["polypropylene", "acrylic"], None), ("4_block_dry", ["4_blocks_dry", "9_blocks_dry"], "4_blocks_dry"),
    ("end", ["until"], None), ("anything", [], None),
])  # fmt: skip
def test_names_are_suggested_by_likeness_only(name, known, meant):
    assert nearest(name, known) == meant
    assert suggestion(meant) == ("" if meant is None else f"; did you mean {meant}?")


def test_missing_files_are_refused(capsys, base):
    misspelt = base["3d"].with_name("spaec.toml")
    refused(capsys, misspelt, [], ["spaec.toml: no such file; did you mean", "space.toml?"])
    refused(capsys, base["3d"].parent, [], ["is a folder"])
    refused(capsys, base["3d"] / "inside.toml", [], ["cannot be read"])


def test_one_message_for_each_fault(capsys, base):
    err = refused(capsys, base["3d"], ["water.suport=3.1", "spacing=0.007", "gate.max_x=7"], [])
    assert len(err.splitlines()) == 3
