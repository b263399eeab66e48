"""What a study asks finished runs: series with known columns, and what is said where they cannot be asked."""

import fake_run
import pytest

import parsim
from parsim.case.messages import validated
from parsim.case.types import Table
from parsim.errors import InputError
from parsim.output.series import Table as Series
from parsim.study.outcomes import Outcome


class Root(Table):
    """As the table `study`."""

    outcome: Outcome


def asked(**keys):
    root, messages = validated(Root, {"outcome": keys})
    assert not messages
    return root.outcome


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A made-up run with a series of two bodies: z falls from 1 by 0.25 a row, or is the square of the time."""
    folder = tmp_path_factory.mktemp("run") / "out"
    fake_run.make(folder, times=(0.0, 0.4), spacing=0.05)
    table = Series(folder / "series" / "places.csv", {"step": "-", "time": "s", "body": "-", "z": "m", "e": "-"})
    for step, time in enumerate((-0.5, 0.0, 0.5, 1.0, 1.5)):
        table.row(step, time, "A", 1.0 - 0.25 * step, 7.0)
        table.row(step, time, "B", time * time, float("inf"))
        table.row(step, time, "dry", time if time >= 0.5 else float("nan"), float("nan"))
    table.close()
    return parsim.open(folder)


A, B, DRY = {"body": "A"}, {"body": "B"}, {"body": "dry"}


@pytest.mark.parametrize(("keys", "value"), [
    ({"kind": "last", "rows": A}, 0.0),
    ({"kind": "last", "rows": B}, 2.25),
    ({"kind": "mean", "rows": A}, 0.375),
    ({"kind": "mean", "rows": A, "after": -1.0}, 0.5),
    ({"kind": "maximum", "rows": A}, 0.75),
    ({"kind": "maximum", "after": 1.0}, 2.25),
    ({"kind": "minimum", "rows": B}, 0.0),
    ({"kind": "crossed", "rows": A, "level": 0.3}, True),
    ({"kind": "crossed", "rows": A, "level": 0.8}, False),  # it is below from t = 0 on
    ({"kind": "crossed", "rows": A, "level": 0.8, "after": -1.0}, True),
    ({"kind": "crossed", "rows": B, "level": 2.25}, True),
    ({"kind": "crossed", "rows": B, "level": 2.3}, False),
    ({"kind": "crossing_time", "rows": A, "level": 0.35}, 0.8),
    ({"kind": "crossing_time", "rows": B, "level": 0.625}, 0.75),
    ({"kind": "crossing_time", "rows": A, "level": 0.75}, 0.0),
    ({"kind": "crossing_time", "rows": A, "level": -9.0}, None),
    ({"kind": "crossing_time", "rows": DRY, "level": 0.75}, 0.75),  # as a gauge that water has not reached yet
    ({"kind": "crossing_time", "column": "e", "rows": DRY, "level": 0.75}, None),
    ({"kind": "crossing_time", "rows": A, "level": -9.0, "below": 1.0}, None),
    ({"kind": "maximum", "column": "e", "rows": B}, None),
    ({"kind": "last", "rows": A, "below": 0.5}, True),
    ({"kind": "last", "rows": A, "below": 0.0}, False),
    ({"kind": "last", "rows": B, "above": 2.0, "below": 2.5}, True),
    ({"kind": "last", "rows": B, "above": 2.0, "below": 2.2}, False),
])  # fmt: skip
def test_outcomes_of_a_known_series(keys, value, run):
    outcome = asked(series="places", **{"column": "z"} | keys)
    found = outcome.of(run)
    assert found == (value if isinstance(value, bool) or value is None else pytest.approx(value))
    assert value is None or outcome.decides == isinstance(found, bool)


@pytest.mark.parametrize(("keys", "said"), [
    ({"kind": "last"}, "has several rows at a time; tell one, as by rows"),
    ({"kind": "crossed", "level": 0.5}, "has several rows at a time"),
    ({"kind": "last", "rows": {"body": "C"}}, "rows.body = 'C': no such row in .*; there are: A, B, dry"),
    ({"kind": "mean", "after": 9.0}, "the series places has no row from t = 9 s on"),
    ({"kind": "last", "series": "place"}, "series = 'place': not in .*did you mean places"),
    ({"kind": "last", "rows": A, "column": "zz"}, "study.outcome: KeyError: 'zz'"),
])  # fmt: skip
def test_what_cannot_be_asked_is_told_with_the_run(keys, said, run):
    with pytest.raises(InputError, match=said) as told:
        asked(**{"series": "places", "column": "z"} | keys).of(run)
    assert str(run.folder) in str(told.value)
