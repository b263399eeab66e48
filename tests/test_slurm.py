"""The job script under a real Slurm, and that for PBS with stand-ins for its commands."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
import slurm

import parsim
from jobs import CASE, time_of
from parsim.__main__ import main
from parsim.machine import variant
from parsim.output import checkpoint

ROOT = Path(__file__).parents[1]
PATIENCE = 600.0


@pytest.fixture
def checkout(tmp_path):
    """A checkout whose environment is that of this process, and a case that outlasts one stretch."""
    root = tmp_path / "checkout"
    shutil.copytree(ROOT / "jobs", root / "jobs")
    (root / ".venv" / "bin").mkdir(parents=True)
    python = root / ".venv" / "bin" / "python"
    python.write_text(f'#!/bin/sh\nexport PYTHONPATH="{ROOT}"\nexec "{sys.executable}" "$@"\n')
    python.chmod(0o755)
    shutil.copy(CASE, root / "survive.toml")
    (root / "long.toml").write_text('extends = "survive.toml"\n[run]\nuntil = 0.8\n[output]\nframes = 0.1\n')
    (root / "table.csv").write_text("water.viscosity,run.until\n1e-6,0.02\n2e-6,0.03\n")
    return root


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A running Slurm."""
    if reason := slurm.missing():
        pytest.skip(reason)
    running = slurm.Slurm(tmp_path_factory.mktemp("slurm"))
    yield running
    running.close()


def submit(cluster, checkout, *words):
    """Submit jobs/slurm.sh; returns the number of the job."""
    variant.apply()  # names the kernel cache of this process, which spares the job a compilation
    options = [f"--chdir={checkout}", "--parsable", "--output=job.log"]
    environment = cluster.environment | {"NUMBA_CACHE_DIR": os.environ["NUMBA_CACHE_DIR"]}
    ran = subprocess.run(
        ["sbatch", *options, *map(str, words)], cwd=checkout, env=environment, capture_output=True, text=True
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.strip()


def ended(cluster, job):
    """Wait for the end of a job: (state, restarts, exit code)."""
    begin = time.monotonic()
    while (state := cluster.state(job))[0] in ("PENDING", "CONFIGURING", "RUNNING", "COMPLETING", "REQUEUED"):
        assert time.monotonic() - begin < PATIENCE, state
        time.sleep(0.5)
    return state


def check_pieces(checkout, restarts, reasons, whole, capsys):
    """The pieces of a requeued run are one run."""
    log = (checkout / "job.log").read_text()
    print(log)
    assert restarts >= 1 and "back into the queue" in log
    assert "parsim resume out --case long.toml -n 2 --walltime" in log and "done: t = " in log
    pieces = parsim.open(checkout / "out").info["pieces"]
    assert len(pieces) == restarts + 1 and {piece["ended"] for piece in pieces[:-1]} <= reasons
    assert main(["run", str(checkout / "long.toml"), "-o", str(whole), "-n", "2"]) == 0
    assert main(["compare", str(whole), str(checkout / "out")]) == 0, capsys.readouterr().out


def submitted(cluster, checkout, until, *words):
    """Submit a job on two nodes and wait until its run is at time `until` (s)."""
    job = submit(cluster, checkout, "-N", "2", "-n", "2", "-t", "5", *words, "jobs/slurm.sh", "long.toml", "out")
    wait(lambda: time_of(checkout / "out") > until)
    return job


def wait(happened):
    begin = time.monotonic()
    while not happened():
        assert time.monotonic() - begin < PATIENCE
        time.sleep(0.05)


@pytest.mark.long
def test_a_job_goes_through_a_signal_and_a_lost_node_to_the_end(cluster, checkout, tmp_path, capsys):
    case = checkout / "long.toml"
    case.write_text(case.read_text() + "checkpoints = 0.005\n")
    job = submitted(cluster, checkout, 0.2)
    cluster.run("scancel", "--batch", "--signal=USR1", job)  # as Slurm itself does before the walltime
    wait(lambda: time_of(checkout / "out") > 0.4)
    cluster.lose(slurm.NODES[1])
    state, restarts, code = ended(cluster, job)
    assert (state, code) == ("COMPLETED", "0:0"), (checkout / "job.log").read_text()
    assert restarts == 2 and "killed, or lost with a node" in (checkout / "job.log").read_text()
    check_pieces(checkout, restarts, {"SIGUSR1", "killed"}, tmp_path / "whole", capsys)


def test_a_cancelled_job_leaves_a_checkpoint_and_stays_cancelled(cluster, checkout):
    job = submitted(cluster, checkout, 0.1)
    cluster.run("scancel", job)
    assert ended(cluster, job)[:2] == ("CANCELLED", 0)
    run = parsim.open(checkout / "out")
    assert run.info["status"] == "stopped" and run.info["reason"] in ("SIGTERM", "SIGUSR1")
    assert checkpoint.newest(run.folder)[0].account["time"] > 0.1


@pytest.mark.slow
def test_a_job_that_gives_way_to_another_goes_on_from_there(cluster, checkout):
    job = submitted(cluster, checkout, 0.1)
    cluster.run("scontrol", "requeue", job)  # as preemption does
    wait(lambda: cluster.state(job)[1] == 1 and time_of(checkout / "out") > 0.3)
    cluster.run("scancel", job)
    ended(cluster, job)
    pieces = parsim.open(checkout / "out").info["pieces"]
    assert {piece["ended"] for piece in pieces} <= {"SIGTERM", "SIGUSR1"} and pieces[1]["from_step"] > 100


@pytest.mark.slow
def test_a_job_goes_through_its_walltime_and_the_queue_to_the_end(cluster, checkout, tmp_path, capsys):
    case = checkout / "long.toml"
    case.write_text(case.read_text().replace("until = 0.8", "until = 10.0").replace("frames = 0.1", "frames = 1.0"))
    job = submit(cluster, checkout, "-n", "2", "-t", "1", "--signal=B:USR1@0", "jobs/slurm.sh", "long.toml", "out")
    state, restarts, code = ended(cluster, job)
    assert (state, code) == ("COMPLETED", "0:0"), (checkout / "job.log").read_text()
    check_pieces(checkout, restarts, {"walltime"}, tmp_path / "whole", capsys)


def test_a_table_makes_an_array_of_runs(cluster, checkout):
    job = submit(
        cluster,
        checkout,
        "-n",
        "1",
        "-t",
        "5",
        "--array=1-3",
        "--output=job-%a.log",
        "jobs/slurm.sh",
        "survive.toml",
        "out",
        "table.csv",
    )
    states = [ended(cluster, f"{job}_{task}") for task in (1, 2, 3)]
    assert [state[0] for state in states] == ["COMPLETED", "COMPLETED", "FAILED"]
    assert [parsim.open(checkout / f"out-{task}").case["run"]["until"] for task in (1, 2)] == [0.02, 0.03]
    assert "--row = 3: table.csv has 2 rows; allowed: 1 to 2" in (checkout / "job-3.log").read_text()
    assert not (checkout / "out-3").exists()


@pytest.mark.slow
def test_a_second_job_for_a_folder_and_another_case_are_refused_for_good(cluster, checkout):
    job = submit(cluster, checkout, "-n", "1", "-t", "5", "jobs/slurm.sh", "long.toml", "out")
    wait(lambda: time_of(checkout / "out") > 0.02)
    words = ["-n", "1", "-t", "5", "--output=second.log", "jobs/slurm.sh"]
    assert ended(cluster, submit(cluster, checkout, *words, "long.toml", "out"))[::2] == ("FAILED", "2:0")
    assert "another job writes it" in (checkout / "second.log").read_text()
    cluster.run("scancel", job)
    assert ended(cluster, job)[0] == "CANCELLED"
    assert ended(cluster, submit(cluster, checkout, *words, "survive.toml", "out"))[::2] == ("FAILED", "2:0")
    assert "is the run of another case, which differs in output.frames" in (checkout / "second.log").read_text()


@pytest.mark.slow
def test_a_copy_of_the_script_and_an_empty_environment_do(cluster, checkout, tmp_path):
    mine = tmp_path / "mine.sh"
    shutil.copy(ROOT / "jobs" / "slurm.sh", mine)
    words = ["-N", "2", "-n", "2", "-t", "5"]
    elsewhere = submit(cluster, checkout, *words, f"--chdir={tmp_path}", mine, "survive.toml")
    assert ended(cluster, elsewhere)[::2] == ("FAILED", "2:0")
    assert "export PARSIM=/path/to/checkout" in (tmp_path / "job.log").read_text()
    cache = os.environ["NUMBA_CACHE_DIR"]
    words.append(f"--export=PARSIM={checkout},NUMBA_CACHE_DIR={cache},SLURM_CONF={cluster.environment['SLURM_CONF']}")
    (checkout / "short.toml").write_text('extends = "survive.toml"\n[run]\nuntil = 0.01\n')
    state = ended(cluster, submit(cluster, checkout, *words, mine, "short.toml", "out"))
    assert state[0] == "COMPLETED", (checkout / "job.log").read_text()


def test_what_would_not_be_meant_is_refused(cluster, checkout):
    for words, said in ((["--array=1-2"], "an array job needs a table"), (["-N", "2"], "give the number of ranks, -n")):
        job = submit(cluster, checkout, "-t", "5", *words, "jobs/slurm.sh", "survive.toml", "out")
        assert ended(cluster, f"{job}_1" if "--array=1-2" in words else job)[::2] == ("FAILED", "2:0")
        assert said in (checkout / "job.log").read_text()
    assert not (checkout / "out").exists()


def test_a_checkout_without_an_environment_is_told(cluster, checkout):
    shutil.rmtree(checkout / ".venv")
    state, _, code = ended(cluster, submit(cluster, checkout, "jobs/slurm.sh", "long.toml"))
    assert (state, code) == ("FAILED", "2:0")
    assert "run `bash jobs/local.sh` once" in (checkout / "job.log").read_text()


PARSIM = """#!/bin/bash
# notes how parsim was called, leaves a checkpoint and a status, and ends as the test wants
printf '%s\\n' "$*" >>"$CALLS"
mkdir -p out/checkpoints && touch out/case.toml
[[ ${FAKE_CHECKPOINT:-yes} == no ]] || touch "out/checkpoints/checkpoint_$RANDOM.h5"
printf '"status": "%s"\\n' "${FAKE_STATUS:-failed}" >out/run.json
exit "$FAKE_CODE"
"""
QSTAT = """#!/bin/bash
cat <<'TOLD'
Job Id: 7.server
    Job_Name = ice 1
    resources_used.walltime = 00:10:00
    queue = workq
    Resource_List.place = scatter
    Resource_List.select = 2:ncpus=2:mpiprocs=2:host=a-node-with-a-very-long-name-that-b
\treaks=the+line
    Resource_List.walltime = 01:30:00
    Account_Name = rivers
    project = _pbs_project_default
TOLD
"""


@pytest.fixture
def pbs(checkout, tmp_path):
    """`pbs(code, ...)`: jobs/pbs.sh run dry, parsim ending with `code`: exit code, what was called, what was said."""
    programs = tmp_path / "programs"
    programs.mkdir()
    (checkout / ".venv" / "bin" / "python").write_text(PARSIM)
    for name, text in (("qstat", QSTAT), ("qsub", '#!/bin/sh\necho "qsub $*" >>"$CALLS"\n')):
        (programs / name).write_text(text)
        (programs / name).chmod(0o755)
    (tmp_path / "nodes").write_text("one\none\ntwo\ntwo\n")

    def run(code, **variables):
        calls = tmp_path / "calls"
        calls.unlink(missing_ok=True)
        environment = {
            "PATH": f"{programs}:{os.environ['PATH']}",
            "CALLS": str(calls),
            "FAKE_CODE": str(code),
            "PBS_JOBID": "7.server",
            "PBS_NODEFILE": str(tmp_path / "nodes"),
            "PBS_O_WORKDIR": str(checkout),
        }
        ran = subprocess.run(
            ["bash", checkout / "jobs" / "pbs.sh"],
            env=environment | variables,
            cwd="/",
            capture_output=True,
            text=True,
            timeout=60,
        )
        return ran.returncode, calls.read_text().splitlines() if calls.exists() else [], ran.stderr

    return run


def test_pbs_starts_then_goes_on_and_submits_what_is_left(pbs):
    code, calls, said = pbs(75, CASE="long.toml", OUT="out")
    assert code == 75 and "submitting what is left" in said
    assert calls == [
        "-P -m parsim run long.toml -o out -n 4 --walltime 0:4800",
        "qsub -N ice 1 -A rivers -q workq "
        "-l select=2:ncpus=2:mpiprocs=2:host=a-node-with-a-very-long-name-that-breaks=the+line "
        "-l place=scatter -l walltime=01:30:00 -v CASE=long.toml,OUT=out,TABLE=,ROW=,PARSIM=. ./jobs/pbs.sh",
    ]
    code, calls, _ = pbs(0, CASE="long.toml", OUT="out")
    assert code == 0 and calls == ["-P -m parsim resume out --case long.toml -n 4 --walltime 0:4800"]
    assert len(pbs(75, CASE="long.toml", OUT="out", FAKE_CHECKPOINT="no")[1]) == 1
    assert len(pbs(74, CASE="long.toml", OUT="out", FAKE_STATUS="running")[1]) == 1


@pytest.mark.parametrize("code", [1, 2, 74])
def test_pbs_submits_nothing_after_a_failure(pbs, code):
    status = "failed" if code == 1 else "running"  # which may be that of the job that has the folder
    assert pbs(code, CASE="long.toml", OUT="out", FAKE_STATUS=status)[0] == code
    assert len(pbs(code, CASE="long.toml", OUT="out", FAKE_STATUS=status)[1]) == 1


def test_pbs_goes_on_after_a_kill_as_long_as_the_run_comes_further(pbs):
    code, calls, said = pbs(137, CASE="long.toml", OUT="out", FAKE_STATUS="running")
    assert code == 137 and calls[1].startswith("qsub ") and "killed, or lost with a node" in said
    code, calls, said = pbs(137, CASE="long.toml", OUT="out", FAKE_STATUS="running", FAKE_CHECKPOINT="no")
    assert code == 137 and len(calls) == 1 and "no new checkpoint in this stretch" in said


def test_pbs_takes_a_row_of_a_table(pbs):
    _, calls, _ = pbs(0, CASE="long.toml", OUT="other", TABLE="table.csv", PBS_ARRAY_INDEX="2")
    assert calls[0].startswith("-P -m parsim run long.toml -o other-2 --table table.csv --row 2 -n 4 ")
    assert "a table needs an array job" in pbs(0, CASE="long.toml", TABLE="table.csv")[2]
    assert pbs(0)[0] == 2


@pytest.mark.skipif(not shutil.which("shellcheck"), reason="shellcheck is not installed")
def test_shellcheck_finds_nothing():
    scripts = [*(ROOT / "jobs").glob("*.sh"), *(ROOT / "tests").glob("*.sh"), ROOT / ".ci" / "run"]
    ran = subprocess.run(["shellcheck", "-x", *scripts], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout
