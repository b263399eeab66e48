"""`parsim validate --scheme`: the same cases by several schemes of the water, side by side."""

import json
import subprocess
from types import SimpleNamespace

import pytest

from parsim.__main__ import main
from parsim.fluid import SCHEMES
from parsim.validate import runs, schemes

REFUSAL = 'error: water.scheme.kind = "sphale": knows no friction\n'


@pytest.fixture
def made(monkeypatch):
    """Runs that are made up: by simps a run fails, by sphale it is refused; the bar is 2 within 10 %."""
    said = []

    def run(words, **options):
        said.append(words[3:])
        kind = words[-1].split('"')[1]
        code = {"simps": 1, "sphale": 2}.get(kind, 0)
        return SimpleNamespace(returncode=code, stderr={1: "error: not solved\n", 2: REFUSAL}.get(code, ""))

    monkeypatch.setattr(subprocess, "run", run)
    monkeypatch.setattr(schemes.parsim, "open", lambda out: SimpleNamespace(info={"wall_s": 12.5}, folder=out))
    monkeypatch.setattr(schemes, "published", lambda run: [])
    monkeypatch.setattr(runs, "MEASURES", dict.fromkeys(runs.MEASURES, lambda run, **given: 0.0))
    return said


def test_schemes_are_those_that_move_water():
    assert SCHEMES == ("wcmps", "simps", "sphale")


def test_what_each_measures_refuses_and_takes_is_told(made, tmp_path, capsys):
    words = [
        "validate",
        "dam_break/front_20",
        "-o",
        str(tmp_path),
        *(w for kind in SCHEMES for w in ("--scheme", kind)),
    ]
    assert main(words) == 1, "a run has failed"
    told = capsys.readouterr().out
    assert "case  quantity  unit  reference  bar  wcmps  simps  sphale" in told
    assert "dam_break/front_20  time of the run  s  -  -  12.5  failed  refused" in told
    page = (tmp_path / "index.html").read_text()
    assert "not solved" in page and "knows no friction" in page
    assert made[0][:2] == ["run", made[0][1]] and made[0][-1] == 'water.scheme={kind="wcmps"}'
    assert str(tmp_path / "wcmps" / "dam_break-front_20") in made[0]


def test_what_all_refuse_is_one_row_and_what_is_dry_is_left_out(made, capsys):
    assert main(["validate", "poiseuille/10_rows", "three_blocks", "--scheme", "sphale"]) == 0
    told = capsys.readouterr().out
    assert "poiseuille/10_rows  all  -  -  -  refused" in told and "three_blocks" not in told


def test_rows_for_machines_and_what_does_not_go_with_it(made, tmp_path, capsys):
    assert main(["validate", "dam_break/front_20", "--scheme", "wcmps", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert rows[-1]["quantity"] == "time of the run" and rows[-1]["wcmps"] == "12.5"
    assert main(["validate", "--scheme", "wcmps", "--record", str(tmp_path / "a.csv")]) == 2
    assert "leave them or --scheme out" in capsys.readouterr().err


def test_a_scheme_that_is_none_is_told(capsys):
    assert main(["validate", "--scheme", "simp"]) == 2
    assert (
        "--scheme = simp: no such scheme; did you mean simps?; allowed: wcmps, simps, sphale" in capsys.readouterr().err
    )
