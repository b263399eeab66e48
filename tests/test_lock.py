"""The lock of an output folder: who has it, when it is void, what becomes of a job that has lost it."""

import os
import threading
import time

import pytest

import parsim
from parsim.output import lock


@pytest.fixture
def elsewhere(tmp_path):
    """The lock of a job on another machine."""
    path = tmp_path / lock.NAME
    path.write_text('{"host": "elsewhere", "process": 1}')
    return path


def test_the_lock_of_another_machine_is_void_when_it_is_old(elsewhere):
    folder = elsewhere.parent
    assert lock.held(folder)
    long_ago = time.time() - lock.STALE - 1.0
    os.utime(elsewhere, (long_ago, long_ago))
    ours = lock.Lock(folder)
    ours.take()
    assert lock.held(folder) and ours.mine
    ours.release()
    assert not elsewhere.exists() and not lock.held(folder) and not ours.mine


def test_a_lost_machine_is_waited_for_no_longer_than_it_may_be_silent(elsewhere, monkeypatch, capsys):
    monkeypatch.setattr(lock, "STALE", 0.6)
    monkeypatch.setattr(lock, "LOOK", 0.1)
    begin = time.monotonic()
    lock.Lock(elsewhere.parent).take()
    assert 0.4 < time.monotonic() - begin < 2.0
    assert "locked by another job (host elsewhere, process 1); waiting up to 0.6 s" in capsys.readouterr().out


def test_a_job_on_another_machine_that_lives_keeps_its_lock(elsewhere, monkeypatch):
    monkeypatch.setattr(lock, "LOOK", 0.1)
    threading.Timer(0.25, os.utime, [elsewhere]).start()
    with pytest.raises(parsim.errors.InputError, match="host elsewhere, process 1"):
        lock.Lock(elsewhere.parent).take()
    assert elsewhere.read_text().startswith('{"host": "elsewhere"')


def test_a_job_taken_for_dead_ends_when_it_wakes_and_touches_nothing(tmp_path, monkeypatch):
    ours = lock.Lock(tmp_path)
    ours.take()
    ours.beat()
    monkeypatch.setattr(lock, "BEAT", 0.0)
    ours.beat()
    ours.path.write_text('{"host": "elsewhere", "process": 1}')
    with pytest.raises(parsim.errors.RunError, match="another job has taken"):
        ours.beat()
    ours.release()
    assert "elsewhere" in ours.path.read_text() and not ours.mine
