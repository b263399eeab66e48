"""Runs that are stopped, killed, hung or filled up go on where they were, and leave nothing behind."""

import fcntl
import os
import pty
import shutil
import subprocess
import sys
import termios
import time

import pytest

import jobs
import parsim
from jobs import CASE, Job, gone, send, time_of
from parsim.__main__ import main
from parsim.output import checkpoint, lock


@pytest.fixture
def started(tmp_path):
    """`started(words, ...)`: a Job that cannot outlive the test."""
    every = []

    def start(words, *rest, **named):
        every.append(Job(words, *rest, log=tmp_path / "log", **named))
        return every[-1]

    yield start
    for job in every:
        job.close()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The run in one go."""
    out = tmp_path_factory.mktemp("whole") / "out"
    subprocess.run([sys.executable, "-m", "parsim", "run", CASE, "-o", out], check=True, stdout=subprocess.DEVNULL)
    return out


def status(out):
    return parsim.open(out).info["status"]


def contacts(out):
    """Whether bodies have touched in the step before the newest checkpoint."""
    return checkpoint.newest(out)[0].parts["bodies"]["contact_load"].any()


def writing(out):
    """Whether a checkpoint is being written."""
    return any(name.endswith(".part") for name in os.listdir(out / checkpoint.FOLDER))


@pytest.mark.long
def test_five_pieces_are_one_run(whole, tmp_path, started, capsys):
    out = tmp_path / "out"

    by_walltime = started(["run", CASE, "-o", out, "--walltime", "0:05"], 2)
    assert by_walltime.end() == 75
    assert status(out) == "stopped"
    touched = [contacts(out)]

    first = time_of(out)
    by_usr1 = started(["resume", out], 1)
    by_usr1.until(lambda: time_of(out) > first + 0.03)
    send(by_usr1, jobs.USR1)
    assert by_usr1.end() == 75
    touched.append(contacts(out))

    second = time_of(out)
    by_term = started(["resume", out], 3)
    by_term.until(lambda: time_of(out) > second + 0.03)
    send(by_term, jobs.TERM)
    assert by_term.end() == 75
    assert any([*touched, contacts(out)]), "friction and tanks have crossed a stop"

    third = time_of(out)
    rank_killed = started(["resume", out], 2)
    rank_killed.until(lambda: time_of(out) > third + 0.03)
    os.kill(rank_killed.ranks()[1], jobs.KILL)
    assert rank_killed.end() not in (0, 75) and gone(rank_killed)

    fourth = checkpoint.newest(out)[0].account["time"]
    mpirun_killed = started(["resume", out], 2, bare=True)
    mpirun_killed.until(lambda: time_of(out) > fourth + 0.03)
    mpirun_killed.until(lambda: writing(out), pause=0.0)
    send(mpirun_killed, jobs.KILL)
    assert mpirun_killed.end() == -jobs.KILL and gone(mpirun_killed)
    assert time_of(out) < 0.58, "too near the end to be a piece"

    assert started(["resume", out], 1).end() == 0
    assert main(["compare", str(whole), str(out)]) == 0, capsys.readouterr().out
    pieces = parsim.open(out).info["pieces"]
    assert [piece["ranks"] for piece in pieces] == [2, 1, 3, 2, 2, 1]
    assert [piece["ended"] for piece in pieces] == ["walltime", "SIGUSR1", "SIGUSR1", "killed", "killed", "done"]
    assert not list(out.rglob("*.part")) and not (out / lock.NAME).exists()


HANGS = """
import os, signal, sys, time
from parsim.__main__ import main
from parsim.run.simulation import Simulation

how, rank, *words = sys.argv[1:]
step = Simulation.step

def disturbed(self):
    if self.step_count == 20 and int(rank) in (self.comm.rank, -1):
        if how == "sleeps": time.sleep(1000)
        if how == "stops": os.kill(os.getpid(), signal.SIGSTOP)
        if how == "raises": raise ValueError("broken on purpose")
        if how == "dies": os.kill(os.getpid(), signal.SIGKILL)
        if how == "waits": self.comm.max([0.0])
        if how == "nan": self.domain.particles.u[self.near.fluid[:2]] = float("nan")
        if how == "flies": self.bodies.velocity[1] = 1e4
    step(self)

Simulation.step = disturbed
sys.exit(main(words))
"""


@pytest.fixture
def disturbed(tmp_path, started):
    """`disturbed(how, rank)`: the job of three ranks with one of them disturbed, and its output folder."""
    program = tmp_path / "disturbed.py"
    program.write_text(HANGS)

    def start(how, rank, *more):
        out = tmp_path / "out"
        words = [how, rank, "run", CASE, "-o", out, *more]
        return started(words, 3, bare=True, program=(str(program),)), out

    return start


@pytest.mark.parametrize(("how", "rank", "said"), [
    pytest.param("sleeps", 1, "rank 1 of 3 has made no progress for 20 s", marks=pytest.mark.long),
    pytest.param("stops", 0, "rank 0 of 3 has made no progress for 20 s", marks=pytest.mark.slow),
    pytest.param("waits", 1, "has waited 60 s for a message", marks=pytest.mark.slow),
    ("raises", 1, "broken on purpose"),
    pytest.param("dies", 2, "rank 2", marks=pytest.mark.long),
])  # fmt: skip
def test_one_bad_rank_ends_the_job(disturbed, how, rank, said):
    job, out = disturbed(how, rank)
    job.until(lambda: time_of(out) >= 0.0)
    begin = time.monotonic()
    assert job.end() not in (0, 75)
    assert time.monotonic() - begin < (100.0 if how in ("sleeps", "stops", "waits") else 30.0)
    assert said in job.said()
    assert gone(job)
    if how == "sleeps":
        assert "time.sleep(1000)" in job.said()


@pytest.mark.parametrize(("how", "rank", "fault", "named"), [
    ("nan", 1, "faster than the speed of sound", "particle "),
    pytest.param("flies", -1, "the time step has come down", "body right", marks=pytest.mark.long),
])  # fmt: skip
def test_a_run_gone_wrong_names_the_place(disturbed, how, rank, fault, named):
    job, out = disturbed(how, rank)
    assert job.end() == 1
    assert fault in job.said() and named in job.said() and "Traceback" not in job.said()
    assert status(out) == "failed" and "water.speed" in parsim.open(out).info["error"]
    assert parsim.open(out).water(-1)["step"] >= 20


def test_a_killed_parsim_takes_its_ranks_along(tmp_path, started):
    out = tmp_path / "out"
    job = started(["run", CASE, "-o", out], 2)
    job.until(lambda: time_of(out) > 0.01)
    send(job, jobs.KILL)
    assert job.end() == -jobs.KILL and gone(job)


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.slow), pytest.param(2, marks=pytest.mark.long)])
def test_a_closed_terminal_stops_the_run_in_good_order(tmp_path, ranks):
    out, (ours, theirs) = tmp_path / "out", pty.openpty()
    line = [sys.executable, "-m", "parsim", "run", CASE, "-o", out, "-n", str(ranks)]
    job = subprocess.Popen(
        line,
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        start_new_session=True,
        preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY),
    )
    os.close(theirs)
    try:
        begin = time.monotonic()
        while time_of(out) < 0.05:
            assert time.monotonic() - begin < jobs.PATIENCE and os.read(ours, 10_000)
        os.close(ours)
        assert job.wait(jobs.PATIENCE) == 75
    finally:
        job.kill()
    assert status(out) == "stopped" and checkpoint.newest(out)[0].account["time"] > 0.05


@pytest.mark.long
def test_a_second_signal_ends_at_once(disturbed):
    job, out = disturbed("sleeps", 0, "--set", "run.patience=1000.0")
    job.until(lambda: time_of(out) >= 0.0)
    send(job, jobs.TERM)
    assert job.end() != 0 and gone(job)


def test_two_jobs_never_write_one_folder(tmp_path, started, capsys):
    out = tmp_path / "out"
    job = started(["run", CASE, "-o", out], 2)
    job.until(lambda: time_of(out) > 0.01)
    assert main(["resume", str(out)]) == 2
    assert f"another job writes it (host {os.uname().nodename}, process " in capsys.readouterr().err
    assert main(["run", str(CASE), "-o", str(out), "--force"]) == 2
    send(job, jobs.USR1)
    assert job.end() == 75


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 16 MB."""
    place = tmp_path / "disk"
    place.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16m", "none", place], capture_output=True).returncode:
        pytest.skip("no leave to mount a small disk here")
    yield place
    subprocess.run(["umount", "-l", place], check=True)


def fill(place, spare):
    """Fill a disk but for `spare` bytes."""
    with open(place / "filling", "wb") as file:
        file.write(bytes(max(shutil.disk_usage(place).free - spare, 0)))


FILLS = """
import shutil, sys
from pathlib import Path
from parsim.__main__ import program
from parsim.output import checkpoint, frames

victim, place, *words = sys.argv[1:]
owner, name = {"frames": (frames.WaterFrame, "append"), "checkpoints": (checkpoint, "_put_parts")}[victim]
write, calls = getattr(owner, name), []

def filled(*given):
    calls.append(given)
    if len(calls) == 20:
        spare = shutil.disk_usage(place).free
        Path(place, "filling").write_bytes(bytes(spare - 40_000))
    return write(*given)

setattr(owner, name, filled)
sys.argv[1:] = words
program()
"""


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.slow), 2])
@pytest.mark.parametrize("victim", [pytest.param("frames", marks=pytest.mark.slow), "checkpoints"])
@pytest.mark.long
def test_a_disk_that_fills_up_in_the_middle_of_a_file(small_disk, tmp_path, started, capsys, victim, ranks):
    out, code = small_disk / "out", tmp_path / "fills.py"
    code.write_text(FILLS)
    words = ["run", CASE, "--until", "0.15", "--set", "output.frames=0.005"]
    job = started([victim, small_disk, *words, "-o", out], ranks, bare=True, program=(str(code),))
    assert job.end() == 74, job.said()
    last = [line for line in job.said().split("\n") if line.startswith("error: ")]
    assert last[0].startswith(f"error: cannot write {out / victim}") and "No space left on device" in last[0]
    for kind in ("water", "bodies"):
        for at in range(len(parsim.open(out).times(kind))):
            getattr(parsim.open(out), kind)(at)
    assert checkpoint.newest(out)[1] == []
    (small_disk / "filling").unlink()
    assert started(["resume", out], 2).end() == 0
    other = tmp_path / "other"
    assert main([*map(str, words), "-o", str(other)]) == 0
    assert main(["compare", str(other), str(out)]) == 0, capsys.readouterr().out


def test_a_disk_that_is_nearly_full_stops_the_run_in_good_order(small_disk, started):
    out = small_disk / "out"
    # nothing large is written or removed while the disk is filled, for that would change what is left of it
    rare = ["--set", "output.frames=1.0", "--set", "output.checkpoints=15.0"]
    job = started(["run", CASE, "-o", out, "--set", "run.until=0.3", *rare], 1)
    job.until(lambda: time_of(out) > 0.01)
    fill(small_disk, 330_000)
    assert job.end() == 74, job.said()
    assert "stopped with a checkpoint" in job.said()


def test_output_that_will_not_fit_is_refused_before_anything_is_written(small_disk, capsys):
    out = small_disk / "out"
    assert main(["run", str(CASE), "-o", str(out), "--set", "output.frames=0.0001"]) == 74
    assert "GB are free" in capsys.readouterr().err
    assert not out.exists()
