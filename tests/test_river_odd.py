"""The measures of rivers that are out of the ordinary: driven, dry, short, still, settled, with a bed."""

import math

import fake_river
import numpy as np
import pytest
from fake_river import SPEED

import parsim
from parsim.report.build import Page
from parsim.report.sections import river as section
from parsim.river.reader import River

SECTIONS = {"reach": [0.5, 3.5], "head_loss": [1.0, 3.0]}


def river(folder):
    return River(parsim.open(folder))


def words(river):
    return section.parts(Page(river.run, vtk=False))


def test_a_channel_that_holds_a_discharge_loses_what_drives_it(tmp_path):
    """Its level is even: all that is lost is what the force along x, 0.003 g from 5 s on, has put in."""
    folder = fake_river.make_odd(tmp_path / "out", np.arange(0.0, 10.1, 1.0), [0.0, 10.0], measure=SECTIONS)
    rows = [(k, 0.1 * k, 0.2, 0.2, 0.0, 0.03, 0.003 if k > 50 else 0.0) for k in range(101)]
    fake_river.series(folder, "channel", rows)
    means = river(folder).reach_means(10.0)
    assert means["energy_slope"] == pytest.approx(0.003) and means["head_loss"] == pytest.approx(0.006)
    assert river(folder).reach_means(4.0)["energy_slope"] == pytest.approx(0.0, abs=1e-12)


def test_a_tilted_channel_loses_its_slope(tmp_path):
    folder = fake_river.make_odd(
        tmp_path / "out", [0.0, 1.0], [0.0, 1.0], measure=SECTIONS, gravity=[9.81 * 0.002, 0.0, -9.81]
    )
    fake_river.series(folder, "channel", [])
    assert river(folder).reach_means(1.0)["energy_slope"] == pytest.approx(0.002)


def test_frames_far_apart_have_a_level_before(tmp_path):
    """The first frame, of step 0, has no pressures, and is the only one in the time before."""
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 5.0, 10.0], [0.0, 10.0], first=0)
    seen = river(folder)
    assert seen.before[1] < 5.0 and np.isnan(seen.along(0.0)["level"]).all()
    assert seen.rise(10.0) == pytest.approx(0.0, abs=1e-12) and seen.drift == pytest.approx(SPEED)


def test_a_reach_without_a_column_has_no_means(tmp_path):
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], measure={"reach": [1.01, 1.02]})
    assert all(math.isnan(value) for value in river(folder).reach_means(1.0).values())


@pytest.mark.parametrize("bodies", [(), (fake_river.PIER,), (fake_river.ICE,)])
def test_a_run_may_lack_bodies_ice_or_piers(tmp_path, bodies):
    folder = fake_river.make_odd(tmp_path / "out", [0.0, 1.0], [0.0, 1.0], bodies)
    seen = river(folder)
    assert words(seen).count("<img") == (1 if not seen.loose.any() else 4)
    assert np.isfinite(seen.along(1.0)["level"]).all()
