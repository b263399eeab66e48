"""`parsim study`: runs that are made, gone on with, counted and gathered; most of them made up."""

import os
import shutil
import signal
import subprocess
import time

import numpy as np
import pytest
from example_cases import ROOT
from study_cases import BELOW, NUMBER, SEARCH, SEEDS, Machine, folder, write

import parsim
from parsim.__main__ import main
from parsim.case.load import load
from parsim.launch import stop
from parsim.study import side, slurm
from parsim.study.statistics import wilson

GRID = 'grid = {"bodies.sphere.position.2" = [0.2, 0.25, 0.3, 0.35, 0.4]}\n'


def x_of(case):
    return case.bodies[0].position[0]


def z_of(case):
    return case.bodies[0].position[2]


def seed_of(case):
    """Number of the run in the seeds of SEEDS."""
    return round((x_of(case) - 0.2) / 0.001) + 1


def test_seeds_become_a_probability(study, monkeypatch, capsys):
    machine = Machine(monkeypatch, lambda case, number: 0.25 if number in (2, 5) else 0.35)
    assert study(BELOW + SEEDS % ", most = 10", "--jobs", "3", "-n", "2") == 0
    assert machine.numbers == list(range(1, 11)) and machine.most == 3
    first = machine.calls[0]
    assert first[0] == "run" and first[-2:] == ["-n", "2"] and first[3].endswith("/out/run-1")
    (row,) = study.told()["rows"]
    assert (row["yes"], row["outcomes"]) == (2, 10)
    assert row["probability"] == wilson(2, 10)._asdict()
    assert [line["outcome"] for line in study.rows()] == ["no", "yes", "no", "no", "yes", *["no"] * 5]
    assert [line["bodies.sphere.position.0"] for line in study.rows()][:2] == ["0.2", "0.201"]
    said = capsys.readouterr().out
    assert "yes in 2 of 10, p = 0.2 (0.05668 to 0.5098)" in said and "10 runs: 10 done" in said


def test_the_stop_rule_ends_it_and_more_may_be_asked_for_later(study, monkeypatch):
    machine = Machine(monkeypatch, lambda case, number: 0.5)
    assert study(BELOW + SEEDS % ", most = 30, least = 4, within = 0.2") == 0
    assert machine.numbers == [1, 2, 3, 4, 5, 6] and study.told()["complete"]
    assert study(BELOW + SEEDS % ", most = 30, least = 4, within = 0.15") == 0
    assert machine.numbers == list(range(1, 10))
    assert study(BELOW + SEEDS % ", most = 30, least = 4, within = 0.15", "--jobs", "4") == 0
    assert len(machine.calls) == 9 and {words[0] for words in machine.calls} == {"run"}


def test_numbers_become_a_mean_and_quantiles(study, monkeypatch, capsys):
    Machine(monkeypatch, lambda case, number: number / 100.0)
    assert study(NUMBER + SEEDS % ", most = 20" + "quantiles = [0.5]\n") == 0
    (row,) = study.told()["rows"]
    assert row["mean"]["value"] == pytest.approx(0.105) and row["quantiles"][0]["value"] == pytest.approx(0.105)
    half = 1.96 * np.std(np.arange(1, 21) / 100.0) / np.sqrt(20.0)
    assert row["mean"]["high"] - row["mean"]["low"] == pytest.approx(2.0 * half, rel=0.1)
    assert "mean 0.105 (0.0" in capsys.readouterr().out


def test_a_grid_has_a_probability_in_each_row_and_a_curve_over_all(study, monkeypatch):
    Machine(monkeypatch, lambda case, number: z_of(case) + (0.04, -0.04, 0.11, -0.11)[seed_of(case) - 1])
    assert study(BELOW + SEEDS % ", most = 4" + GRID + 'fit = "logistic"\n') == 0
    told = study.told()
    assert [row["yes"] for row in told["rows"]] == [3, 3, 2, 1, 1]
    assert told["curve"]["middle"] == pytest.approx(0.3) and told["curve"]["slope"] < 0.0
    page = (study.out / "index.html").read_text()
    assert page.count("<tr>") == 2 + 5 + 20 and "logistic: p = 1/2 at bodies.sphere.position.2 = 0.3" in page


def test_a_search_finds_its_edge_and_refines_it_later(study, monkeypatch, capsys):
    machine = Machine(monkeypatch, lambda case, number: z_of(case))
    assert study(BELOW + SEARCH % "") == 0
    (row,) = study.told()["rows"]
    assert row["edge"] == {"no": 0.3, "yes": 0.2875, "low": 0.2875, "high": 0.3, "monotone": True, "note": ""}
    made = len(machine.calls)
    assert study(BELOW + (SEARCH % "").replace("0.02", "0.002")) == 0
    assert study.told()["rows"][0]["edge"]["low"] == pytest.approx(0.2984375)
    assert made < len(machine.calls) <= made + 5
    assert "no at 0.3, yes at 0.2875; a value beside it is as expected" in capsys.readouterr().out


def test_a_search_without_an_edge_ends_with_1(study, monkeypatch, capsys):
    Machine(monkeypatch, lambda case, number: 0.9)
    assert study(BELOW + SEARCH % "") == 1
    assert "no edge: bodies.sphere.position.2 = 0.1 has the outcome no" in capsys.readouterr().out
    page = (study.out / "index.html").read_text()
    assert "no edge" in page and page.count("0.5<") == 1, "only among the runs"


def test_a_signal_stops_all_runs_and_the_study(study, monkeypatch):
    def law(case, number):
        if number == 3:
            os.kill(os.getpid(), signal.SIGTERM)
        return 0.5

    machine = Machine(monkeypatch, law, slower=3)
    assert study(BELOW + SEEDS % ", most = 9", "--jobs", "2") == stop.STOPPED
    assert machine.numbers == [1, 2, 3, 4] and machine.running == 0
    assert study.told()["runs"] | {"waiting": 0} == dict.fromkeys(study.told()["runs"], 0) | {"done": 3, "stopped": 1}
    machine.law = lambda case, number: 0.5
    assert study(BELOW + SEEDS % ", most = 9") == 0 and machine.numbers[4:] == [4, 5, 6, 7, 8, 9]


@pytest.mark.parametrize(("apart", "second"), [(-1.0, signal.SIGTERM), (60.0, signal.SIGUSR1)])
def test_a_second_signal_ends_runs_at_once(apart, second, study, monkeypatch):
    def law(case, number):
        if number == 1:
            os.kill(os.getpid(), signal.SIGINT)
            os.kill(os.getpid(), signal.SIGINT)
        return 0.5

    machine = Machine(monkeypatch, law, slower=5)
    monkeypatch.setattr(side, "SAME_SIGNAL", apart)
    assert study(BELOW + SEEDS % ", most = 9", "--jobs", "2") == stop.STOPPED
    assert machine.processes[1].signalled == [signal.SIGUSR1, second]


def test_a_later_end_goes_on_with_runs_that_were_done(study, monkeypatch, tmp_path):
    machine = Machine(monkeypatch, lambda case, number: case.run.until)
    assert study(NUMBER + SEEDS % ", most = 2") == 0
    path = write(tmp_path, NUMBER + SEEDS % ", most = 2")
    path.write_text(path.read_text().replace("until = 0.02", "until = 0.03"))
    assert main(["study", str(path), "-o", str(study.out)]) == 0
    assert [words[0] for words in machine.calls] == ["run", "run", "resume", "resume"]
    assert study.told()["rows"][0]["mean"]["value"] == 0.03


def test_the_runs_of_another_case_are_refused(study, monkeypatch, tmp_path, capsys):
    Machine(monkeypatch, lambda case, number: 0.5)
    assert study(NUMBER + SEEDS % ", most = 2") == 0
    path = write(tmp_path, NUMBER + SEEDS % ", most = 2")
    path.write_text(path.read_text().replace("density = 1000.0", "density = 900.0"))
    for word in ("--gather", "--retry"):
        assert main(["study", str(path), "-o", str(study.out), word]) == 2
        assert "run-1: is the run of another case, which differs in bodies; give" in capsys.readouterr().err


def test_gathering_tells_of_what_is_there_and_makes_nothing(study, monkeypatch, capsys):
    text = BELOW + SEEDS % ", most = 4"
    assert study(text, "--gather") == 2 and "holds no runs.csv" in capsys.readouterr().err and not study.out.exists()
    machine = Machine(monkeypatch, lambda case, number: 0.2)
    assert study(BELOW + SEEDS % ", most = 2") == 0
    assert study(text, "--gather") == 0
    assert "4 runs: 2 done, 2 waiting; more are wanted" in capsys.readouterr().out and len(machine.calls) == 2


def test_a_run_that_another_job_makes_is_left_to_it(study, monkeypatch, tmp_path):
    text = BELOW + SEEDS % ", most = 3"
    machine = Machine(monkeypatch, lambda case, number: 0.2)
    assert study(BELOW + SEEDS % ", most = 2") == 0
    case = load(write(tmp_path, text), table=study.out / "runs.csv", row=2)
    folder(study.out / "run-2", case, "kill")
    monkeypatch.setattr("parsim.study.runs.held", lambda path: path.name == "run-2")
    assert study(text) == 0
    assert machine.numbers == [1, 2, 3] and study.told()["runs"]["running"] == 1 and not study.told()["complete"]


@pytest.mark.parametrize(("name", "said"), [("run.json", "is the output folder of one run"), ("a", "not a study's")])
def test_a_folder_of_something_else_is_refused(name, said, study, capsys):
    study.out.mkdir()
    (study.out / name).write_text("{}")
    assert study(BELOW + SEEDS % "") == 2
    assert said in capsys.readouterr().err and [path.name for path in study.out.iterdir()] == [name]


def test_a_folder_that_cannot_be_made_and_a_study_inside_mpirun_are_told(study, monkeypatch, capsys):
    study.out.write_text("")
    assert study(BELOW + SEEDS % "") == 2
    assert main(["study", str(study.out.parent / "fall.toml"), "-o", str(study.out / "x")]) == 74
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "0")
    assert study(BELOW + SEEDS % "") == 2
    assert "2 processes of this command are running; start one" in capsys.readouterr().err


def test_the_walltime_is_handed_on(study, monkeypatch):
    machine = Machine(monkeypatch, lambda case, number: 0.5)
    monkeypatch.setattr(side.stop, "age", lambda: 30.0)
    assert study(BELOW + SEEDS % ", most = 1", "--walltime", "1:00:00") == 0
    assert machine.calls[0][-2:] == ["--walltime", "59:30"]
    assert study(BELOW + SEEDS % "", "--walltime", "soon") == 2


def test_an_array_of_slurm_makes_the_runs_that_are_wanted(study, monkeypatch, tmp_path, capsys):
    """The script is run as one task of its array, with stand-ins for Slurm's commands and for the checkout's Python."""
    Machine(monkeypatch, lambda case, number: 0.2)
    assert study(BELOW + SEEDS % ", most = 2") == 0
    checkout = tmp_path / "a checkout"
    shutil.copytree(ROOT / "jobs", checkout / "jobs")
    (checkout / ".venv" / "bin").mkdir(parents=True)
    for program, text in (
        (checkout / ".venv" / "bin" / "python", 'printf "%s\\n" "$@"'),
        (tmp_path / "scontrol", "exit 0"),
        (tmp_path / "squeue", "echo 1:50:00"),
    ):
        program.write_text(f"#!/bin/sh\n{text}\n")
        program.chmod(0o755)
    monkeypatch.setenv("PARSIM", str(checkout))
    assert study(BELOW + SEEDS % ", most = 5", "--slurm", "-n", "4", "--walltime", "2:00:00") == 0
    script = study.out / "slurm.sh"
    assert f"wrote {script}: 3 runs; next: sbatch {script}" in capsys.readouterr().out
    options = [line for line in script.read_text().splitlines() if line.startswith("#SBATCH")]
    assert {"#SBATCH --array=3-5", "#SBATCH --ntasks=4", "#SBATCH --time=2:00:00", "#SBATCH --requeue"} <= set(options)
    told = {"SLURM_JOB_ID": "7", "SLURM_ARRAY_TASK_ID": "4", "SLURM_NTASKS": "4"}
    path = f"{tmp_path}:{os.environ['PATH']}"
    ran = subprocess.run(
        ["bash", script], capture_output=True, text=True, cwd=tmp_path, env={**os.environ, **told, "PATH": path}
    )
    case, table = tmp_path / "fall.toml", study.out / "runs.csv"
    given = ["run", case, "-o", study.out / "run-4", "--table", table, "--row", 4, "-n", 4, "--walltime", "1:50:00"]
    assert ran.stdout.splitlines()[-len(given) - 3 :] == ["-P", "-m", "parsim", *map(str, given)], ran.stderr
    assert main(["check", str(case), "--table", str(table)]) == 0  # each row is a run


def test_no_array_is_written_where_none_is_wanted_or_can_be_run(study, monkeypatch, tmp_path, capsys):
    Machine(monkeypatch, lambda case, number: 0.2)
    assert study(BELOW + SEEDS % ", most = 2") == 0
    assert study(BELOW + SEEDS % ", most = 2", "--slurm") == 0 and "no run is wanted" in capsys.readouterr().out
    assert study(BELOW + SEEDS % "", "--slurm", "--gather") == 2
    assert "--gather and --slurm: give one of them" in capsys.readouterr().err
    monkeypatch.setenv("PARSIM", str(tmp_path))
    assert study(BELOW + SEEDS % ", most = 9", "--slurm") == 2
    assert "holds no jobs/slurm.sh; name a checkout of parsim" in capsys.readouterr().err
    assert not (study.out / "slurm.sh").exists() and len((study.out / "runs.csv").read_text().splitlines()) == 3


@pytest.mark.parametrize(("numbers", "said"), [
    ([1], "1"), ([3, 1, 2], "1-3"), ([1, 2, 4, 7, 8, 9], "1-2,4,7-9"), ([5, 3], "3,5"),
])  # fmt: skip
def test_an_array_is_written_as_slurm_reads_it(numbers, said):
    assert slurm._ranges(numbers) == said


def test_real_runs_side_by_side(study, capsys):
    """The sphere falls freely for 0.02 s from 0.22 m up: by g t^2 / 2."""
    grid = 'grid = {"bodies.sphere.position.2" = [0.22, 0.24]}\n'
    assert study(NUMBER + grid, "--jobs", "2") == 0, [path.read_text() for path in study.out.glob("*.log")]
    ends = [row["mean"]["value"] for row in study.told()["rows"]]
    times = [parsim.open(study.out / f"run-{n}").info["time"] for n in (1, 2)]
    assert ends == pytest.approx([z - 0.5 * 9.81 * t**2 for z, t in zip((0.22, 0.24), times, strict=True)], abs=1e-6)
    written = (study.out / "run-1" / "run.json").stat().st_mtime_ns
    assert study(NUMBER + grid, "--jobs", "2") == 0
    assert (study.out / "run-1" / "run.json").stat().st_mtime_ns == written
    assert main(["info", str(study.out / "run-2")]) == 0 and "done" in capsys.readouterr().out


@pytest.mark.long
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, stop.STOPPED), (signal.SIGKILL, -signal.SIGKILL)])
def test_a_study_that_ends_has_its_runs_leave_checkpoints(number, code, study, tmp_path):
    path = write(tmp_path, NUMBER + SEEDS % ", most = 1")
    path.write_text(path.read_text().replace("until = 0.02", "until = 60.0"))
    words = [*side.PARSIM, "study", str(path), "-o", str(study.out)]
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    info, series = study.out / "run-1" / "run.json", study.out / "run-1" / "series" / "bodies.csv"
    begin = time.monotonic()

    def wait(happened):
        while not happened():
            assert process.poll() in (None, code) and time.monotonic() - begin < 300.0
            time.sleep(0.1)

    try:
        wait(lambda: series.is_file() and series.stat().st_size > 200)
        process.send_signal(number)
        assert process.wait(120) == code, process.stderr.read()
        wait(lambda: '"stopped"' in info.read_text())
    finally:
        process.kill()
    assert 0.0 < parsim.open(info.parent).info["time"] < 60.0
    assert main(["study", str(path), "-o", str(study.out), "--gather"]) == 1
    assert study.told()["runs"]["stopped"] == 1
