"""Going on: with which case, from what is left of a folder, and without harm to what is no output."""

import json
import shutil
from pathlib import Path

import pytest

import parsim
from parsim.__main__ import main
from parsim.case.load import load
from parsim.errors import InputError
from parsim.launch import mpirun as launch
from parsim.launch import stop
from parsim.machine import variant
from parsim.output import checkpoint
from parsim.run.resume import find

CASE = Path(__file__).with_name("survive.toml")
WORDS = [str(CASE), "--until", "0.02", "--set", "output.frames=0.005"]


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run in one go."""
    out = tmp_path_factory.mktemp("run") / "out"
    assert main(["run", *WORDS, "-o", str(out), "--set", "output.milestones=0.01"]) == 0
    return out


@pytest.fixture
def out(finished, tmp_path):
    """A copy of it."""
    shutil.copytree(finished, tmp_path / "out")
    return tmp_path / "out"


def again(out, **facts):
    """Have a finished run look like one that was killed."""
    (out / "run.json").write_text(json.dumps({"status": "running", **facts}))


def test_nothing_but_an_output_is_touched(tmp_path, capsys, monkeypatch):
    (tmp_path / "sub").mkdir()
    shutil.copy(CASE, tmp_path / "case.toml")
    (tmp_path / "data.txt").write_text("mine")
    monkeypatch.chdir(tmp_path)
    for words in (["resume", "."], ["run", "case.toml", "-o", ".", "--force"]):
        assert main(words) == 2
        assert "neither run.json nor a checkpoint" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "data.txt", "sub"]


def test_force_and_resume_leave_what_is_not_theirs(out):
    (out / "notes.txt").write_text("mine")
    (out / "checkpoints" / "checkpoint_000009999.h5").mkdir()
    (out / "frames" / "mine").mkdir()
    again(out)
    assert main(["resume", str(out)]) == 0
    assert main(["run", *WORDS, "-o", str(out), "--force"]) == 0
    assert (out / "notes.txt").read_text() == "mine"


def test_what_a_kill_leaves_of_the_first_file_is_in_nobodys_way(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    for name in (".run.json.part", "run.json"):
        (out / name).write_text("{")
    assert main(["run", *WORDS, "-o", str(out), "--until", "0.001"]) == 0
    assert not list(out.rglob(".*.part"))


def test_a_folder_that_cannot_be_looked_into_is_not_taken_for_empty(out, monkeypatch, capsys):
    again(out)
    listdir = checkpoint.os.listdir

    def refused(path):
        if Path(path).name == checkpoint.FOLDER:
            raise PermissionError(13, "Permission denied")
        return listdir(path)

    def refused_size(path):
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(checkpoint.os, "listdir", refused)
    assert main(["resume", str(out)]) == 2
    assert "checkpoints: cannot be read: Permission denied" in capsys.readouterr().err
    monkeypatch.setattr(checkpoint.os, "listdir", listdir)
    monkeypatch.setattr(checkpoint.os.path, "getsize", refused_size)
    assert main(["resume", str(out)]) == 2
    assert "make it readable, or move it away" in capsys.readouterr().err
    monkeypatch.undo()
    assert main(["resume", str(out)]) == 0


def test_a_run_that_is_prolonged_is_not_done_before_its_new_end(out, finished):
    case = (out / "case.toml").read_text()
    (out / "case.toml").write_text(case.replace("until = 0.02", "until = 0.022"))
    assert main(["resume", str(out)]) == 0
    assert parsim.open(out).info["time"] >= 0.022 > parsim.open(finished).info["time"]


@pytest.mark.parametrize("text", ["no JSON", "[]", ""])
def test_a_damaged_status_is_no_hindrance(out, text):
    (out / "run.json").write_text(text)
    assert main(["resume", str(out)]) == 0


def test_a_machine_without_power_leaves_any_end_of_a_table(out, finished, capsys):
    again(out)
    with open(out / "series" / "energy.csv", "ab") as file:
        file.write(bytes(300) + b"\n\xff\xfe\n12345")
    assert main(["resume", str(out)]) == 0
    shutil.copy(finished / "run.json", out)
    assert main(["compare", str(finished), str(out)]) == 0, capsys.readouterr().out


def test_missing_outputs_are_told(out, capsys):
    again(out)
    (out / "series" / "energy.csv").unlink()
    (out / "frames" / "water_000001.vtkhdf").unlink()
    assert main(["resume", str(out)]) == 0
    assert "2 earlier outputs are missing, frames/water_000001.vtkhdf first" in capsys.readouterr().err


def test_another_case_is_not_gone_on_with(out, tmp_path, capsys):
    again(out)
    words = ["resume", str(out), "--case", WORDS[0], *WORDS[3:], "--set", "output.milestones=0.01"]
    assert main([*words, "--set", "water.viscosity=1e-3"]) == 2
    assert "is the run of another case, which differs in water.viscosity" in capsys.readouterr().err
    assert main([*words, "--until", "0.025"]) == 0
    assert parsim.open(out).info["time"] >= 0.025
    assert main(["resume", str(out), "--set", "spacing=1"]) == 2
    assert "belong to the case that --case names" in capsys.readouterr().err


def test_a_row_of_a_table_is_the_case_that_is_gone_on_with(tmp_path, capsys):
    table, out = tmp_path / "table.csv", tmp_path / "out"
    table.write_text("water.viscosity,run.until\n1e-6,0.01\n2e-6,0.02\n")
    words = ["--case", WORDS[0], "--table", str(table), "--row"]
    assert main(["run", WORDS[0], "-o", str(out), *words[2:], "2"]) == 0
    again(out)
    assert main(["resume", str(out), *words, "1"]) == 2
    assert "differs in water.viscosity" in capsys.readouterr().err
    assert main(["resume", str(out), *words, "2"]) == 0
    table.write_text("water.viscosity,run.until\n1e-6,-1\n")
    with pytest.raises(InputError, match=f"{table}: row 1: run.until = -1"):
        load(CASE, table=table, row=1)
    assert load(CASE, ["run.until=3.0"], table=table, row=1).run.until == 3.0, "the command line comes last"


def test_check_knows_how_many_ranks_a_case_can_use(capsys):
    assert main(["check", str(CASE), "-n", "60"]) == 2
    assert "use at most" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["9" * 400, "1:2:3:4", "soon", "-1", "1.5", ""])
def test_a_walltime_that_is_none_is_refused(text):
    with pytest.raises(InputError, match="walltime = "):
        stop.seconds(text)


def test_a_signal_before_the_launcher_listens_is_not_lost(monkeypatch):
    monkeypatch.setattr(launch, "_STARTING", 0.5)
    heard = iter([True])
    assert launch.mpirun(1, ["sleep", "30"], lambda: next(heard)) == 128 + 10


def test_the_end_that_was_asked_for_last_holds_and_other_changes_do_not(out, capsys):
    again(out)
    case = (out / "case.toml").read_text()
    (out / "case.toml").write_text(case.replace("until = 0.02", "until = 0.2").replace("cfl = 1.0", "cfl = 0.5"))
    case_found = find(out).case
    assert case_found.run.until == 0.2 and case_found.run.cfl == 1.0
    assert "case.toml: run.cfl: not as in the checkpoint, which holds" in capsys.readouterr().err
    assert find(out, 0.3).case.run.until == 0.3
    (out / "case.toml").write_text(case[: len(case) // 2] + "=")
    assert find(out).case.run.until == 0.02
    assert "not valid TOML" in capsys.readouterr().err


def test_a_run_goes_on_though_frames_and_series_were_moved_away(out, tmp_path):
    for name in ("frames", "series", "case.toml"):
        shutil.move(out / name, tmp_path / name)
    assert main(["resume", str(out), "--until", "0.021"]) == 0
    assert parsim.open(out).case["run"]["until"] == 0.021 and len(list((out / "frames").iterdir())) > 0


def test_before_the_first_checkpoint_a_run_begins_again(finished, tmp_path, capsys, monkeypatch):
    out = tmp_path / "out"
    shutil.copytree(finished, out)
    shutil.rmtree(out / checkpoint.FOLDER)
    kernel = parsim.open(finished).info["kernel"]
    again(out, kernel=kernel, case_name="some")
    monkeypatch.setenv(variant.NAME, next((name for name in variant.possible() if name != kernel), kernel))
    (out / "frames" / "water_000999.vtkhdf").write_text("left over")
    assert main(["resume", str(out)]) == 0
    assert "no checkpoint" in capsys.readouterr().out
    assert (parsim.open(out).info["kernel"], parsim.open(out).info["case_name"]) == (kernel, "some")
    assert main(["compare", str(finished), str(out)]) == 0, capsys.readouterr().out
