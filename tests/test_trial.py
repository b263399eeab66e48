"""`parsim check --trial`: a case run for a while, to tell what the whole will take."""

import re
import subprocess
import sys

import pytest

from parsim.__main__ import main
from parsim.case.load import load
from parsim.commands.trial import told, tried

SMALL = ["cases/still_water/2d.toml", "--set", "spacing=0.02", "--set", "run.settle=0.0"]


@pytest.mark.long
def test_a_case_is_run_for_a_while_and_the_rest_told_by_that(capsys, tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    assert main(["check", *SMALL, "--until", "2000.0", "--trial", "1"]) == 0
    said = re.search(
        r"trial +(\d+) steps to ([\d.]+) s took ([\d.]+) s; at that pace the whole takes", capsys.readouterr().out
    )
    assert said and 0.0 < float(said[2]) < 1000.0
    assert not any(tmp_path.rglob("run.json")), "nothing of it stays"


def test_one_that_ends_in_that_time_is_told_as_it_was(capsys):
    assert main(["check", *SMALL, "--until", "0.02", "--trial", "60"]) == 0
    assert re.search(r"trial +all \d+ steps took", capsys.readouterr().out)


SLOW = """
import json, pathlib, sys, time
print("compiling the kernels: once per version, about a minute", flush=True)
time.sleep(1.5)
out = pathlib.Path(sys.argv[1])
out.mkdir()
(out / "run.json").write_text(json.dumps({"status": "stopped", "wall_s": 0.5}))
print("t = 0.1 of 1 s", flush=True)
time.sleep(60)
"""


def test_the_time_begins_with_the_steps_not_with_the_compiler(monkeypatch):
    def popen(line, **how):
        return began([sys.executable, "-c", SLOW, line[line.index("-o") + 1]], **how)

    began = subprocess.Popen
    monkeypatch.setattr(subprocess, "Popen", popen)
    assert tried("case.toml", None, None, 1, 0.2)["status"] == "stopped"


def test_core_hours_are_those_of_all_ranks():
    case = load("cases/still_water/2d.toml")
    whole = case.run.until - case.start
    found = {"status": "stopped", "steps": 10, "time": case.start + 0.01 * whole, "wall_s": 72.001}
    assert told(case, found, 1).endswith("the whole takes 2 h 00 min, 2 core-hours")
    assert told(case, found, 4).endswith("the whole takes 2 h 00 min, 8 core-hours")
    assert "no step in 1 min 12 s" in told(case, found | {"time": case.start}, 1)


def test_what_cannot_be_tried_is_told(capsys, tmp_path):
    table = tmp_path / "rows.csv"
    table.write_text("run.until\n1.0\n")
    assert main(["check", *SMALL, "--table", str(table), "--trial", "5"]) == 2
    assert "--trial: tries one case; leave --table out" in capsys.readouterr().err


@pytest.mark.parametrize("fails", ["water.speed=0.0001"])
def test_a_run_that_fails_is_told(capsys, fails):
    """Far too slow an expected speed: the water collapses under its own weight."""
    assert main(["check", *SMALL, "--set", fails, "--until", "20.0", "--trial", "60"]) == 2
    assert "error: --trial: the run failed: step 1, t = " in capsys.readouterr().err
