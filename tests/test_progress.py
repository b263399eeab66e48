"""Progress: what it prints and when, on a terminal and in a log, and what a call costs."""

import os
import re
import time

import pytest

from parsim.launch import mpirun as launch
from parsim.run import progress


@pytest.fixture
def clock(monkeypatch):
    """A wall clock (s) that stands until it is set."""

    class Clock:
        now = 100.0

        def perf_counter(self):
            return self.now

    clock = Clock()
    monkeypatch.setattr(progress, "clock", clock)
    return clock


def run(meter, clock, wall, active=1000):
    """Steps of 1 s of wall time and 1 ms of simulated time."""
    for step in range(1, wall + 1):
        clock.now += 1.0
        meter.step(step, 1e-3 * step, 1e-3, active)


def test_log_lines_come_at_growing_intervals(clock, capsys):
    meter = progress.Progress(0.0, 1.0)
    run(meter, clock, 250)
    steps = [int(step) for step in re.findall(r"step (\d+)", capsys.readouterr().out)]
    assert steps == [2, 6, 14, 30, 62, 122, 182, 242]


def test_facts_are_right(clock, capsys):
    meter = progress.Progress(0.0, 1.0)
    run(meter, clock, 6)
    last = capsys.readouterr().out.splitlines()[-1]
    for fact in ("t = 0.0060 of 1 s", "16 min 34 s left", "dt 1 ms", "1 k particle-steps/s", "step 6"):
        assert fact in last
    meter.close("done", 6, 0.006)
    assert capsys.readouterr().out == "done: t = 0.006 s, 6 steps in 6.0 s, 1 k particle-steps/s\n"


def test_a_failed_run_ends_its_line_once(clock, capsys):
    with pytest.raises(ZeroDivisionError), progress.Progress(0.0, 1.0) as meter:
        run(meter, clock, 2)
        raise ZeroDivisionError
    assert capsys.readouterr().out.splitlines()[-1].startswith("failed: t = 0.002 s")
    with progress.Progress(0.0, 1.0) as meter:
        clock.now += 1.0
        meter.close("done")
    assert capsys.readouterr().out.count("\n") == 1


@pytest.mark.parametrize("columns", [50, 80, 140])
def test_on_a_terminal_one_line_renews_itself_and_the_cursor_stays(columns, clock, capsys, monkeypatch):
    monkeypatch.setattr(launch, "terminal", lambda: columns)
    meter = progress.Progress(0.0, 1.0)
    run(meter, clock, 20)
    shown = capsys.readouterr().out
    assert "\n" not in shown and "\x1b[?25l" not in shown
    lines = [re.sub(r"\x1b\[[0-9;]*[mK]", "", line) for line in shown.split("\r") if "━" in line]
    assert len(lines) == 20 and "t = 0.0200 of 1 s" in lines[-1]
    assert max(map(len, lines)) <= columns
    assert ("step 20" in lines[-1]) == (columns == 140)


def test_a_call_with_nothing_due_is_cheap():
    meter = progress.Progress(0.0, 1.0)
    meter.due = float("inf")
    best = min(_seconds(meter, 10_000) for _ in range(5))
    assert best / 10_000 < 2e-6


def _seconds(meter, calls):
    began = time.perf_counter()
    for step in range(calls):
        meter.step(step, 0.1, 1e-4, 100_000)
    return time.perf_counter() - began


def test_words():
    words = [progress.duration(s) for s in (4.2, 60, 125, 3599, 7700, 86400, 4e5)]
    assert words == ["4.2 s", "1 min 00 s", "2 min 05 s", "59 min 59 s", "2 h 08 min", "24 h 00 min", "4 d 15 h"]
    assert [progress.quantity(n) for n in (950, 12345, 1.24e6, 3e9)] == ["950", "12.3 k", "1.24 M", "3 G"]


def test_a_run_outlives_its_terminal(clock, tmp_path, monkeypatch):
    with open(tmp_path / "log", "w") as log, open("/dev/full", "w") as full:
        monkeypatch.setattr("sys.stdout", log)
        before = progress.Progress(0.0, 1.0)
        os.dup2(full.fileno(), log.fileno())
        run(before, clock, 250)
        before.close("done")
        log.write("what waits is no fault either\n")
