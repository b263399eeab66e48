"""Filters of sensors: what they let through, over every step, and on from a checkpoint."""

import json
import math
import time as clock

import numpy as np
import pytest
from flows import simulation, tank

from parsim.case.model import parse
from parsim.errors import InputError
from parsim.observe.filters import Filters, LowPass, Mean
from parsim.observe.forces import Forces
from parsim.observe.probes import Probes

MEAN, LOW = {"kind": "mean", "over": 0.004}, {"kind": "low_pass", "cutoff": 30.0}
PROBE = {"kind": "pressure", "name": "p", "x": 0.0, "z": 0.02}
PATCH = {"kind": "force", "name": "f", "wall": "z_min"}


def fed(memory, steps, signal):
    """The filter of one number that has seen `signal` of time over `steps`, s."""
    for time, dt in zip(np.cumsum(steps), steps, strict=True):
        memory.see(dt, np.array([signal(time)]))
    return memory


def test_a_mean_is_over_its_time_whatever_the_steps():
    steps = np.random.default_rng(1).uniform(0.5e-3, 1.5e-3, 400)
    end = steps.sum()
    (value,) = fed(Mean(kind="mean", over=0.1).memory(), steps, lambda time: 3.0 * time).value()
    assert value == pytest.approx(3.0 * (end - 0.05), abs=3.0 * 1.5e-3)
    first = fed(Mean(kind="mean", over=0.1).memory(), [0.01, 0.03], lambda time: 2.0 if time < 0.02 else 6.0)
    assert first.value() == pytest.approx([5.0]), "of what there is so far"


def test_a_mean_counts_of_its_oldest_step_what_is_within():
    seen = fed(Mean(kind="mean", over=0.25).memory(), [0.1] * 4, lambda time: round(10.0 * time))
    assert seen.value() == pytest.approx([(0.1 * 4 + 0.1 * 3 + 0.05 * 2) / 0.25])
    assert len(seen.kept()) == 3


def test_a_low_pass_halves_the_power_of_its_frequency():
    dt, cutoff = 1e-5, 40.0
    memory, values = LowPass(kind="low_pass", cutoff=cutoff).memory(), []
    for k in range(20000):
        memory.see(dt, np.array([math.sin(2.0 * math.pi * cutoff * dt * k)]))
        values.append(memory.value()[0])
    assert max(values[-5000:]) == pytest.approx(math.sqrt(0.5), rel=1e-3)


@pytest.mark.parametrize("table", [Mean(**MEAN), LowPass(**LOW)])
def test_it_goes_on_from_what_it_kept_through_json(table):
    one, two = table.memory(), table.memory()
    fed(one, [1e-3] * 9, math.sin)
    two.restore(json.loads(json.dumps(one.kept())))
    for each in (one, two):
        fed(each, [1.1e-3] * 5, math.cos)
    assert one.value().tobytes() == two.value().tobytes()


def test_sensors_are_filtered_over_all_steps_and_say_so():
    sensors = [PROBE, PROBE | {"name": "q", "filter": MEAN}, PATCH | {"filter": LOW}, PATCH | {"name": "g"}]
    s = simulation(tank(0.2, 0.1, 0.01, fill=(0.2, 0.05)), output={"sensors": sensors})
    probes, forces, read = Probes(s.case), Forces(s.case), []
    for _ in range(12):
        s.step()
        for each in (probes, forces):
            each.see(s)
        read.append((s.dt, probes.rows(s)[0][-1]))
    plain, smooth = probes.rows(s)
    dt, values = np.array(read)[::-1].T
    share = np.clip(0.004 - (np.cumsum(dt) - dt), 0.0, dt)
    assert (plain[1], smooth[1]) == ("none", "mean 0.004 s") and plain[-1] == values[0]
    assert smooth[-1] == pytest.approx((share * values).sum() / 0.004)
    rows = forces.rows(s)
    assert [row[1] for row in rows] == ["low_pass 30 Hz"] * 2 + ["none"] * 2
    assert rows[0][-1] != rows[2][-1] and rows[0][-1] == pytest.approx(rows[2][-1], rel=0.05)


def test_before_it_has_seen_anything_there_is_what_is_read():
    case = parse(tank(0.2, 0.1, 0.01) | {"output": {"sensors": [PROBE | {"filter": LOW}]}})
    assert Filters(case.output.sensors).applied(np.array([[3.0]])) == [[3.0]]


@pytest.mark.parametrize(("wrong", "said"), [
    ({"kind": "mean"}, "filter.over: missing"),
    ({"kind": "mean", "over": 0.0}, "filter.over = 0.0: must be greater than 0"),
    ({"kind": "low_pass", "cutoff": -1.0}, "filter.cutoff = -1.0: must be greater than 0"),
    ({"kind": "butter"}, "filter"),
])  # fmt: skip
def test_a_wrong_filter_is_told(wrong, said):
    with pytest.raises(InputError) as error:
        parse(tank(0.2, 0.1, 0.01) | {"output": {"sensors": [PROBE | {"filter": wrong}]}})
    assert said in str(error.value)


def test_a_mean_over_no_time_is_the_last_value():
    assert fed(Mean(kind="mean", over=1e-30).memory(), [1e-3] * 3, lambda time: time).value() == pytest.approx([3e-3])


def test_a_mean_over_many_steps_costs_no_more_for_each():
    memory, began = Mean(kind="mean", over=1.0).memory(), clock.process_time()
    for _ in range(30000):
        memory.see(1e-4, np.zeros(1))
    assert clock.process_time() - began < 3.0, "20 s where each step adds up all that is held"
    assert len(memory.kept()) in (10000, 10001)
