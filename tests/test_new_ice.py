"""Examples with ice written out as a case of one's own, supplies that begin late, and runs that are made longer."""

import tomllib

import pytest
from example_cases import ROOT

from parsim.__main__ import main
from parsim.case.file import read
from parsim.case.model import load, parse
from parsim.errors import InputError


def own(example, folder, monkeypatch):
    """The case of one's own that `parsim new` makes of an example."""
    monkeypatch.chdir(folder)
    assert main(["new", "mine", "--from", example]) == 0
    return folder / "mine.toml"


def test_a_case_from_an_example_draws_its_ice_anew(tmp_path, monkeypatch):
    """Its floes are not written out: they follow from the keys, and another seed gives others."""
    path = own("jam/steady", tmp_path, monkeypatch)
    assert [body["name"] for body in tomllib.loads(path.read_text())["bodies"]] == ["cover"]
    assert load(path) == load(ROOT / "cases/jam/steady.toml")
    one, two = (load(path, [f"ice.supplies.floe.seed={seed}"]).bodies for seed in (1, 2))
    assert one[0] == two[0] and [body.shape for body in one[1:5]] != [body.shape for body in two[1:5]]


def test_a_field_from_an_example_follows_its_keys(tmp_path, monkeypatch):
    path = own("ice_field/floes", tmp_path, monkeypatch)
    many, few = (load(path, [f"ice.fields.0.concentration={share}"]) for share in (0.6, 0.2))
    assert many.ice.fields[0].floes > 2 * few.ice.fields[0].floes
    assert few.ice.fields[0].floes <= len(few.bodies)


def test_a_case_from_an_example_keeps_its_study(tmp_path, monkeypatch, capsys):
    path = own("jam/steady", tmp_path, monkeypatch)
    assert tomllib.loads(path.read_text())["study"] == read(ROOT / "cases/jam/steady.toml")["study"]
    assert main(["check", str(path)]) == 0
    assert "study      1 row with 10 runs" in capsys.readouterr().out


def test_a_supply_begins_before_the_run_ends():
    with pytest.raises(
        InputError, match=r"floe\.begins = 60\.0: must be before the end of the run, run\.until = 50\.0 s"
    ):
        load(ROOT / "cases/jam/steady.toml", ["ice.supplies.floe.begins=60.0", "ice.supplies.floe.ends=70.0"])


@pytest.mark.parametrize("ends", [True, False])
def test_a_run_that_is_made_longer_says_where_its_ice_ends(ends):
    """A supply without an end has floes to that of the run; a later one gives it no more."""
    given = ["spacing=0.04", "run.until=2.0", *(["ice.supplies.floe.ends=9.0"] if ends else [])]
    written = tomllib.loads(load(ROOT / "cases/ice_supply/drift.toml", given).to_toml())
    assert "that the run first had" not in "\n".join(parse(written).warnings())
    written["run"]["until"] = 6.0
    told = "\n".join(parse(written).warnings())
    assert ("that the run first had, about" in told) == (not ends)
