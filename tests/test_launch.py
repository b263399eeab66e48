"""The launcher: which mpirun, whether its processes find each other, what comes back from a job."""

import os
import signal
import stat
import subprocess
import sys
import time

import pytest

from parsim.commands import doctor
from parsim.errors import InputError
from parsim.launch import mpirun as launch

LAUNCHED = {
    "Open MPI": {"OMPI_COMM_WORLD_SIZE": "4", "OMPI_COMM_WORLD_RANK": "1"},
    "PMI": {"PMI_SIZE": "4", "PMI_RANK": "1"},
    "srun": {"SLURM_STEP_NUM_TASKS": "4", "SLURM_PROCID": "1", "SLURM_NTASKS": "4"},
}
# one process in a batch script or an interactive step, where Slurm tells of the tasks that srun would start
SINGLE = {
    "nothing": {},
    "sbatch": {"SLURM_NTASKS": "4", "SLURM_PROCID": "0", "SLURM_JOB_ID": "7"},
    "salloc": {"SLURM_NTASKS": "4", "SLURM_PROCID": "0", "SLURM_STEP_NUM_TASKS": "1"},
    "one rank": {"OMPI_COMM_WORLD_SIZE": "1", "OMPI_COMM_WORLD_RANK": "0"},
}


@pytest.fixture
def started_by(monkeypatch):
    for name in list(os.environ):
        if name.startswith(("OMPI_COMM", "PMI_", "SLURM_")):
            monkeypatch.delenv(name)
    return lambda variables: [monkeypatch.setenv(*item) for item in variables.items()]


@pytest.fixture
def program(tmp_path):
    def write(text, name="program.py"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize("name", LAUNCHED)
def test_ranks_that_do_not_find_each_other_are_refused(name, started_by):
    started_by(LAUNCHED[name])
    assert launch.world() == (1, 4)
    with pytest.raises(InputError, match=r"started 4 processes.*-n 4"):
        launch.check(1)
    launch.check(4)


@pytest.mark.parametrize("name", SINGLE)
def test_one_process_is_accepted(name, started_by):
    started_by(SINGLE[name])
    assert launch.world() == (0, 1)
    launch.check(1)


@pytest.mark.parametrize("ranks", [2, 3])
def test_ranks_add_up_their_numbers(ranks):
    assert launch.fault(ranks) == ""


def test_a_launcher_of_another_mpi_is_noticed(program, monkeypatch):
    wrong = program('#!/bin/sh\nshift; n=$1; shift\nfor i in $(seq "$n"); do "$@"; done\n', "mpirun")
    wrong.chmod(wrong.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(launch, "launcher", lambda: str(wrong))
    assert "another MPI" in launch.fault(2)


def test_a_launcher_that_hangs_is_noticed(program, monkeypatch):
    monkeypatch.setattr(launch, "command", lambda ranks, arguments: ["sleep", "30"])
    assert launch.fault(2, timeout=0.2) == "sleep did not finish in 0.2 s"


@pytest.mark.parametrize("code", [0, 2, 75])
def test_exit_code_comes_back(code):
    assert launch.mpirun(2, [sys.executable, "-c", f"raise SystemExit({code})"]) == code


def test_mpirun_says_nothing_of_exit_codes_that_parsim_tells_of(capfdbinary, monkeypatch, program):
    monkeypatch.setattr("sys.stderr", open(2, "w", closefd=False))
    assert launch.mpirun(2, [sys.executable, "-c", "import sys; print('mine', file=sys.stderr); sys.exit(75)"]) == 75
    assert capfdbinary.readouterr().err.split() in ([b"mine"], [b"mine", b"mine"])
    assert launch.mpirun(1, [sys.executable, "-c", "import os; os.kill(os.getpid(), 9)"]) not in (0, 75)
    assert b"signal 9" in capfdbinary.readouterr().err, "a killed rank is told"


def test_usr1_reaches_the_ranks(program):
    ranks = program(
        "import signal, sys, time\n"
        "signal.signal(signal.SIGUSR1, lambda *_: sys.exit(75))\n"
        "print('ready', flush=True)\n"
        "time.sleep(30)\n"
    )
    line = (
        f"import sys; from parsim.launch import mpirun as launch; launch._STARTING = 0.5; "
        f"sys.exit(launch.mpirun(2, [sys.executable, {str(ranks)!r}]))"
    )
    with subprocess.Popen([sys.executable, "-c", line], stdout=subprocess.PIPE, text=True) as job:
        assert [job.stdout.readline() for _ in range(2)] == ["ready\n", "ready\n"]
        job.send_signal(signal.SIGUSR1)
        assert job.wait(20) == 75


SSH = """#!/bin/sh
# a connection to another machine, where nothing of this environment is known
while [ "${1#-}" != "$1" ]; do shift; done
shift
exec env -i HOME="$HOME" PATH=/usr/bin:/bin sh -c "$*"
"""


def test_ranks_on_other_machines_know_the_settings(program, monkeypatch):
    if launch._open_mpi(launch.launcher()) < 5:
        pytest.skip("only Open MPI 5 takes this stand-in for ssh")
    agent = program(SSH, "ssh")
    agent.chmod(0o755)
    for name, text in (("NUMBA_NUM_THREADS", "3"), ("PARSIM_KERNEL", "host"), ("SOMETHING", "else")):
        monkeypatch.setenv(name, text)
    names = "NUMBA_NUM_THREADS", "PARSIM_KERNEL", "SOMETHING"
    show = program(f"import os; print(*map(os.environ.get, {names}))")
    monkeypatch.setenv("PRTE_MCA_plm", "ssh")
    monkeypatch.setenv("PRTE_MCA_plm_ssh_agent", str(agent))
    first, *rest = launch.command(2, [sys.executable, show])
    line = [first, "--host", "there:1,beyond:1", *rest]
    with subprocess.Popen(line, env=launch.environment(), stdout=subprocess.PIPE, text=True) as job:
        assert [job.stdout.readline() for _ in range(2)] == ["3 host None\n"] * 2
        job.kill()  # two daemons on one machine, which they never are, now and then do not find an end


def test_mpirun_does_not_hear_what_a_scheduler_sends_to_all(program):
    ranks = program(
        "import os, signal, sys, time\n"
        "from parsim.launch import stop\n"
        "stop.listen()\n"
        "signal.signal(signal.SIGUSR1, lambda *_: sys.exit(75))\n"
        "print(os.getppid(), flush=True)\n"
        "time.sleep(30)\n"
    )
    line = (
        f"import sys; from parsim.launch import mpirun as launch; launch._STARTING = 0.5; "
        f"sys.exit(launch.mpirun(1, [sys.executable, {str(ranks)!r}]))"
    )
    with subprocess.Popen([sys.executable, "-c", line], stdout=subprocess.PIPE, text=True) as job:
        os.kill(int(job.stdout.readline()), signal.SIGTERM)
        with pytest.raises(subprocess.TimeoutExpired):
            job.wait(2)
        job.send_signal(signal.SIGTERM)
        assert job.wait(20) == 75


def test_signals_that_nohup_ignores_stay_ignored():
    heard, before = [], signal.signal(signal.SIGHUP, signal.SIG_DFL)  # the tests may have been started with nohup
    try:
        with launch.heeding(lambda number, _: heard.append(number)):
            os.kill(os.getpid(), signal.SIGHUP)
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        with launch.heeding(lambda number, _: heard.append(number)):
            os.kill(os.getpid(), signal.SIGHUP)
            os.kill(os.getpid(), signal.SIGTERM)
    finally:
        signal.signal(signal.SIGHUP, before)
    assert heard == [signal.SIGHUP, signal.SIGTERM]


def test_the_terminal_that_open_mpi_gives_its_ranks_is_not_taken_for_one(mpirun, program):
    ran = mpirun(2, program("from parsim.launch import mpirun as launch; print('columns', launch.terminal())"))
    assert ran.stdout.split() == ["columns", "0"] * 2, ran.stderr


def test_what_is_in_a_log_stays_there(program, tmp_path):
    log = tmp_path / "log"
    log.write_text("earlier\n")
    with open(log, "a") as file:
        asks = program("from parsim.launch import mpirun as launch; print(launch.terminal())")
        line = launch.command(2, [sys.executable, asks])
        subprocess.run(line, env=launch.environment(), stdout=file, stdin=subprocess.DEVNULL, check=True)
    assert log.read_text().replace("\0", "").split() == ["earlier", "0", "0"]


def test_a_hanging_job_is_ended(mpirun, program):
    script = program("import time; print('hangs', flush=True); time.sleep(60)")
    began = time.monotonic()
    with pytest.raises(pytest.fail.Exception, match="did not end in 3 s"):
        mpirun(2, script, timeout=3)
    assert time.monotonic() - began < 15
    time.sleep(0.5)
    alive = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True).stdout
    assert str(script) not in alive


FAILS = """
import sys
from parsim.launch.exits import code_of
from parsim.domain.comm import Comm
from parsim.errors import InputError

def work():
    comm = Comm()
    if comm.rank == 1:
        raise {error}("one rank fails")
    comm.max([1.0])

sys.exit(code_of(work))
"""


@pytest.mark.parametrize(("error", "code"), [("ValueError", 1), ("InputError", 2)])
def test_one_failing_rank_ends_the_job(error, code, mpirun, program):
    ran = mpirun(2, program(FAILS.format(error=error)), timeout=30)
    assert ran.returncode == code, ran.stderr
    assert error == "InputError" or "one rank fails" in ran.stderr


@pytest.mark.long
def test_doctor_finds_this_machine_fit_and_says_what_is_wrong(monkeypatch, capsys):
    assert doctor.examine_machine() == 0
    assert "can run here" in capsys.readouterr().out
    bad = doctor.Finding("MPI library", "none", "no [library]", "install it")
    monkeypatch.setattr(doctor, "CHECKS", (lambda: bad,))
    assert doctor.examine_machine() == 1
    shown = capsys.readouterr().out
    assert "no [library]" in shown and "install it" in shown


def test_doctor_forgives_what_a_run_does_not_need(monkeypatch, capsys):
    monkeypatch.setattr(
        doctor, "CHECKS", (lambda: doctor.Finding("Pictures", "", "no OpenGL", "get it", needed=False),)
    )
    assert doctor.examine_machine() == 0
    assert "no OpenGL" in capsys.readouterr().out


def test_doctor_tells_of_threads_that_are_no_number(monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", "many")
    found = doctor._cores()
    assert found.wrong == "NUMBA_NUM_THREADS = 'many' is no number" and not found.needed
