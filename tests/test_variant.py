"""Kernel variants: which there are, which is chosen, and that a choice holds for the whole job."""

import json
import os
import pickle
import subprocess
import sys
import zlib
from pathlib import Path

import pytest
from strangers import NOBODY, as_root, give_away

import parsim
from parsim.__main__ import main
from parsim.errors import InputError
from parsim.machine import variant
from parsim.run import probe, warm

CASE = Path(__file__).parent / "same_bits.toml"


@pytest.fixture
def empty(tmp_path, monkeypatch):
    """A cache folder without a choice, in a process that has made none."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv(variant.NAME, raising=False)
    return tmp_path / "cache" / "parsim"


@pytest.mark.parametrize("features, names", [
    ({"avx2": True, "avx512vl": True}, ["256", "256-gather", "512", "512-gather"]),
    ({"avx2": True, "avx512vl": False}, ["256", "256-gather"]),
    ({}, ["host"]),
])  # fmt: skip
def test_what_a_processor_can_run(features, names, monkeypatch):
    monkeypatch.setattr(variant, "_host", lambda: ("some", features))
    assert variant.possible() == names


def test_a_choice_is_remembered_for_this_kind_of_processor(empty):
    assert variant.chosen() is None
    variant.remember(variant.possible()[-1])
    assert variant.chosen() == variant.possible()[-1]
    (file,) = empty.iterdir()
    file.write_text("something else")
    assert variant.chosen() is None


def test_a_folder_that_cannot_be_written_is_no_error(empty):
    empty.parent.mkdir()
    empty.write_text("a file in its place")
    variant.remember("256")
    assert variant.chosen() is None


def test_an_unknown_variant_is_refused_by_name(tmp_path, capsys):
    with pytest.raises(InputError, match="kernel = 257: .* possible: .*"):
        variant.checked("257")
    assert main(["run", str(CASE), "-o", str(tmp_path / "out"), "--kernel", "257"]) == 2
    assert capsys.readouterr().err.count("error: kernel = 257") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(len(variant.possible()) == 1, reason="this processor has one variant")
def test_another_variant_than_that_which_is_loaded_is_refused(tmp_path, capsys, monkeypatch):
    warm.prepare()
    other = next(name for name in variant.possible() if name != os.environ[variant.NAME])
    monkeypatch.setenv(variant.NAME, other)
    assert main(["run", str(CASE), "-o", str(tmp_path / "out")]) == 2
    assert f"error: kernel = {other}: this process has loaded numba" in capsys.readouterr().err


@pytest.mark.parametrize("seconds, best", [
    ({"256": 1.0, "512": 0.99}, "256"), ({"256": 1.0, "512": 0.8, "512-gather": 0.9}, "512"), ({"512": 1.0}, "256"),
])  # fmt: skip
def test_only_what_is_clearly_faster_is_chosen(seconds, best, monkeypatch):
    monkeypatch.setattr(variant, "possible", lambda: ["256", "512", "512-gather"])
    monkeypatch.setattr(probe, "measured", lambda names: seconds)
    assert probe.fastest() == best


@pytest.mark.long
def test_every_possible_variant_can_be_timed():
    found = probe.measured(variant.possible())
    assert list(found) == variant.possible() and min(found.values()) > 0


def test_numba_is_told_the_variant(tmp_path):
    script = (
        "import os; from parsim.machine import variant; variant.apply(); from numba.core import config; "
        "print(config.CPU_NAME, config.CPU_FEATURES)"
    )
    told = {
        name: subprocess.run(
            [sys.executable, "-c", script],
            env=os.environ | {variant.NAME: name},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for name in variant.possible()
    }
    assert len(set(told.values())) == len(told)
    assert all(
        ("+prefer-no-gather" in text) != name.endswith("-gather") for name, text in told.items() if name != "host"
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", variant.possible())
def test_same_bits_with_every_variant(name, mpirun, tmp_path, capsys):
    ways = {"one": (1, []), "two": (2, []), "threads": (1, ["--threads", "2"])}
    for way, (ranks, options) in ways.items():
        done = mpirun(ranks, ["run", CASE, "-o", tmp_path / way, "--kernel", name, *options], timeout=400)
        assert done.returncode == 0, done.stdout + done.stderr
    assert parsim.open(tmp_path / "two").info["kernel"] == name
    for way in ("two", "threads"):
        assert main(["compare", str(tmp_path / "one"), str(tmp_path / way)]) == 0, capsys.readouterr().out


def run_once(cache, out, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    line = [sys.executable, "-m", "parsim", "run", CASE, "-o", out, "--until", "0.01"]
    return subprocess.run(line, capture_output=True, text=True)


@pytest.mark.slow
def test_a_damaged_cache_is_made_anew(tmp_path, monkeypatch):
    assert run_once(tmp_path / "cache", tmp_path / "one", monkeypatch).returncode == 0
    damaged = next((tmp_path / "cache").rglob("*momentum*.nbi"))
    damaged.write_text("garbage")
    ran = run_once(tmp_path / "cache", tmp_path / "two", monkeypatch)
    assert ran.returncode == 0, ran.stderr
    assert "the cache is damaged" in ran.stdout
    assert main(["compare", str(tmp_path / "one"), str(tmp_path / "two")]) == 0
    assert "compiling" not in run_once(tmp_path / "cache", tmp_path / "three", monkeypatch).stdout


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A user's cache folder that holds the machine code of this process: spares a test the compilation."""
    warm.prepare()
    (tmp_path / "home").mkdir(mode=0o700)
    (tmp_path / "home" / "parsim").symlink_to(Path(os.environ["NUMBA_CACHE_DIR"]).parent)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    return Path(os.environ["NUMBA_CACHE_DIR"])


def run_with(cache, out, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache))
    line = [sys.executable, "-m", "parsim", "run", CASE, "-o", out, "--until", "0.01"]
    return subprocess.run(line, capture_output=True, text=True)


def test_a_cache_that_cannot_be_written_is_replaced_with_a_warning(home, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    ran = run_with(tmp_path / "file", tmp_path / "out", monkeypatch)
    assert ran.returncode == 0, ran.stderr
    assert f"{tmp_path / 'file' / home.name} Not a directory; using {home}" in ran.stderr
    assert "compiling" not in ran.stdout


def test_without_any_cache_of_ones_own_the_variable_is_named(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(tmp_path / "file"))
    monkeypatch.setattr(variant, "_spare", lambda: tmp_path / "file")
    monkeypatch.setenv(variant.NAME, variant.possible()[0])
    with pytest.raises(InputError, match="NUMBA_CACHE_DIR: no folder for the kernel cache that this user alone"):
        variant._cache()


class Poison:
    """What makes a folder when it is unpickled."""

    def __init__(self, folder):
        self.folder = folder

    def __reduce__(self):
        return os.mkdir, (str(self.folder),)


@as_root
@pytest.mark.parametrize("name", ["given", "spare"])
def test_a_cache_that_another_user_has_made_is_never_loaded(name, home, public, tmp_path, monkeypatch):
    """All that parsim asks of a complete cache, with code in it that would show if it ran."""
    poison = public / ("given" if name == "given" else f"parsim-{os.geteuid()}")
    loaded = tmp_path / "loaded"
    for index in home.rglob("*.nbi"):
        file = poison / home.name / index.relative_to(home)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(pickle.dumps(Poison(loaded)))
    variant.mark(poison / home.name).write_text("{}")
    give_away(poison)
    if name == "spare":
        monkeypatch.setenv("XDG_CACHE_HOME", "/dev/null")
        monkeypatch.setenv("TMPDIR", str(public))
        ran = run_with("/dev/null", tmp_path / "out", monkeypatch)
        assert ran.returncode == 2 and "error: NUMBA_CACHE_DIR: no folder for the kernel cache" in ran.stderr
    else:
        ran = run_with(poison, tmp_path / "out", monkeypatch)
        assert ran.returncode == 0, ran.stderr
        assert f"{poison} belongs to user {NOBODY}; using {home}" in ran.stderr
    assert not loaded.exists()


def test_a_mark_vouches_for_the_files_it_was_made_for(tmp_path):
    (tmp_path / "part").mkdir()
    code, mark = tmp_path / "part" / "a.nbc", tmp_path / "complete-0"
    code.write_bytes(b"code")
    assert not warm._whole(mark)
    mark.write_text(json.dumps({"part/a.nbc": zlib.crc32(b"code")}))
    assert warm._whole(mark)
    for damage in (b"cods", b"", None):
        code.write_bytes(damage) if damage is not None else code.unlink()
        assert not warm._whole(mark)
    index = tmp_path / "part" / "a.nbi"
    code.write_bytes(b"code")
    mark.write_text(json.dumps({"part/a.nbc": zlib.crc32(b"code"), "part/a.nbi": 0}))
    for entries, good in (({1: 2}, True), ({1: 2, 3: 4}, True), (None, False)):
        index.write_bytes(pickle.dumps("0.68") + pickle.dumps(entries) if entries else b"garbage")
        assert warm._whole(mark) is good
    mark.write_text("{")
    assert not warm._whole(mark)
