"""The table `study` of a case file: what it is made to say, and every way in which it is refused."""

import json

import pytest
from study_cases import BELOW, NUMBER, OUTCOME, SEARCH, SEEDS, write

from parsim.__main__ import main
from parsim.case.load import load
from parsim.errors import InputError
from parsim.study.outcomes import OUTCOMES
from parsim.study.study import checked
from parsim.study.table import read

GRID = 'grid = {"bodies.sphere.density" = [800.0, 900.0], "contacts.law" = ["hertz", "impulse"]}\n'


def test_a_study_is_no_part_of_the_case(tmp_path):
    path = write(tmp_path, BELOW + SEEDS % "")
    assert "study" not in load(path).to_toml()
    assert load(path) == load(write(tmp_path, ""))


def test_a_study_may_stand_in_a_file_of_its_own(tmp_path):
    write(tmp_path, BELOW + SEEDS % "")
    (tmp_path / "below").mkdir()
    path = tmp_path / "below" / "more.toml"
    (tmp_path / "below" / "table.csv").write_text("bodies.sphere.density\n800\n")
    path.write_text('extends = "../fall.toml"\n[study]\nseeds = {most = 50}\ntable = "table.csv"\n')
    study = read(path)
    assert study.seeds.most == 50 and study.seeds.first == 0.2
    assert study.rows() == [["bodies.sphere.density=800"]]


def test_a_grid_makes_rows_of_all_combinations(tmp_path):
    assert read(write(tmp_path, NUMBER + GRID)).rows() == [
        [f"bodies.sphere.density={density}", f'contacts.law="{law}"']
        for density in (800.0, 900.0)
        for law in ("hertz", "impulse")
    ]


def test_votes_near_the_edge_need_seeds(tmp_path):
    votes = [
        read(write(tmp_path, BELOW + SEARCH % "" + seeds)).near_votes
        for seeds in ("", SEEDS % "", SEEDS % ", most = 2", SEEDS % ", most = 4")
    ]
    votes.append(read(write(tmp_path, BELOW + SEARCH % ", votes = 5" + SEEDS % "")).near_votes)
    assert votes == [1, 3, 1, 3, 5]


def test_check_counts_the_runs(tmp_path, capsys):
    assert main(["check", str(write(tmp_path, BELOW + SEEDS % ", most = 7" + GRID))]) == 0
    assert "4 rows with 7 runs at most in each, for `parsim study`" in capsys.readouterr().out
    assert main(["check", str(write(tmp_path, BELOW + SEARCH % ""))]) == 0
    assert "1 row with a search in each" in capsys.readouterr().out


def test_the_schema_knows_the_study_and_all_outcomes(capsys):
    assert main(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    outcome = schema["$defs"]["Study"]["properties"]["outcome"]
    kinds = [
        schema["$defs"][each["$ref"].rpartition("/")[2]]["properties"]["kind"]["const"] for each in outcome["oneOf"]
    ]
    assert kinds == list(OUTCOMES) and schema["properties"]["study"]["$ref"] == "#/$defs/Study"
    for name in ("Study", "Seeds", "Bisection", "Outcome_last"):
        assert all(key.get("description") for key in schema["$defs"][name]["properties"].values()), name


@pytest.mark.parametrize(("text", "said"), [
    ("", "study.outcome: missing; what is asked of each finished run"),
    (NUMBER, "study: varies nothing; give seeds, table, grid or bisection"),
    (OUTCOME % "above = 0.3, below = 0.3" + SEEDS % "", "outcome.above = 0.3: no number is above it and below 0.3; mu"),
    (NUMBER + "grid = {spacing = [0.1, 0.2, 0.1]}", "study: rows 1 and 3 are the same, spacing=0.1"),
    (NUMBER + "grid = {" + ", ".join(f"k{n} = {list(range(99))}" for n in range(9)) + "}", "study.grid: makes 9135172"),
    ('outcome = {kind = "lst"}', "did you mean last?"),
    ('outcome = {kind = "last", series = "bodies"}\n' + SEEDS % "", "study.outcome.column: missing"),
    (NUMBER.replace("column", "colum") + SEEDS % "", "study.outcome.colum: unknown key; did you mean study.outcome.c"),
    (NUMBER.replace('"bodies"', '"bodyes"') + SEEDS % "", "study.outcome.series = 'bodyes': there is no such one"),
    (NUMBER.replace('"z"', '"height"') + SEEDS % "", "study.outcome.column = 'height': there is no such one"),
    (NUMBER.replace("body =", "bdy =") + SEEDS % "", "study.outcome.rows.bdy = 'bdy': there is no such one"),
    (NUMBER.replace("sphere", "spere") + SEEDS % "", "rows.body = 'spere': there is no such one; did you mean sphere"),
    ('outcome = {kind = "apex", body = "ball", number = 1}\n' + SEEDS % "", "outcome.body = 'ball': there is no"),
    ('outcome = {kind = "apex", body = "sphere", number = 1.5}', "study.outcome.number = 1.5: must be a whole number"),
    ('outcome = {kind = "crossed", series = "bodies", column = "z", level = 0.3, above = 1.0}\n' + SEEDS % "",
     "crossed says yes or no by itself; leave above and below out"),
    (NUMBER + SEEDS % ", mst = 3", "study.seeds.mst: unknown key; did you mean study.seeds.most"),
    (NUMBER + SEEDS % ", most = 0", "study.seeds.most = 0: must be at least 1"),
    (NUMBER + SEEDS % ", within = 0.0", "study.seeds.within = 0.0: must be greater than 0"),
    (NUMBER + SEEDS % ", most = 8, within = 0.1", "study.seeds.least = 10: must be at most study.seeds.most, 8"),
    (NUMBER + 'seeds = {key = "run.until", step = 0}', "study.seeds.step = 0: all runs would be the same"),
    (NUMBER + 'seeds = {key = "run..until"}', "study.seeds.key = 'run..until': must be a key of the case"),
    (NUMBER + 'seeds = {key = "water.sead"}', "water.sead: unknown key"),
    (NUMBER + 'seeds = {key = "title.x"}', "title is a single value and has no x"),
    (NUMBER + 'table = "none.csv"', "none.csv: cannot be read: No such file"),
    (NUMBER + 'table = "a.csv"\n' + GRID, "study.table and study.grid: give one of them"),
    (NUMBER + "grid = {spacing = []}", "study.grid.spacing: must have at least one value"),
    (NUMBER + 'grid = {"a..b" = [1]}', "study.grid: 'a..b' is no key of a case"),
    (NUMBER + "grid = {spacing = [-1.0]}", "study, spacing=-1.0: spacing = -1.0: must be"),
    (NUMBER + SEEDS % "" + 'grid = {"bodies.sphere.position.0" = [0.1]}', "bodies.sphere.position.0 is varied twice"),
    (NUMBER + SEEDS % ", most = 60000" + GRID, "study: 4 rows with 60000 runs each; at most 100000 runs"),
    (NUMBER + SEARCH % "", "study.bisection: needs an outcome that is yes or no"),
    (BELOW + SEARCH % ", votes = 2" + SEEDS % "", "study.bisection.votes = 2: must be odd"),
    (BELOW + SEARCH % ", votes = 3", "study.bisection.votes = 3: must be 1, for there are no study.seeds"),
    (BELOW + SEARCH % ", near_votes = 5" + SEEDS % ", most = 4", "near_votes = 5: must be at most study.seeds.most, 4"),
    (BELOW + SEARCH % ", votes = 3, near_votes = 1" + SEEDS % "", "near_votes = 1: must be at least study.bis"),
    (BELOW + 'fit = "logistic"\ngrid = {"bodies.sphere.density" = [8.0, 9.0], title = ["a", "b"]}', "needs one key"),
    ('outcome = {kind = "jam_forms"}\n' + SEEDS % "", 'study.outcome.kind = "jam_forms": needs measure.jam in the'),
    ('outcome = {kind = "block_goes_under", body = "sphere"}\n' + SEEDS % "", "needs measure.cover in the case"),
    (BELOW + SEARCH % "" + SEEDS % ", within = 0.1", "study.seeds.within: does not go with a bisection"),
    (BELOW + (SEARCH % "").replace("0.5", "0.1"), "study.bisection.yes = 0.1: must not be the value of no"),
    (BELOW + (SEARCH % "").replace("0.02", "0.4"), "width = 0.4: must be less than the distance between no and"),
    (BELOW + (SEARCH % "").replace("0.02", "1e-9"), "and at least 1e-06 of it"),
    (BELOW + (SEARCH % "").replace("no = 0.5", "no = 0.9"), "study, bodies.sphere.position.2=0.9: bodies.sphere"),
    (BELOW + (SEARCH % "").replace(".2", ".."), "study.bisection.key = 'bodies.sphere.position..': must be a key"),
    (BELOW + 'fit = "logistic"\n' + SEEDS % "", "study.fit = 'logistic': needs one key that varies"),
    (NUMBER + 'fit = "logistic"\ngrid = {"bodies.sphere.density" = [8.0, 9.0]}', "needs an outcome that is yes"),
    (NUMBER + 'fit = "line"\n' + SEEDS % "", "study.fit = 'line': must be 'logistic'"),
])  # fmt: skip
def test_a_wrong_study_is_told_before_anything_is_written(text, said, tmp_path, capsys):
    path = write(tmp_path, text)
    assert main(["study", str(path), "-o", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_table_is_not_replaced_by_that_of_the_runs(tmp_path, capsys):
    (tmp_path / "runs.csv").write_text("bodies.sphere.density\n800\n")
    path = write(tmp_path, NUMBER + SEEDS % "" + 'table = "runs.csv"\n')
    assert main(["study", str(path), "-o", str(tmp_path), "--gather"]) == 2
    assert "its runs.csv is study.table, and would be replaced; choose another folder" in capsys.readouterr().err


def test_a_file_without_a_study_is_told(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text("dimensions = 3\n")
    with pytest.raises(InputError, match=r'holds no \[study\]; write one into the case, .* extends = "CASE.toml"'):
        read(path)


def test_all_mistakes_are_told_at_once(tmp_path):
    text = NUMBER.replace('"z"', '"hight"') + 'seeds = {key = "run.untl"}'
    with pytest.raises(InputError) as told:
        checked(write(tmp_path, text), 1)
    assert "run.untl: unknown key; did you mean run.until" in str(told.value)
    assert "study.outcome.column = 'hight': there is no such one" in str(told.value)


def test_more_ranks_than_a_case_can_use_are_told(tmp_path):
    with pytest.raises(InputError, match="999 ranks: the box has"):
        checked(write(tmp_path, NUMBER + SEEDS % ""), 999)
