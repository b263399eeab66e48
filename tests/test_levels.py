"""Levels along a line, on water whose levels are known."""

import numpy as np
import pytest
from flows import simulation, tank

from parsim.case.model import parse
from parsim.errors import InputError
from parsim.observe.levels import Levels

LINE = {"kind": "levels", "name": "along", "start": [0.05, 0.0], "end": [0.35, 0.0], "points": 7}


def given(line, across=None, **changes):
    """Water 0.1 m deep up to x = 0.2, 0.06 m beyond."""
    case = tank(0.4, 0.2, 0.01, fill=(0.2, 0.1), across=across)
    width = 1.0 if across is None else across
    case["water"]["fill"].append({"min": [0.2, 0.0, 0.0], "max": [0.4, width, 0.06]})
    return case | {"output": {"sensors": [line]}} | changes


@pytest.mark.parametrize("across", [None, 0.06])
def test_levels_are_those_of_the_water_at_each_point(across):
    s = simulation(given(LINE | {"end": [0.35, across or 0.0]}, across))
    assert np.isnan([row[-1] for row in Levels(s.case).rows(s)]).all(), "there are no pressures yet"
    s.step()
    names, distance, x, y, level, head = zip(*Levels(s.case).rows(s), strict=True)
    assert set(names) == {"along"} and x == pytest.approx(np.linspace(0.05, 0.35, 7))
    assert distance == pytest.approx(np.hypot(np.array(x) - 0.05, y))
    assert level == pytest.approx([0.1] * 4 + [0.06] * 3, abs=0.002)
    assert np.array(head)[[0, 1, 5, 6]] == pytest.approx([0.1, 0.1, 0.06, 0.06], abs=0.005)


def test_where_it_is_dry_there_is_no_level():
    s = simulation(given(LINE) | {"water": tank(0.4, 0.2, 0.01, fill=(0.2, 0.1))["water"]})
    s.step()
    rows = Levels(s.case).rows(s)
    assert np.isnan(rows[-1][-2:]).all() and not np.isnan(rows[0][-2:]).any()


@pytest.mark.parametrize(("line", "changes", "said"), [
    (LINE | {"end": [0.5, 0.0]}, {}, "output.sensors.along.end.0 = 0.5: outside the box; must be 0.0 to 0.4"),
    (LINE | {"end": [0.05, 0.0]}, {}, "along.start, end = [0.05, 0.0]: must be two points"),
    (LINE | {"points": 1}, {}, "points = 1: must be at least 2"),
    (LINE, {"gravity": [1.0, 0.0, 0.0]}, "along.kind: gravity = [1.0, 0.0, 0.0]: must go along -z"),
])  # fmt: skip
def test_a_wrong_line_is_told(line, changes, said):
    with pytest.raises(InputError) as error:
        parse(given(line, **changes))
    assert said in str(error.value)


def test_the_page_draws_it():
    from types import SimpleNamespace

    from parsim.report.sections.gauges import levels

    time, distance = np.repeat([0.0, 0.1, 0.2], 4), np.tile(np.linspace(0.0, 0.3, 4), 3)
    columns = {"step": time, "line": np.full(12, "along"), "time": time, "distance": distance}
    columns |= {"level": 0.1 + 0.0 * time, "piezometric": 0.1 + 0.0 * time}
    drawn = levels(SimpleNamespace(series_names=["levels"], series=lambda name: columns))
    assert len(drawn.axes) == 1 and len(drawn.axes[0].lines) == 6
