"""What several test files need: jobs of several ranks that cannot hang, a folder like /tmp, a study."""

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from parsim.launch import mpirun as launch
from parsim.run import warm

PATIENCE = 120  # s for one job
MANY = 1000  # tests, about all of them
LONGEST = "test_uncompiled.py", "test_faults.py", "test_same_bits.py", "test_sphale_runs.py", "test_launch.py"


def pytest_configure(config):
    """Give every mpirun a time limit of its own, also those that a test starts without the fixture; hear SIGINT."""
    os.environ.setdefault("MPIEXEC_TIMEOUT", str(2 * PATIENCE))
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:  # in the background of a script; tests send it
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    """The longest files first, or one of two workers waits for them at the end."""
    items.sort(key=lambda item: item.path.name not in LONGEST)


def pytest_collection_finish(session):
    """Compile all kernels ahead of many tests; few may need few of them, which are then compiled as they are used."""
    if len(session.items) > MANY and "parsim.machine.jit" in sys.modules:
        warm.prepare()


def _arguments(program):
    words = [str(word) for word in (program if isinstance(program, list | tuple) else [program])]
    start = [sys.executable] if words[0].endswith(".py") else [sys.executable, "-m", "parsim"]
    return start + words


def _end(process):
    # mpirun takes its ranks along on SIGTERM, which it cannot do once it is killed
    for number in (signal.SIGTERM, signal.SIGKILL):
        process.send_signal(number)
        try:
            return process.communicate(timeout=10)
        except subprocess.TimeoutExpired:
            continue
    return "", ""


@pytest.fixture
def mpirun():
    """`mpirun(n, program, timeout=120)`: a Python file, or the words after `parsim`, as `n` ranks.

    `program` is one path ending in .py, or a list: such a path and its arguments, or `["run", case, ...]`.
    Returns a CompletedProcess with text output; a job that outlives `timeout` (s) is ended and fails the test.
    """

    def run(n, program, timeout=PATIENCE):
        line = launch.command(n, _arguments(program))
        process = subprocess.Popen(
            line,
            env=launch.environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            out, err = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            out, err = _end(process)
            pytest.fail(f"{' '.join(line)} did not end in {timeout} s\n{out[-2000:]}\n{err[-2000:]}")
        except BaseException:
            _end(process)
            raise
        return subprocess.CompletedProcess(line, process.returncode, out, err)

    return run


@pytest.fixture
def public():
    """A folder that everybody may put things into, as /tmp."""
    folder = Path(tempfile.mkdtemp(dir="/tmp"))
    folder.chmod(0o1777)
    yield folder
    shutil.rmtree(folder)


@pytest.fixture
def study(tmp_path):
    """`study(text, *words)`: the exit code of `parsim study` of the case with these lines in its study."""
    from study_cases import write  # here, or every test would load what studies need

    from parsim.__main__ import main

    def run(text, *words):
        return main(["study", str(write(tmp_path, text)), "-o", str(tmp_path / "out"), *words])

    run.out = tmp_path / "out"
    run.rows = lambda: list(csv.DictReader((run.out / "study.csv").open()))
    run.told = lambda: json.loads((run.out / "study.json").read_text())
    return run
