"""The shell scripts of a checkout whose set-up is done, with a stand-in for Python; nothing is installed."""

import shutil
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# notes how it was called, makes the output folder of a run, and ends as the test wants
PYTHON = """#!/bin/bash
[[ $1 == --version ]] && { echo "Python 3.12.0"; exit; }
printf '%s\\n' "$*" >>"$(dirname "$0")/calls"
[[ $4 == run ]] || exit 0
[[ $FAKE_CODE == [12] ]] || touch "$7/case.toml"
exit "${FAKE_CODE:-0}"
"""


@pytest.fixture
def checkout(tmp_path):
    """A checkout at a path with spaces, its environment stamped as complete."""
    root = tmp_path / "my check out"
    (root / ".venv" / "bin").mkdir(parents=True)
    (root / "tests").mkdir()
    shutil.copytree(ROOT / "jobs", root / "jobs")
    shutil.copy(ROOT / "tests" / "run.sh", root / "tests")
    shutil.copy(ROOT / "pyproject.toml", root)
    (root / "a case.toml").write_text("")
    (root / ".venv" / "bin" / "python").write_text(PYTHON)
    (root / ".venv" / "bin" / "python").chmod(0o755)
    line = 'source "$0"; for extra in pictures tests terrain; do fingerprint >"$venv/stamp-$extra"; done'
    subprocess.run(["bash", "-c", line, root / "jobs" / "setup.sh"], check=True)
    return root


def start(checkout, script, *arguments, **environment):
    """Called from another folder, with little more than PATH."""
    return subprocess.run(
        ["bash", checkout / script, *map(str, arguments)],
        cwd="/",
        env={"PATH": "/usr/local/bin:/usr/bin:/bin", "HOME": str(checkout), **environment},
        capture_output=True,
        text=True,
        timeout=60,
    )


def calls(checkout):
    return (checkout / ".venv" / "bin" / "calls").read_text().splitlines()


def test_second_start_goes_straight_to_the_run_and_never_over_an_earlier_one(checkout):
    case = checkout / "a case.toml"
    began = time.monotonic()
    assert start(checkout, "jobs/local.sh", case, 3).returncode == 0
    assert time.monotonic() - began < 0.5
    assert start(checkout, "jobs/local.sh", case).returncode == 0
    first, second = (checkout / "runs" / name for name in ("a case", "a case-2"))
    assert calls(checkout) == [
        f"-P -m parsim run {case} -o {first} -n 3",
        f"-P -m parsim report {first}",
        f"-P -m parsim run {case} -o {second} -n 2",
        f"-P -m parsim report {second}",
    ]


@pytest.mark.parametrize(("code", "reports"), [(1, 0), (2, 0), (75, 1)])
def test_exit_code_of_the_run_is_passed_on(code, reports, checkout):
    ran = start(checkout, "jobs/local.sh", checkout / "a case.toml", FAKE_CODE=str(code))
    assert ran.returncode == code
    assert (checkout / "runs" / "a case").exists() == (code == 75)
    assert sum(" report " in call for call in calls(checkout)) == reports


@pytest.mark.parametrize(
    ("arguments", "told"), [(["no case.toml"], "no case file 'no case.toml'"), (["a case.toml", "two"], "'two'")]
)
def test_wrong_words_are_told(arguments, told, checkout):
    words = [checkout / arguments[0] if arguments[1:] else arguments[0], *arguments[1:]]
    ran = start(checkout, "jobs/local.sh", *words)
    assert ran.returncode == 2 and told in ran.stderr


def test_pytest_gets_its_arguments(checkout):
    assert start(checkout, "tests/run.sh", "-m", "slow").returncode == 0
    assert calls(checkout) == ["-m pytest -m slow"]


def stamped(checkout):
    line = 'source "$0"; stamped pictures'
    return subprocess.run(["bash", "-c", line, checkout / "jobs" / "setup.sh"]).returncode == 0


def test_what_makes_the_environment_wrong_makes_the_stamp_wrong(checkout):
    assert stamped(checkout)
    python = checkout / ".venv" / "bin" / "python"
    python.write_text(PYTHON.replace("3.12.0", "3.13.0"))
    assert not stamped(checkout)
    python.write_text(PYTHON)
    with (checkout / "pyproject.toml").open("a") as file:
        file.write("\n# another dependency\n")
    assert not stamped(checkout)
    shutil.copy(ROOT / "pyproject.toml", checkout)
    assert stamped(checkout)
    moved = checkout.rename(checkout.with_name("moved"))
    assert not stamped(moved)


def test_an_environment_of_somebody_else_is_left_alone(checkout):
    (checkout / ".venv" / "stamp-pictures").unlink()
    ran = start(checkout, "jobs/local.sh", checkout / "a case.toml")
    assert ran.returncode == 1 and "not made by this script" in ran.stderr
    assert (checkout / ".venv" / "bin" / "python").read_text() == PYTHON


def test_no_python_is_told_with_the_remedy(checkout):
    shutil.rmtree(checkout / ".venv")
    ran = start(checkout, "jobs/local.sh", checkout / "a case.toml", PYTHON="/nowhere/python3")
    assert ran.returncode == 1
    assert "needs Python 3.11" in ran.stderr and "PYTHON=" in ran.stderr
    assert not list((checkout / ".venv").glob("stamp-*"))
