"""What is compiled, and when: the compiler's process makes all that a run needs, so that a run compiles nothing."""

import json
import random
import subprocess
import sys
from pathlib import Path

import pytest
from example_cases import ROOT

from parsim.case.file import read
from parsim.case.model import parse
from parsim.errors import InputError

CASES = sorted(path for path in (ROOT / "cases").rglob("*.toml") if path.name[0] != "_")
COARSE = {"ice_release": 0.01}  # m, for a first look
DRAWN = 40


def compiled(cases, steps=3):
    """The kernels that each case compiles in so many steps once the cache is whole: a list of lists of names."""
    line = [sys.executable, Path(__file__).with_name("compiled.py"), str(steps)]
    done = subprocess.run(line, input=json.dumps(cases), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def drawn(dice):
    """A small valid case with anything in it, as a dict; most are of a few hundred particles."""
    while True:
        case = _drawn(dice)
        try:
            parse(case)
            return case
        except InputError:
            continue


def _drawn(dice):
    flat, width = dice.random() < 0.4, 1.0
    if not flat:
        width = dice.choice((0.06, 0.1))
    faces = {side: dice.choice(("wall", "wall", "open")) for side in ("x_min", "x_max", "z_max")}
    for axis in "x" if flat else "xy":
        if dice.random() < 0.25:
            faces |= {f"{axis}_min": "periodic", f"{axis}_max": "periodic"}
    level = dice.choice((0.02, 0.05, 0.08))
    fill = {"min": [0.0, 0.0, 0.0], "max": [0.2, width, level]}
    if dice.random() < 0.3:
        fill |= {"velocity": [0.1, 0.0, 0.0], "profile": {"kind": dice.choice(("linear", "log")), "roughness": 0.001}}
    rubbing = {}
    if dice.random() < 0.4:
        rubbing["friction"] = {"kind": dice.choice(("wall_law", "no_slip")), "bodies": dice.random() < 0.8}
    if dice.random() < 0.3:
        rubbing["eddies"] = {"kind": dice.choice(("mixing_length", "smagorinsky"))}
    case = {
        "dimensions": 2 if flat else 3, "spacing": 0.01, "box": {"max": [0.4, width, 0.2], "faces": faces},
        "water": rubbing | {"fill": dice.choice(([fill], [fill], [])), "speed": 1.5,
                  "disorder": dice.choice((0.0, 0.1)),
                  "scheme": _scheme(dice, rubbing)},
        "materials": {"wood": {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}},
        "run": {"until": 1.0, "settle": dice.choice((0.0, 0.1))},
        "bodies": [_block(dice, number, width) for number in range(dice.choice((0, 0, 1, 2, 3, 5, 80)))],
    }  # fmt: skip
    if "periodic" in faces.values():  # which no body may come near
        case["bodies"] = []
    if dice.random() < 0.4:
        case["gate"] = {"min_x": 0.2, "max_x": 0.205, "opens": dice.choice((0.0, 0.5))}
    if dice.random() < 0.5:
        case["output"] = {"sensors": [{"name": "one", "x": 0.05}]}
    return case


def _scheme(dice, rubbing):
    """One of the schemes of the water, most often one that knows such friction and eddies."""
    if dice.random() < 0.3:
        return {"kind": "simps", "weight": dice.choice(("wendland_c2", "mps"))}
    given = {"weight": dice.choice(("wendland_c4", "wendland_c2")), "shifting": dice.random() < 0.8}
    if not rubbing and dice.random() < 0.6:
        return given | {"kind": "sphale", "stages": dice.choice((2, 3))}
    # without shifting that weight flings what is squeezed under a body of less than two particles
    return given | ({"weight": "mps", "shifting": True} if dice.random() < 0.3 else {})


def _block(dice, number, width):
    """A block in a row of them that may touch, stand alone, lie under water or be held."""
    size = 0.015
    row, at = divmod(number, 10)
    place = [0.02 + at * dice.choice((size, size, 0.018)), 0.5 * width, 0.01 + 0.02 * row + dice.choice((0.0, -0.0021))]
    return {"name": f"b{number}", "shape": {"size": [size, 1.0 if width == 1.0 else 0.04, size]},
            "density": dice.choice((450.0, 2000.0)), "position": place, "material": "wood",
            "angles": [0.0, dice.choice((0.0, 0.0, 20.0)), 0.0],
            **dice.choice(({}, {}, {"fixed": True}, {"released": 0.5}))}  # fmt: skip


def test_no_case_drawn_at_random_compiles_anything():
    dice = random.Random(1)
    cases = [drawn(dice) for _ in range(DRAWN)]
    bodies = [len(case["bodies"]) for case in cases]
    assert {0, 1, 2} <= set(bodies) and max(bodies) > 2 and any("gate" in case for case in cases)
    assert {case["water"]["scheme"].get("kind") for case in cases if case["bodies"]} == {None, "simps", "sphale"}
    assert [names for names in compiled(cases) if names] == []


def coarsest():
    """The case files of which no other differs in its spacing alone and is coarser."""
    found = {}
    for path in CASES:
        data = read(path)
        spacing, rest = data.get("spacing", 0.0), {key: data[key] for key in data if key not in ("spacing", "title")}
        least, _ = found.get(key := repr(rest), (-1.0, None))
        if spacing > least:
            found[key] = spacing, path
    return [path for _, path in found.values()]


@pytest.mark.long
def test_no_example_compiles_anything():
    paths = coarsest()
    wanted = [
        [str(path), [f"spacing={COARSE[path.parent.name]}"] if path.parent.name in COARSE else []] for path in paths
    ]
    assert dict(zip(map(str, paths), compiled(wanted), strict=True)) == {str(path): [] for path in paths}


@pytest.mark.slow
@pytest.mark.parametrize("path", CASES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_no_example_compiles_anything_as_it_is(path):
    assert compiled([[str(path), []]], 50) == [[]]
