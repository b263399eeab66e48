"""Case files under fuzz: every one is accepted or refused in clear words, and nothing is written."""

import contextlib
import io
import math
import os
import random
import string
import tomllib

import pytest
from example_cases import FLOWING, PLANE, ROOT, SPACE
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from parsim.__main__ import main
from parsim.case import estimate
from parsim.case.file import read
from parsim.case.model import load
from parsim.errors import InputError

FEW, MANY = 150, 10_000
SMALL = 3000  # particles of a case that is also built and run
SOURCES = [
    SPACE,
    PLANE,
    FLOWING,
    *(
        file.read_text()
        for file in sorted((ROOT / "cases").rglob("*.toml"))
        if file.name[0] != "_" and "extends" not in file.read_text()
    ),
]
WHOLE = [read(file) for file in sorted((ROOT / "cases").rglob("*.toml")) if file.name[0] != "_"]
BASES = [*map(tomllib.loads, (SPACE, PLANE, FLOWING)), *WHOLE]
ODD = [
    0,
    -1,
    1,
    1e-9,
    1e308,
    -1e308,
    5e-324,
    -0.0,
    10**30,
    -(10**30),
    1e15,
    1e6,
    0.1,
    0.005,
    math.nan,
    math.inf,
    -math.inf,
    True,
    False,
    "",
    "float",
    "wall",
    "periodic",
    "open",
    "wood",
    "A1",
    "\x00",
    "é" * 50,
    [],
    [0.0],
    [0, 0, 0],
    [0.1, 0.1, 0.1],
    [1e9] * 3,
    ["a", 1, {}],
    {},
    {"min": 1},
    {"x_min": "periodic"},
    [[]],
    [{}],
    2,
    3,
]


def mutated(data, dice, times):
    """A deep copy of nested data with `times` places changed, removed, doubled or moved."""
    data = _copy(data)
    for _ in range(times):
        places = list(_places(data))
        holder, key = dice.choice(places)
        act = dice.randrange(8)
        if act < 3:
            holder[key] = _copy(dice.choice(ODD))
        elif act == 3:
            del holder[key]
        elif act == 4 and isinstance(holder[key], (int, float)) and not isinstance(holder[key], bool):
            holder[key] = holder[key] * dice.choice([-1, 0, 0.5, 2, 3.7, 10, 1e-3, 1e3])
        elif act == 5 and isinstance(holder, list):
            holder.append(_copy(holder[key]))
        elif act == 6:
            other, name = dice.choice(places)
            with contextlib.suppress(KeyError, IndexError):
                holder[key] = _copy(other[name])
        elif isinstance(holder, dict):
            holder[dice.choice(["speed", "extends", "name", "minn", "until", "x", "a.b", ""])] = _copy(dice.choice(ODD))
        if not data:
            break
    return data


def _places(data):
    for key in list(data) if isinstance(data, dict) else range(len(data)):
        yield data, key
        if isinstance(data[key], (dict, list)):
            yield from _places(data[key])


def _copy(data):
    if isinstance(data, dict):
        return {key: _copy(value) for key, value in data.items()}
    return [_copy(value) for value in data] if isinstance(data, list) else data


def as_toml(value):
    """TOML of nested data on one line for each key of the top."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {as_toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in value) + '"'
    return repr(value)


def _key(key):
    return '"' + "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in key) + '"'


def garbled(text, dice):
    """The bytes of a text with one thing gone wrong, as editors, disks and people do it."""
    lines, data = text.split("\n"), bytearray(text.encode())
    act = dice.randrange(10)
    at = dice.randrange(len(data))
    if act == 0:
        data[at] ^= 1 << dice.randrange(8)
    elif act == 1:
        del data[at:]
    elif act == 2:
        lines.pop(dice.randrange(len(lines)))
    elif act == 3:
        lines.insert(dice.randrange(len(lines)), dice.choice(lines))
    elif act == 4:
        data[at:at] = dice.choice([b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", b"\r", b"=", b"[[", b'"""', b"#", b"1e999"])
    elif act == 5:
        lines.insert(dice.randrange(len(lines)), "deep = " + "[" * 3000 + "]" * 3000)
    elif act == 6:
        lines.insert(0, "k" * 5000 + " = 1")
    elif act == 7:
        lines.insert(0, 'title = "' + "x" * 10**6 + '"')
    elif act == 8:
        lines.insert(0, f'extends = "{dice.choice(["case.toml", ".", "/", "none.toml", "/dev/null", "a b", "~", ""])}"')
    else:
        data = bytearray(dice.randbytes(200))
    return bytes(data) if act in (0, 1, 4, 9) else "\n".join(lines).encode()


def scribble(dice):
    """Text that looks a little like TOML."""
    return "".join(dice.choice(string.printable) for _ in range(dice.randrange(200))).encode()


def fuzzed(seed):
    """The bytes of a case file, from a seed."""
    dice = random.Random(seed)
    kind = dice.randrange(10)
    if kind < 6:
        data = mutated(dice.choice(BASES), dice, dice.choice([1, 1, 1, 2, 3, 8]))
        return "\n".join(f"{_key(key)} = {as_toml(value)}" for key, value in data.items()).encode("utf-8", "replace")
    return garbled(dice.choice(SOURCES), dice) if kind < 9 else scribble(dice)


def overridden(seed):
    """Texts for --set, from a seed."""
    dice = random.Random(seed)
    keys = [
        "spacing",
        "bodies.A1.density",
        "bodies.7.x",
        "run..until",
        "water.fill.0.max.2",
        "box",
        "gate",
        "a" * 3000,
        "output.sensors.0.name",
        "=",
        "",
        ".",
        "materials.polypropylene.young",
        "bodies.A1.shape.size.1",
    ]
    texts = ["nan", "1e999", "[", '"', "1=2", "\x00", "[1,2,3]", "{a=1}", "9" * 400, "0x10", "1979-05-27", "true", "\n"]
    return [
        dice.choice(keys) + dice.choice(["=", "", "=="]) + dice.choice([*texts, as_toml(dice.choice(ODD))])
        for _ in range(dice.randrange(1, 4))
    ]


def judge(path, data, overrides=()):
    """Load a file; "refused", "accepted" or, small enough to be built and run, "run"."""
    path.write_bytes(data)
    try:
        case = load(path, overrides)
    except InputError as error:
        assert error.messages
        for message in error.messages:
            assert message.strip() and "\n" not in message and len(message) < 2000, message[:300]
            assert not any(noise in message for noise in ("Traceback", "<class", "pydantic", "object at 0x")), message
        return "refused"
    path.write_text(case.to_toml(), encoding="utf-8")
    assert load(path) == case
    told = "\n".join([*estimate.lines(case, 2), *case.warnings()])
    assert "nan" not in told and "inf " not in told and "-" not in told.split("steps")[0], told
    cost = estimate.estimate(case)
    if cost.water + cost.wall + cost.body + cost.gate > SMALL:
        return "accepted"
    take_steps(case)
    return "run"


def take_steps(case):
    """Build a case and take two steps."""
    from parsim.domain.comm import Comm
    from parsim.domain.grid import check_ranks
    from parsim.errors import RunError
    from parsim.run.simulation import Simulation

    with contextlib.suppress(InputError, RunError):
        check_ranks(case, 1)
        simulation = Simulation(case, Comm(case.box.faces.x_min.repeats))
        for _ in range(2):
            simulation.step()


@settings(max_examples=FEW, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 2**63))
def test_a_case_file_is_accepted_or_refused(tmp_path_factory, seed):
    judge(tmp_path_factory.getbasetemp() / "case.toml", fuzzed(seed))


@settings(max_examples=FEW, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 2**63))
def test_a_replaced_value_is_accepted_or_refused(tmp_path_factory, seed):
    judge(tmp_path_factory.getbasetemp() / "case.toml", SPACE.encode(), overridden(seed))


@pytest.mark.slow
def test_ten_thousand_case_files_are_accepted_or_refused(tmp_path):
    begin, verdicts = random.SystemRandom().randrange(2**60), {}
    for seed in range(begin, begin + MANY):
        try:
            verdict = judge(tmp_path / "case.toml", fuzzed(seed))
        except BaseException as error:
            raise AssertionError(f"seed {seed}") from error
        verdicts[verdict] = verdicts.get(verdict, 0) + 1
    print(verdicts)
    assert verdicts["accepted"] > 0.01 * MANY and verdicts["refused"] > 0.3 * MANY
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml"]


@pytest.mark.parametrize("seed", range(40))
def test_the_command_refuses_with_2_and_writes_nothing(tmp_path, monkeypatch, seed):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_bytes(fuzzed(seed))
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        code = main(["check", "case.toml"])
    assert code in (0, 2)
    if code == 2:
        assert all(line.startswith("error: ") for line in said.getvalue().splitlines())
        with contextlib.redirect_stderr(said):
            assert main(["run", "case.toml", "-o", "out"]) == 2
    assert os.listdir(tmp_path) == ["case.toml"]
