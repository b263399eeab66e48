"""`parsim validate`: what it runs, how it judges, and what it says of wrong bars."""

import csv
import json
import math
import subprocess
import threading
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import fake_run
import pytest

from parsim.errors import InputError
from parsim.report.measures import Published
from parsim.validate import bars as held
from parsim.validate import runs
from parsim.validate.bars import Bar
from parsim.validate.page import write
from parsim.validate.record import note

BAR = Bar("case/one", "quick", "height", "apex", 0.01, False, {})


def number(low, high=None, model=None):
    """A published number or range."""
    fields = dict.fromkeys(Published.__dataclass_fields__, None)
    return Published(**fields | {"low": low, "high": low if high is None else high, "model": model, "unit": "m"})


@pytest.mark.parametrize(("value", "low", "high", "error", "passed"), [
    (1.005, 1.0, None, 0.005, True),
    (1.02, 1.0, None, 0.02, False),
    (0.98, 1.0, None, -0.02, False),
    (1.5, 1.0, 2.0, 0.0, True),
    (2.1, 1.0, 2.0, 0.05, False),
    (0.005, 0.0, None, 0.005, True),
    (None, 1.0, None, None, False),
])  # fmt: skip
def test_a_value_is_held_to_a_number_or_a_range(value, low, high, error, passed):
    row = runs.judged(BAR, value, number(low, high, model=1.1 * low))
    assert row["passed"] is passed
    assert row["error"] == (None if error is None else pytest.approx(error))
    assert ("MISSED" in runs.told(row)) == (not passed and value is not None)


def test_without_a_number_the_value_is_the_error():
    assert runs.judged(BAR, 0.02, None)["error"] == 0.02


def test_a_measure_that_is_not_there_is_told(tmp_path):
    file = tmp_path / held.FILE
    file.write_text('[one]\nlevel = "quick"\n[[one.bars]]\nquantity = "h"\nmeasure = "apexx"\nwithin = 0.1\n')
    with pytest.raises(InputError, match=r"one: measure = apexx: there is no such one.*did you mean apex"):
        list(held._read(file))


@pytest.mark.parametrize(("names", "level", "said"), [
    (["bouncing_spher"], "quick", "no such example.*bouncing_sphere"),
    ([], "slow", "must be quick or full"),
])  # fmt: skip
def test_a_name_or_level_that_is_not_there_is_told(names, level, said):
    with pytest.raises(InputError, match=said):
        held.bars(names, level)


def test_every_bar_of_the_cases_is_read():
    every = held.bars([], "full")
    assert len(every) >= 6 and all(each for each in every.values())
    assert sum(len(each) for each in held.bars([], "quick").values()) < sum(len(each) for each in every.values())


def test_a_run_goes_on_where_it_is_and_one_of_another_case_is_refused(tmp_path, monkeypatch):
    """Not what is in the folder decides, but `parsim resume --case`."""
    said = []

    def run(words, **options):
        said.append(words[3:])
        return SimpleNamespace(returncode=2, stderr="another case")

    monkeypatch.setattr(subprocess, "run", run)
    file, out = tmp_path / "a.toml", tmp_path / "out"
    assert not runs._run(file, out, 1)
    out.mkdir()
    (out / "run.json").write_text(json.dumps({"status": "running"}))
    assert not runs._run(file, out, 2)
    assert said == [["run", str(file), "-o", str(out)], ["resume", str(out), "--case", str(file), "-n", "2"]]


def test_results_are_kept_and_brought_up_to_date(tmp_path):
    table = tmp_path / "results.csv"
    one, two = runs.judged(BAR, 1.005, number(1.0)), runs.judged(BAR, 1.5, number(1.0, 2.0)) | {"quantity": "width"}
    note(table, [one, two])
    note(table, [runs.judged(BAR, 0.9, number(1.0)), two | {"value": None}])
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert [row["quantity"] for row in rows] == ["height", "width"]
    assert rows[0]["value"] == "0.9" and rows[0]["passed"] == "False" and rows[0]["machine"]
    assert rows[1]["reference"] == "1 to 2" and rows[1]["date"].count("-") == 2
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="is no table of results"):
        note(tmp_path / "other.csv", [one])


@pytest.fixture
def made(monkeypatch):
    """Two cases with a bar each, whose runs are made up: {case: value}."""
    values = {"one": 1.0, "two": 2.0}
    held_to = {Path(f"case/{name}.toml"): [replace(BAR, case=f"case/{name}")] for name in values}
    published = replace(number(1.0), quantity="height")
    monkeypatch.setattr(runs, "bars", lambda names, level: held_to)
    monkeypatch.setattr(runs, "MEASURES", {"apex": lambda run: values[run]})
    monkeypatch.setattr(runs, "published", lambda run: [published])
    monkeypatch.setattr(runs.parsim, "open", lambda out: out.name.split("-")[1])
    monkeypatch.setattr(runs, "_run", lambda path, out, ranks: True)
    return values


def test_misses_that_are_known_are_no_failure(made, tmp_path, capsys):
    """Exit code 3 for a bar that was met, or is new, but not for one that the table has as missed."""
    table = tmp_path / "results.csv"
    assert runs.validate([], "quick", False, None) == runs.MISSED
    assert "1 of 2 bars met, 1 missed\n" in capsys.readouterr().out
    assert runs.validate([], "quick", False, None, tables=(table, None)) == runs.MISSED
    assert runs.validate([], "quick", False, None, tables=(None, table)) == 0
    assert f"1 missed, 1 of them as in {table}" in capsys.readouterr().out
    made["one"] = 1.5
    assert runs.validate([], "quick", False, None, tables=(table, table)) == runs.MISSED
    assert runs.validate([], "quick", False, None, tables=(None, table)) == 0, "brought up to date, it is known"
    with pytest.raises(InputError, match=r"--known = .*nothing.csv: no such file"):
        runs.validate([], "quick", False, None, tables=(None, tmp_path / "nothing.csv"))


def test_what_has_no_value_is_null_for_machines(made, capsys, monkeypatch):
    monkeypatch.setitem(runs.MEASURES, "apex", lambda run, **more: math.nan)
    assert runs.validate([], "quick", True, None) == runs.MISSED
    rows = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert all(row["value"] is None and row["passed"] is False for row in rows)


def test_cases_run_side_by_side_and_are_told_in_their_order(made, capsys, monkeypatch):
    meeting = threading.Barrier(2, timeout=10.0)
    monkeypatch.setattr(runs, "_run", lambda path, out, ranks: meeting.wait() >= 0)
    assert runs.validate([], "quick", False, None, hands=(2, 1)) == runs.MISSED
    told = capsys.readouterr().out
    assert told.index("case/one") < told.index("case/two")


@pytest.mark.long
def test_the_page_shows_every_case_and_its_pictures(tmp_path):
    fake_run.make(tmp_path / "case-one", times=(0.0, 0.4), spacing=0.03)
    rows = [runs.judged(BAR, 1.02, number(1.0, model=1.1)), runs.judged(BAR, None, None) | {"case": "case/two"}]
    curve = {"series": "bodies", "column": "z", "curve": [[0.0, 1.0], [0.4, 0.9]]}
    bars = [BAR, Bar("case/one", "quick", "fall", "off_curve", 0.1, True, curve)]
    text = write(tmp_path, rows, bars).read_text()
    assert "0 of 2 bars met" in text and text.count("MISSED") == 2 and "The run failed, or has" in text
    assert text.count("<img") >= 3 and "curves of case/one" in text and 'href="case-one/report/index.html"' in text
    assert (tmp_path / "case-one" / "report" / "index.html").is_file()


def test_what_cannot_be_measured_takes_nothing_else_along(made, tmp_path, capsys, monkeypatch):
    def apex(run):
        if run == "two":
            raise InputError("the series bodies has no row from t = 2 s on")
        return made[run]

    monkeypatch.setitem(runs.MEASURES, "apex", apex)
    assert runs.validate([], "quick", False, None, tables=(tmp_path / "results.csv", None)) == 1
    told = capsys.readouterr()
    assert "case/two: height: cannot be measured: the series bodies has no row" in told.err
    assert "height: no value" in told.out
    assert "case/one" in (tmp_path / "results.csv").read_text(), "what was measured is kept"


@pytest.mark.parametrize("place", ["other.csv", "latin.csv", ".", "no/such/results.csv"])
def test_a_table_that_cannot_be_kept_is_refused_before_anything_runs(made, tmp_path, monkeypatch, place):
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    (tmp_path / "latin.csv").write_bytes(b"H\xf6he\n")
    monkeypatch.setattr(runs, "_run", lambda path, out, ranks: pytest.fail("it has run"))
    with pytest.raises(InputError, match="--record = "):
        runs.validate([], "quick", False, None, tables=(tmp_path / place, None))
