"""The promise: the same bits on any number of ranks and threads and with any cuts."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mesh_cases import box_of, written

import parsim
from parsim.__main__ import main
from parsim.machine import variant

HERE = Path(__file__).parent
CASES = {"3d": HERE / "same_bits.toml", "2d": HERE / "same_bits_2d.toml"}
# cuts that move after rebuilds, or never, are elsewhere on several ranks
WAYS = {
    "two ranks": (2, []),
    "three ranks": (3, []),
    "two ranks, cuts that stay": (2, ["--set", "run.balance_every=1000"]),
    "two threads": (1, ["--threads", "2"]),
}


@pytest.fixture(scope="module")
def one_rank(tmp_path_factory):
    """The output of each case on one rank."""
    folder = tmp_path_factory.mktemp("one")
    for name, case in CASES.items():
        # a process of its own, as for every run: see parsim/run/warm.py
        subprocess.run([sys.executable, "-m", "parsim", "run", case, "-o", folder / name], check=True)
    return folder


@pytest.mark.slow
def test_a_first_run_gives_the_bits_of_a_second(one_rank, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cold"))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    subprocess.run([sys.executable, "-m", "parsim", "run", CASES["3d"], "-o", tmp_path / "first"], check=True)
    assert main(["compare", str(one_rank / "3d"), str(tmp_path / "first")]) == 0, capsys.readouterr().out


@pytest.mark.parametrize("text", ["import parsim.machine.jit\n", "@implements(Gauss)\n", "@compiled\n"])
@pytest.mark.parametrize("change", [
    lambda path: os.utime(path, (1, 1)), lambda path: path.write_text(path.read_text() + "#"),
])  # fmt: skip
def test_changed_sources_get_a_cache_of_their_own(text, change, tmp_path, monkeypatch):
    (tmp_path / "kernels.py").write_text(text)
    monkeypatch.setenv(variant.NAME, "host")
    monkeypatch.setattr(variant, "__file__", str(tmp_path / "machine" / "variant.py"))
    before = variant.code()
    assert variant.code() == before
    change(tmp_path / "kernels.py")
    assert variant.code() != before


@pytest.mark.parametrize("name", CASES)
def test_the_case_does_what_the_comparison_needs(one_rank, name):
    run = parsim.open(one_rank / name)
    energy, counts = run.series("energy"), run.series("counts")
    assert run.info["steps"] > 40 and run.info["rebuilds"] > 4
    assert energy["dissipated_contacts"][-1] > 1e-5, "nothing has touched"
    assert max(counts["lost"]) == max(counts["in_bodies"]) == 0


@pytest.mark.parametrize(("name", "way"), [
    ("3d", "three ranks"), ("2d", "two ranks"), ("2d", "two threads"),
    pytest.param("3d", "two ranks", marks=pytest.mark.long),
    pytest.param("2d", "three ranks", marks=pytest.mark.long),
    pytest.param("3d", "two threads", marks=pytest.mark.long),
    *(pytest.param(name, "two ranks, cuts that stay", marks=pytest.mark.long) for name in ("2d", "3d")),
])  # fmt: skip
def test_same_bits(one_rank, name, way, mpirun, tmp_path, capsys):
    ranks, options = WAYS[way]
    done = mpirun(ranks, ["run", CASES[name], "-o", tmp_path / "other", *options], timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr
    assert main(["compare", str(one_rank / name), str(tmp_path / "other")]) == 0, capsys.readouterr().out


def test_too_many_ranks_are_refused_with_the_number_that_fits(mpirun, tmp_path):
    case = tmp_path / "narrow.toml"
    case.write_text(
        CASES["2d"]
        .read_text()
        .replace("[0.6, 1.0, 0.3]", "[0.04, 1.0, 0.3]")
        .split("[gate]")[0]
        .replace("[0.3, 1.0, 0.15]", "[0.04, 1.0, 0.15]")
        + "[run]\nuntil = 1.0\n"
    )
    done = mpirun(5, ["run", case, "-o", tmp_path / "out"])
    assert done.returncode == 2
    assert "use at most" in done.stderr and done.stderr.count("error:") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.long
@pytest.mark.parametrize(("name", "whole", "part", "kinds"), [
    ("shapes", "0.15", "0.08", {"contact", "joint"}), ("periodic", "0.15", "0.07", {"contact", "water_friction"}),
    ("openings", "0.2", "0.11", {"water_friction"}), ("sway", "0.1", "0.06", {"water"}),
    ("roll", "0.2", "0.12", {"water_friction"}),
])  # fmt: skip
def test_shapes_joints_sides_and_boxes_that_move_have_the_same_bits(name, whole, part, kinds, mpirun, tmp_path, capsys):
    """On one rank, on three, and in two pieces on two and one."""
    case = tmp_path / "case.toml"
    case.write_text((HERE / f"same_bits_{name}.toml").read_text())
    written(tmp_path, box_of((0.04, 0.03, 0.02)), "box.ply")
    for ranks, out, until in ((1, "one", whole), (3, "three", whole), (2, "pieces", part)):
        assert mpirun(ranks, ["run", case, "-o", tmp_path / out, "--until", until], timeout=240).returncode == 0
    assert mpirun(1, ["resume", tmp_path / "pieces", "--until", whole], timeout=240).returncode == 0
    loads = parsim.open(tmp_path / "one").series("loads")
    assert all(np.nanmax(np.abs(loads["fx"][loads["kind"] == kind])) > 0.0 for kind in kinds)
    for out in ("three", "pieces"):
        assert main(["compare", str(tmp_path / "one"), str(tmp_path / out)]) == 0, capsys.readouterr().out
