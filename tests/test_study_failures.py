"""`parsim study`: runs that fail, are refused, say nothing or are stopped, and what becomes of the others."""

import pytest
from study_cases import BELOW, SEEDS, Machine


def test_runs_that_fail_or_have_no_outcome_are_counted_and_not_made_again(study, monkeypatch, capsys):
    said = {1: "fail", 2: "kill", 3: float("nan")}
    machine = Machine(monkeypatch, lambda case, number: said.get(number, 0.2))
    assert study(BELOW + SEEDS % ", most = 6") == 1
    told = study.told()
    assert told["runs"] == {"done": 3, "no outcome": 1, "failed": 1, "stopped": 1, "running": 0, "waiting": 0}
    assert not told["complete"] and told["rows"][0]["yes"] == told["rows"][0]["outcomes"] == 3
    assert "run 1, bodies.sphere.position.0=0.2: failed: RunError: it flew" in capsys.readouterr().out
    page = (study.out / "index.html").read_text()
    assert "Failed and not counted: 1 of 6 runs" in page and "the same command goes on with it" in page
    said.clear()
    assert study(BELOW + SEEDS % ", most = 6") == 1
    assert machine.numbers[6:] == [2] and machine.calls[6][0] == "resume"
    assert study(BELOW + SEEDS % ", most = 6", "--retry") == 0
    assert machine.numbers[7:] == [1] and machine.calls[7][0] == "resume"
    assert study.told()["rows"][0]["outcomes"] == 5 and study.told()["complete"]


def test_runs_that_end_before_they_write_anything_have_failed_and_are_made_again_later(study, monkeypatch, capsys):
    machine = Machine(monkeypatch, lambda case, number: "crash")
    assert study(BELOW + SEEDS % ", most = 2") == 1
    assert study.told()["runs"]["failed"] == 2 and machine.numbers == [1, 2]
    assert f"failed: ended before it wrote anything; see {study.out / 'run-1.log'}" in capsys.readouterr().out
    machine.law = lambda case, number: 0.5
    assert study(BELOW + SEEDS % ", most = 2") == 0 and machine.numbers == [1, 2, 1, 2]


def test_a_run_that_fails_again_is_not_tried_for_ever(study, monkeypatch):
    machine = Machine(monkeypatch, lambda case, number: "fail")
    assert study(BELOW + SEEDS % ", most = 2") == 1 == study(BELOW + SEEDS % ", most = 2", "--retry")
    assert machine.numbers == [1, 2, 1, 2]


@pytest.mark.parametrize(("end", "code", "told"), [
    ("full", 74, "run-2: the other"),
    ("stop", 75, ""),
])  # fmt: skip
def test_what_would_end_every_run_ends_the_study(end, code, told, study, monkeypatch, capsys):
    machine = Machine(monkeypatch, lambda case, number: end if number == 2 else 0.5)
    assert study(BELOW + SEEDS % ", most = 9", "--jobs", "2") == code
    assert max(machine.numbers) <= 3 and told in capsys.readouterr().err and machine.running == 0
    machine.law = lambda case, number: 0.5
    assert study(BELOW + SEEDS % ", most = 9") == 0
    assert study.told()["rows"][0]["outcomes"] == 9 and machine.numbers.count(1) == 1


def test_a_run_that_is_refused_has_failed_and_the_study_goes_on(study, monkeypatch, capsys):
    machine = Machine(monkeypatch, lambda case, number: "bad" if number == 2 else 0.2)
    assert study(BELOW + SEEDS % ", most = 5") == 1
    assert study.told()["rows"][0]["outcomes"] == 4 and machine.numbers == [1, 2, 3, 4, 5]
    assert study.rows()[1]["state"] == "failed"
    assert "failed: refused: one thing; the other; see" in capsys.readouterr().out
    assert study(BELOW + SEEDS % ", most = 5") == 1 and machine.numbers[5:] == [2], "it may be accepted another time"


def test_a_run_whose_outcome_cannot_be_asked_does_not_end_the_study(study, monkeypatch, capsys):
    Machine(monkeypatch, lambda case, number: 0.2)
    late = BELOW.replace('column = "z"', 'column = "z", level = 0.3, after = 9.0').replace("last", "crossing_time")
    assert study(late + SEEDS % ", most = 3") == 1, "none has an outcome"
    assert study.told()["runs"]["no outcome"] == 3 and study.told()["complete"]
    assert "the series bodies has no row from t = 9 s on" in study.rows()[0]["note"]


def test_a_run_that_was_stopped_is_not_missed_where_the_others_are_enough(study, monkeypatch):
    machine = Machine(monkeypatch, lambda case, number: "kill" if number == 12 else 0.5)
    text = BELOW + SEEDS % ", most = 30, least = 4, within = %s"
    assert study(text % 0.1) == 1 and 12 in machine.numbers and not study.told()["complete"]
    assert study(text % 0.2) == 0 and study.told()["complete"] and study.told()["runs"]["stopped"] == 1
