"""The command line: what each command hands on, what it prints, and the exit code each ending has."""

import json
import os
import shutil
import subprocess
import sys
import types
from pathlib import Path

import pytest
from example_cases import ROOT, write
from fake_run import make

from parsim import __version__
from parsim.__main__ import main
from parsim.case import estimate, examples
from parsim.case.model import load
from parsim.domain.comm import Comm
from parsim.errors import InputError, WriteError
from parsim.launch import mpirun as launch
from parsim.run import warm
from parsim.solid.shapes import CylinderShape, DiscShape, PolygonShape, PrismShape

BLOCKS = ROOT / "cases" / "ice_release" / "4_blocks_dry.toml"
LAUNCHED = ("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK")


@pytest.fixture
def solver(monkeypatch):
    """A solver that notes what it is asked for and ends as `solver.ending` says."""
    fake = types.ModuleType("parsim.run.loop")
    fake.calls, fake.ending = [], 0

    def run(case, source, out, force, walltime):
        fake.calls.append((case, source, out, force, walltime))
        if isinstance(fake.ending, BaseException):
            raise fake.ending
        return fake.ending

    fake.run = run
    monkeypatch.setitem(sys.modules, "parsim.run.loop", fake)
    monkeypatch.setattr(warm, "prepare", lambda: None)  # it needs no kernels
    return fake


def test_run_hands_the_complete_case_to_the_solver(solver, tmp_path):
    case = write(tmp_path)["3d"]
    words = ["run", str(case), "-o", "out", "--until", "0.25", "--set", "bodies.A1.density=900", "--set", "run.until=9"]
    assert main([*words, "--force", "--walltime", "1:00:05"]) == 0
    ((given, source, out, force, walltime),) = solver.calls
    assert given == load(case, ["bodies.A1.density=900", "run.until=0.25"])
    assert source == case and str(out) == "out" and force is True and walltime == 3605.0


@pytest.mark.parametrize(
    ("ending", "code", "said"),
    [
        (0, 0, ""),
        (None, 0, ""),
        (75, 75, ""),
        (InputError(["OUT: exists", "second"]), 2, "error: OUT: exists\nerror: second\n"),
        (WriteError("out/x", "no space"), 74, "error: cannot write out/x: no space\n"),
        (KeyboardInterrupt(), 130, ""),
    ],
    ids=str,
)
def test_endings_of_a_run(solver, capsys, ending, code, said):
    solver.ending = ending
    assert main(["run", str(BLOCKS), "-o", "out"]) == code
    assert capsys.readouterr().err == said


def test_a_fault_of_the_program_shows_rank_and_traceback(solver, capsys, monkeypatch):
    for key, value in zip(LAUNCHED, "21", strict=True):
        monkeypatch.setenv(key, value)
    solver.ending = ZeroDivisionError("lost")
    assert main(["run", str(BLOCKS), "-o", "out"]) == 1
    said = capsys.readouterr().err
    assert "rank 1 of 2 failed" in said and "Traceback" in said and "ZeroDivisionError: lost" in said


@pytest.mark.parametrize(("rank", "said"), [("0", True), ("1", False)])
def test_one_rank_tells_of_bad_input_and_all_end_alike(capsys, monkeypatch, rank, said):
    for key, value in zip(LAUNCHED, ("2", rank), strict=True):
        monkeypatch.setenv(key, value)
    assert main(["check", "nowhere.toml"]) == 2
    assert ("nowhere.toml: no such file" in capsys.readouterr().err) is said


def test_n_starts_ranks_with_the_same_words(solver, monkeypatch):
    started = []
    monkeypatch.setattr(launch, "mpirun", lambda ranks, arguments, stopped: started.append((ranks, arguments)) or 3)
    words = ["run", str(BLOCKS), "-o", "a b", "--set", "spacing=0.01", "--set", "title=x = y", "--until", "1e-1"]
    assert main([*words, "--force", "-n", "2"]) == 3
    ((ranks, arguments),) = started
    assert ranks == 2 and arguments[:4] == [sys.executable, "-P", "-m", "parsim"] and not solver.calls
    assert main(arguments[4:]) == 0
    case = load(BLOCKS, ["spacing=0.01", "title=x = y", "run.until=0.1"])
    assert solver.calls == [(case, BLOCKS, Path("a b"), True, None)]


def test_n_checks_the_case_first_and_is_refused_inside_a_job(capsys, monkeypatch):
    monkeypatch.setattr(launch, "mpirun", lambda *_: pytest.fail("started"))
    assert main(["run", str(BLOCKS), "-o", "out", "-n", "2", "--set", "spacing=0.007"]) == 2
    assert main(["run", str(BLOCKS), "-o", "out", "-n", "1000"]) == 2
    assert "1000 ranks: the box has" in capsys.readouterr().err
    for key, value in zip(LAUNCHED, "20", strict=True):
        monkeypatch.setenv(key, value)
    assert main(["run", str(BLOCKS), "-o", "out", "-n", "2"]) == 2
    assert "2 processes of this command are running already" in capsys.readouterr().err


def test_threads_are_set_before_numba_is_loaded(solver, monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", "1")
    main(["run", str(BLOCKS), "-o", "out", "--threads", "3"])
    assert os.environ["NUMBA_NUM_THREADS"] == "3"


@pytest.mark.parametrize(
    "words",
    [["chek"], ["check"], ["run", "case.toml"], ["run", "case.toml", "-o", "out", "-n", "0"], ["check", "x", "--bad"],
     ["run", "case.toml", "-o", "out", "--until", "soon"], ["compare", "one"]],
    ids=" ".join,
)  # fmt: skip
def test_misused_commands_end_with_2(capsys, words):
    assert main(words) == 2
    assert "Error" in capsys.readouterr().err


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"parsim {__version__}\n"


def test_check_prints_the_estimate_and_warnings(capsys):
    assert main(["check", str(BLOCKS), "-n", "4", "--set", "spacing=0.01"]) == 0
    said = capsys.readouterr().out
    for word in ("a valid case", "water", "4,0", "of 0.000375 s, from -0.3 to 1.2 s", "on each of 4 ranks", "500,000"):
        assert word in said
    assert said.endswith(
        "warning: bodies.A1 and 3 more: 2 particles across the thinnest side, 0.0195 m; "
        "four or more give usable loads\n"
    )


@pytest.mark.parametrize("name", ["ice_release/4_blocks_dry", "ice_release/9_blocks_50mm", "floating_square/half"])
def test_estimate_counts_what_is_built(name):
    from parsim.boundary.wall_samples import Walls
    from parsim.coupling.samples import BodySamples
    from parsim.fluid.wcmps.scheme import WCMPS
    from parsim.run.fill import water
    from parsim.solid.bodies import from_case

    case = load(ROOT / "cases" / f"{name}.toml")
    cost, bodies = estimate.estimate(case), from_case(case)
    assert cost.wall == len(Walls(case, 4))
    assert cost.body == len(BodySamples(case, bodies, 4, None))
    assert cost.water == pytest.approx(len(water(case, bodies, WCMPS(case), Comm())), rel=0.03)


@pytest.mark.parametrize(
    ("count", "said"), [(1e3, "1 second "), (2.1e7, "42 seconds "), (1e9, "33 minutes "), (1e10, "5.6 hours ")]
)
def test_check_tells_time_in_a_unit_that_shows_it(monkeypatch, tmp_path, count, said):
    cost = estimate.Estimate(
        water=10**6, wall=0, body=0, gate=0, active=1000, bytes=0.0, steps=int(count / 1000), time_step=1.0
    )
    monkeypatch.setattr(estimate, "estimate", lambda case: cost)
    time = estimate.lines(load(write(tmp_path)["2d"]), 1)[3]
    assert time.startswith(f"time       {said}")


def test_check_tells_what_the_disk_will_hold(tmp_path):
    case = load(write(tmp_path)["2d"], ["output.frames=0.1", "output.series=0.01", "output.milestones=0.5"])
    frames, rows, checkpoints = estimate.disk(case, estimate.estimate(case).water)
    assert frames == 12 * (90 * 1950 + 2000) and rows == pytest.approx(100 * 1500) and checkpoints % 1950 == 0
    assert "disk       3.4 MB: 2.1 MB of frames, 150.0 kB of series, " in "\n".join(estimate.lines(case, 1))


def test_estimate_of_a_small_tank_by_hand(tmp_path):
    cost = estimate.estimate(load(write(tmp_path)["2d"]))
    # 50 x 40 of water less half of 10 x 10, 50 x 60 inside, four layers on three sides
    assert (cost.water, cost.body, cost.wall, cost.gate) == (1950, 96, 58 * 64 - 50 * 60, 0)
    assert cost.steps == -(-1.0 // (0.01 / (11 * 2 * (9.81 * 0.4) ** 0.5)))


def test_estimate_needs_no_room_for_what_it_counts():
    cost = estimate.estimate(load(BLOCKS, ["spacing=1e-6"]))
    assert cost.water > 1e15 and cost.body > 1e11


@pytest.mark.parametrize("shape", [
    PrismShape(kind="prism", points=[(0.0, 0.0), (0.3, 0.0), (0.0, 0.2)], height=0.15),
    CylinderShape(kind="cylinder", diameter=0.3, height=0.2),
    PolygonShape(kind="polygon", points=[(0.0, 0.0), (0.3, 0.0), (0.3, 0.2), (0.0, 0.2)]),
    DiscShape(kind="disc", diameter=0.3),
], ids=lambda shape: shape.kind)  # fmt: skip
def test_a_vast_body_is_counted_by_its_surface(shape, monkeypatch):
    for depth in (0.01, 1.0):
        exact = shape.number_of_samples(0.005, depth, shape.FLAT)
        monkeypatch.setattr("parsim.solid.shapes.shape._MOST", 0)
        assert shape.number_of_samples(0.005, depth, shape.FLAT) == pytest.approx(exact, rel=0.15)
        monkeypatch.undo()
    assert shape.number_of_samples(1e-8, 3e-8, shape.FLAT) > (1e7 if shape.FLAT else 1e14)


def test_new_writes_a_case_that_passes_check_and_never_overwrites(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "river"]) == 0
    assert main(["check", "river.toml"]) == 0
    (tmp_path / "river.toml").write_text("mine")
    assert main(["new", "river.toml"]) == 2
    assert "river.toml exists already" in capsys.readouterr().err
    assert (tmp_path / "river.toml").read_text() == "mine"
    assert main(["new", "no/such/river"]) == 74
    assert [main(["new", name]) for name in ("", ".toml", "no/", "..")] == [2] * 4
    assert "NAME = 'no/': is no name of a file" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["river.toml"]


@pytest.mark.long
def test_an_example_is_found_by_name_anywhere_and_can_be_had_as_one_file(tmp_path, capsys, monkeypatch):
    """From an installed package, where no checkout is around."""
    shutil.copytree(ROOT / "cases", tmp_path / "site" / "parsim" / "cases")
    monkeypatch.setattr(examples, "__file__", str(tmp_path / "site" / "parsim" / "case" / "examples.py"))
    monkeypatch.chdir(tmp_path)
    assert main(["new", "--list"]) == 0
    assert "ice_release/4_blocks_dry     Ice release, case 1: four blocks, a dry bed\n" in capsys.readouterr().out
    names = {f"{path.parent.name}/{path.stem}" for path in (ROOT / "cases").rglob("*.toml") if path.stem[0] != "_"}
    assert set(examples.paths()) == names
    for name in names:
        assert main(["check", name]) == 0
        assert main(["new", "mine", "--from", name]) == 0
        assert load(tmp_path / "mine.toml") == load(ROOT / "cases" / f"{name}.toml")
        (tmp_path / "mine.toml").unlink()


def test_a_run_of_an_example_takes_its_reference_along(solver, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "ice_release/4_blocks_dry", "-o", "out"]) == 0
    assert solver.calls[0][1].with_name("reference.csv").read_text() == BLOCKS.with_name("reference.csv").read_text()
    (tmp_path / "ice_release").mkdir()
    (tmp_path / "ice_release" / "4_blocks_dry").write_text((ROOT / "parsim" / "commands" / "starter.toml").read_text())
    assert main(["run", "ice_release/4_blocks_dry", "-o", "out"]) == 0
    assert solver.calls[1][1] == Path("ice_release/4_blocks_dry"), "a file comes before an example"


@pytest.mark.parametrize("words, said", [
    (["check", "ice_release/4_block_dry"], "no such file; did you mean ice_release/4_blocks_dry?"),
    (["check", "4_blocks_dry"], "no such file; did you mean ice_release/4_blocks_dry?"),
    (["check", "river"], "error: river: no such file\n"),
    (["new", "mine", "--from", "9_blocks_dri"], "; did you mean ice_release/9_blocks_dry?"),
    (["new", "mine", "--from", "river"], "--from river: no such example; allowed: arching/opening_01, "),
    (["new"], "NAME: missing"),
])  # fmt: skip
def test_an_unknown_example_is_told_with_the_nearest(words, said, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_shell_completes_commands():
    asked = {"_PARSIM_COMPLETE": "complete_bash", "COMP_WORDS": "parsim re", "COMP_CWORD": "1"}
    told = subprocess.run([sys.executable, "-m", "parsim"], env=os.environ | asked, capture_output=True, text=True)
    assert told.stdout.split() == ["resume", "report"], told.stderr


def test_a_new_case_names_the_schema_that_the_readme_has_made(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    main(["new", "mine"])
    first = (tmp_path / "mine.toml").read_text().split("\n", 1)[0]
    assert first.startswith("#:schema ./")
    assert f"parsim schema > {first.removeprefix('#:schema ./')}\n" in (ROOT / "README.md").read_text()


def test_schema_is_json(capsys):
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out)["properties"]["spacing"]["description"].startswith(
        "particle spacing l0, m; must divide the box"
    )


def test_info_tells_of_a_run(tmp_path, capsys):
    make(tmp_path / "out")
    assert main(["info", str(tmp_path / "out")]) == 0
    said = capsys.readouterr().out
    for word in ("status", "frames", "energy", "fluid"):
        assert word in said
    assert main(["info", str(tmp_path)]) == 2


FAILING = """
import sys, types
from mpi4py import MPI
from parsim.run import warm
from parsim.__main__ import main
from parsim.errors import InputError, WriteError

def run(case, source, out, force, walltime):
    endings = {"fault": ValueError("lost"), "write": WriteError("out", "full"), "together": InputError("no")}
    if MPI.COMM_WORLD.rank == 1 or sys.argv[1] == "together":
        raise endings[sys.argv[1]]
    MPI.COMM_WORLD.recv(source=1)

sys.modules["parsim.run.loop"] = types.SimpleNamespace(run=run)
warm.prepare = lambda: None
sys.exit(main(["run", sys.argv[2], "-o", "out"]))
"""


@pytest.mark.parametrize(("kind", "code", "said"), [("fault", 1, "lost"), ("write", 74, "full"), ("together", 2, "no")])
def test_one_failing_rank_ends_the_job(mpirun, tmp_path, kind, code, said):
    program = tmp_path / "failing.py"
    program.write_text(FAILING)
    ended = mpirun(2, [program, kind, BLOCKS], timeout=60)
    assert ended.returncode == code
    assert said in ended.stderr
