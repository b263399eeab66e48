"""Checkpoints: what is written is read, what is broken is not believed, a run goes on to the bit."""

import json
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from test_water import POOL, simulation

import parsim
from parsim.__main__ import main
from parsim.domain.comm import Comm
from parsim.errors import InputError
from parsim.fluid.wcmps.fields import FIELDS
from parsim.launch import stop
from parsim.machine import variant
from parsim.output import checkpoint
from parsim.particles.state import of_water
from parsim.run.resume import find

CASE = Path(__file__).with_name("survive.toml")
SHORT = ["--set", "output.frames=0.02"]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A checkpoint, and the snapshot it holds."""
    s = simulation(POOL | {"run": {"until": 1.0}})
    while s.step_count < 8 or not s.rebuilds_next():
        s.step()
    path, snapshot = tmp_path_factory.mktemp("checkpoint") / "checkpoint_000000008.h5", s.snapshot()
    checkpoint.write(path, s.case.to_toml(), snapshot, Comm())
    return path, snapshot, s


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run in one go, which has left a checkpoint at its last rebuild."""
    out = tmp_path_factory.mktemp("run") / "out"
    assert main(["run", str(CASE), "-o", str(out), "--until", "0.1", *SHORT, "--set", "output.milestones=0.03"]) == 0
    return out


def test_what_is_written_is_read(written):
    path, snapshot, _ = written
    found = checkpoint.Checkpoint(path)
    water = found.snapshot(FIELDS, 0, 1).water
    order = np.argsort(snapshot.water.id)
    for name in of_water(FIELDS):
        assert np.array_equal(getattr(water, name), getattr(snapshot.water, name)[order]), name
    assert set(found.parts) == {"bodies", "contacts"}
    for part, kept in snapshot.parts.items():
        for name, values in kept.items():
            assert np.array_equal(found.parts[part][name], values), name
    assert found.account == json.loads(json.dumps(snapshot.account))


def test_ranks_read_all_of_it_between_them(written):
    path, snapshot, _ = written
    parts = [checkpoint.Checkpoint(path).snapshot(FIELDS, rank, 3).water for rank in range(3)]
    assert np.array_equal(np.concatenate([part.id for part in parts]), np.sort(snapshot.water.id))


def test_a_restored_simulation_takes_the_same_steps(written):
    from parsim.run.simulation import Simulation

    path, _, s = written
    other = Simulation(s.case, Comm(), checkpoint.Checkpoint(path).snapshot(FIELDS, 0, 1))
    for _ in range(30):
        s.step()
        other.step()
    assert (s.time, s.dt, s.speed) == (other.time, other.dt, other.speed)
    for name in of_water(FIELDS):
        assert np.array_equal(getattr(s.fluid, name), getattr(other.fluid, name)), name


@pytest.mark.parametrize("seed", range(200))
def test_a_flipped_byte_or_a_cut_is_detected_or_harmless(written, tmp_path, seed):
    path, snapshot, _ = written
    random, data = np.random.default_rng(seed), bytearray(path.read_bytes())
    at = int(random.integers(len(data)) if seed % 4 else random.integers(600))  # the beginning is a small target
    if seed % 5:
        data[at] ^= int(random.integers(1, 256))
    else:
        del data[at:]
    other = tmp_path / path.name
    other.write_bytes(data)
    try:
        found = checkpoint.Checkpoint(other)
    except checkpoint.Broken:
        return
    assert found.account == snapshot.account and at < 512, "a change beyond the text at the beginning went unseen"
    water = found.snapshot(FIELDS, 0, 1).water
    pairs = [(getattr(water, name), getattr(snapshot.water, name)) for name in of_water(FIELDS)]
    assert all(np.array_equal(np.sort(one), np.sort(two)) for one, two in pairs)


def test_a_data_set_that_is_not_what_was_given_is_named(written, tmp_path):
    other = tmp_path / written[0].name
    shutil.copy(written[0], other)
    with h5py.File(other, "r+") as file:
        file["water/u"][3] += 1.0
    checkpoint._seal(other)
    with pytest.raises(checkpoint.Broken, match="data set water/u is wrong"):
        checkpoint.Checkpoint(other)


def test_the_newest_whole_one_is_taken_and_a_broken_one_named(written, tmp_path):
    folder = tmp_path / checkpoint.FOLDER
    folder.mkdir()
    for step in (8, 30, 120):
        shutil.copy(written[0], folder / f"checkpoint_{step:09d}.h5")
    (folder / "checkpoint_000000120.h5").write_bytes(b"")
    found, broken = checkpoint.newest(tmp_path)
    assert found.path.name == "checkpoint_000000030.h5"
    assert len(broken) == 1 and "checkpoint_000000120.h5: is too short" in broken[0]


def test_a_run_in_two_pieces_is_a_run_in_one(finished, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["run", str(CASE), "-o", str(out), "--until", "0.05", *SHORT, "--set", "output.milestones=0.03"]) == 0
    assert main(["resume", str(out), "--until", "0.1"]) == 0
    assert main(["compare", str(finished), str(out)]) == 0, capsys.readouterr().out
    pieces = parsim.open(out).info["pieces"]
    assert [piece["ended"] for piece in pieces] == ["done", "done"]
    assert 0 < pieces[1]["from_step"] <= pieces[0]["steps"]


def test_milestones_are_kept_and_mark_their_times(finished):
    milestones = [checkpoint.Checkpoint(path) for path in checkpoint.listed(finished) if "milestone" in path.name]
    times = [milestone.account["time"] for milestone in milestones]
    assert len(times) == 3
    for time, due in zip(times, (0.03, 0.06, 0.09), strict=True):
        assert due <= time < due + 20 * milestones[0].account["dt"]


def test_a_run_can_go_on_from_a_milestone(finished, tmp_path, capsys):
    out = tmp_path / "out"
    shutil.copytree(finished, out)
    kept = checkpoint.listed(out)[0]
    for path in checkpoint.listed(out)[1:]:
        path.unlink()
    assert kept.name.startswith("milestone")
    (out / "run.json").write_text(json.dumps({"status": "running"}))
    assert main(["resume", str(out)]) == 0
    assert main(["compare", str(finished), str(out)]) == 0, capsys.readouterr().out


def test_a_finished_run_is_left_alone(finished, capsys):
    before = (finished / "run.json").read_text()
    assert main(["resume", str(finished)]) == 0
    assert "is done" in capsys.readouterr().out
    assert (finished / "run.json").read_text() == before


def test_only_broken_checkpoints_are_refused(finished, tmp_path, capsys):
    out = tmp_path / "out"
    shutil.copytree(finished, out)
    (out / "run.json").write_text(json.dumps({"status": "running"}))
    for path in checkpoint.listed(out):
        path.write_bytes(path.read_bytes()[:-1])
    assert main(["resume", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.count("warning: ") == len(checkpoint.listed(out)) and "holds no whole checkpoint" in said


def test_nothing_to_resume_is_refused(tmp_path):
    with pytest.raises(InputError, match="not an output folder"):
        find(tmp_path)


def test_what_cannot_go_on_is_refused(finished, tmp_path, capsys, monkeypatch):
    out = tmp_path / "out"
    shutil.copytree(finished, out)
    (out / "run.json").write_text(json.dumps({"status": "running"}))
    assert main(["resume", str(out), "--until", "0.05"]) == 2
    assert "--until = 0.05: must be later than the checkpoint" in capsys.readouterr().err
    monkeypatch.setattr(variant, "versions", lambda: {"numba": "0.1"})
    monkeypatch.setattr(variant, "possible", lambda: ["other"])
    assert main(["resume", str(out)]) == 2
    assert "which this processor does not have; with --kernel" in capsys.readouterr().err
    find(out, 0.2, "other")
    assert "this is 0.1; last bits may differ" in capsys.readouterr().err
    assert main(["resume", str(out), "--walltime", "soon"]) == 2
    assert "walltime = soon: must be minutes" in capsys.readouterr().err


def test_info_tells_of_the_pieces(finished, capsys):
    assert main(["info", str(finished)]) == 0
    assert "from step 0 on 1 ranks: done" in capsys.readouterr().out


def test_info_tells_of_a_killed_run(finished, tmp_path, capsys):
    out = tmp_path / "out"
    shutil.copytree(finished, out)
    (out / "run.json").write_text(json.dumps({"status": "running"}))
    assert main(["info", str(out)]) == 0
    assert "`parsim resume` goes on" in capsys.readouterr().out


@pytest.mark.parametrize(("text", "seconds"), [("7", 420), ("0:90", 90), ("2:03:04", 7384), ("1-02:03:04", 93784)])
def test_walltimes_are_read_as_schedulers_write_them(text, seconds):
    assert stop.seconds(text) == seconds
