"""The semi-implicit scheme gives the same bits on any number of ranks, and in two pieces as in one."""

from pathlib import Path

import pytest

import parsim
from parsim.__main__ import main

CASE = Path(__file__).with_name("same_bits_simps.toml")
WHOLE, PART = "0.02", "0.012"


@pytest.mark.long
def test_same_bits(mpirun, tmp_path, capsys):
    for ranks, out, until in ((1, "one", WHOLE), (3, "three", WHOLE), (2, "pieces", PART)):
        done = mpirun(ranks, ["run", CASE, "-o", tmp_path / out, "--until", until], timeout=240)
        assert done.returncode == 0, done.stdout + done.stderr
    assert mpirun(1, ["resume", tmp_path / "pieces", "--until", WHOLE], timeout=240).returncode == 0
    run = parsim.open(tmp_path / "one")
    solver, bodies = run.series("solver"), run.series("bodies")
    assert run.info["steps"] > 15 and run.info["rebuilds"] > 3 and max(solver["iterations"]) > 5
    x = bodies["x"][bodies["body"] == "floating"]
    assert max(x) - min(x) > 0.006, "nothing has crossed a cut"
    for out in ("three", "pieces"):
        assert main(["compare", str(tmp_path / "one"), str(tmp_path / out)]) == 0, capsys.readouterr().out


@pytest.mark.long
def test_same_bits_around_a_ring(mpirun, tmp_path, capsys):
    case = tmp_path / "ring.toml"
    lines = CASE.with_name("same_bits_periodic.toml").read_text().splitlines()
    case.write_text("\n".join(line for line in lines if not line.startswith("eddies")))
    words = ["--set", "water.scheme.kind=simps", "--until", "0.02"]
    for ranks, out, more in ((1, "one", []), (2, "two", []), (1, "threads", ["--threads", "2"])):
        done = mpirun(ranks, ["run", case, "-o", tmp_path / out, *words, *more], timeout=240)
        assert done.returncode == 0, done.stdout + done.stderr
    solver = parsim.open(tmp_path / "one").series("solver")
    assert 5 < max(solver["iterations"]) < 30
    for out in ("two", "threads"):
        assert main(["compare", str(tmp_path / "one"), str(tmp_path / out)]) == 0, capsys.readouterr().out
