"""The benchmark: what it measures, what it says, and the cost model that is fitted to it."""

import json

import numpy as np
import pytest
from clouds import cloud, listed

from parsim import bench
from parsim.__main__ import main
from parsim.bench import account, cases, limits, model, worker
from parsim.case.model import parse
from parsim.machine.timers import Timers

NUMBERS = (
    "kernel_ns_per_pair",
    "step_rate_31",
    "step_rate_21",
    "ranks_efficiency",
    "threads_efficiency",
    "imbalance",
    "bytes_per_particle",
    "start_warm_s",
    "start_cold_s",
)
SMALL = {"case": cases.still_water(1000, 2.1), "warm": 1, "steps": 3}


def pretended(order, ranks=1, threads=1, environment=None):
    """Figures of a machine that makes a million particle-steps a second, twice that on two cores, and half in 3.1."""
    if "settle" in order:
        return {"bodies": 10_000, "touching": 2.6, "substeps": 2000, "wall_s": 5.0, "rate": 4e6}
    speed = 1e6 * (0.5 if order["case"]["water"]["scheme"]["support"] > 3 else 1.0) * ranks * threads
    sweeps = {"momentum": 3.0, "continuity": 2.0, "listed": 1.4}
    return {
        "rate": speed,
        "wall_s": 2.0,
        "phases": {"momentum": 1.5, "halo": 0.1},
        "steps": 9,
        "fluid": 10**6,
        "active": 2 * 10**6,
        "bytes": 800.0,
        "peak_bytes": 900.0,
        "uneven": 1.01,
        "uneven_most": 1.02,
        "work": 1e6,
        "kernels": sweeps,
        "first_step": 30.0 if environment else 13.0,
        "launched": 10.0,
        "halo": 10,
    }


@pytest.mark.parametrize("case", [
    cases.still_water(8000, 3.1), cases.sea(10_000, 3.1), cases.dam_break(0.005, 2.1, 1.0),
    cases.dam_break(0.003, 3.1, 1.0, 0.3, 0.099), cases.floating_blocks(0.005, 3.1), cases.heap(4),
    *(model.trough(*size) for size in model.TROUGHS),
])  # fmt: skip
def test_the_cases_are_valid(case):
    assert parse(case).dimensions == 3


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.long)])
def test_a_measurement_counts_what_it_ran(ranks):
    found = account.measured(SMALL | {"record": True}, ranks)
    assert found["fluid"] == 1000 and found["steps"] == 3 and found["work"] == 3 * found["active"]
    assert found["rate"] == pytest.approx(found["work"] / found["wall_s"])
    assert sum(found["phases"].values()) < found["wall_s"] and found["phases"]["momentum"] > 0
    assert found["uneven_most"] >= 1.0 and found["first_step"] > found["launched"]
    assert (found["halo"] > 0) == (ranks > 1)


@pytest.mark.long
def test_a_heap_of_balls_is_measured_by_bodies_and_sub_steps():
    found = account.measured({"case": cases.heap(4), "settle": 0.01, "steps": 3})
    assert found["bodies"] == 80 and found["substeps"] >= 3
    assert found["rate"] == pytest.approx(80 * found["substeps"] / found["wall_s"])


def test_a_measurement_that_fails_says_why():
    with pytest.raises(account.BenchError, match="spacing"):
        account.measured({"case": SMALL["case"] | {"spacing": -1.0}})


def test_single_sweeps_are_timed_per_true_pair():
    from parsim.domain.comm import Comm
    from parsim.run.simulation import Simulation

    found = limits.sweeps(Simulation(parse(SMALL["case"]), Comm()), 1)
    assert {"momentum", "continuity", "gathers", "lists", "momentum_in_cache"} < set(found)
    assert min(found.values()) > 0 and found["listed"] > 1.2
    assert set(worker._kernels(Simulation(parse(SMALL["case"]), Comm()))) == set(found)


def test_true_pairs_and_gathers_against_plain_sums():
    size, radius = np.array([1.0, 0.8, 0.6]), 0.25
    domain, near = listed(cloud(300, size, seed=3, walls=50), size, radius)
    p, count, total = domain.particles, np.zeros(350), np.zeros(350)
    limits.true_pairs(near.fluid, near.lists, p.place, 0.2**2, count)
    fields = *p.place, *p.velocity, p.n, p.scale
    limits.gathers(near.fluid, near.lists, *p.kinematics, p.n, p.scale, total)
    for i in near.fluid:
        row = near.index[near.start[i] : near.end[i]]
        r = np.sqrt((p.x[row] - p.x[i]) ** 2 + (p.y[row] - p.y[i]) ** 2 + (p.z[row] - p.z[i]) ** 2)
        assert count[i] == (r < 0.2).sum()
        assert total[i] == pytest.approx(sum(field[row].sum() for field in fields))


def test_the_account_holds_the_figures_and_tells_ratios_first(monkeypatch, capsys):
    monkeypatch.setattr(account, "measured", pretended)
    assert main(["bench", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [found[name] for name in NUMBERS] == [3.0, 5e5, 1e6, 1.0, 1.0, pytest.approx(0.02), 800.0, 3.0, 20.0]
    assert main(["bench"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0].split("  ")[0] == "two ranks against one" and "1.000 of twice" in told[0]
    assert any(line.split() == ["momentum", "75.0", "75.0", "75.0"] for line in told), "shares of the step"
    assert any("a heap of balls" in line and "4,000,000 bodies x sub-steps/s" in line for line in told)
    assert any("floating_blocks" in line and "500,000" in line and "1,000,000" in line for line in told)


def test_the_model_finds_the_costs_that_made_its_data():
    rng = np.random.default_rng(2)
    runs = [
        {"ranks": ranks, "active": int(active), "halo": int(halo)}
        for ranks in model.RANKS
        for active, halo in rng.integers(1000, 90_000, (4, 2))
    ]
    for run in runs:
        run["step_s"] = float(model._terms(run, 2) @ [6e-7, 2e-7, 1e-4])
    found = model.fit(runs, 2)
    assert [found[name] for name in ("sweep", "halo", "switch")] == pytest.approx([6e-7, 2e-7, 1e-4])
    assert found["error"] < 1e-9
    for run in runs:
        run["step_s"] = float(model._terms(run, 2) @ [6e-7, -1e-8, 1e-4])
    assert model.fit(runs, 2)["halo"] == 0.0, "no cost is negative"


def test_the_model_predicts_where_slabs_stop():
    costs = {"sweep": 6e-7, "halo": 3e-7, "switch": 1e-4}
    long, short = (model.predict(shape, 10**8, costs) for shape in model.SHAPES)
    assert 1 < short["ranks"] < long["ranks"] < long["most_ranks"]
    shape = model.SHAPES["tank, 4 : 1 : 1"]
    one, two, three = (model.step_time(10**7, shape, ranks, 8, costs) for ranks in (1, 2, 3))
    assert one > two > three and one == pytest.approx(6e-7 * 10**7 / 8)
    told = list(
        model.lines(
            {
                "costs": costs | {"error": 0.1},
                "link": model.NETWORK | {"reduce": 1e-6},
                "runs": [],
                "predictions": [long, short],
            }
        )
    )
    assert "0.600 us per active particle" in told[0] and told[-1].startswith("tank")


def test_a_phase_inside_another_is_not_counted_twice(monkeypatch):
    now = iter([0.0, 0.0, 1.0, 4.0, 6.0, 10.0, 11.0])
    monkeypatch.setattr("parsim.machine.timers.time.perf_counter", lambda: next(now))
    timers = Timers()
    with timers("sweep"), timers("halo"):
        pass
    with timers("halo"):
        pass
    assert timers.seconds == {"halo": 4.0, "sweep": 3.0}


def test_the_command_for_the_model(monkeypatch, capsys):
    monkeypatch.setattr(bench.model, "fitted", lambda tell: {"costs": {"sweep": 1.0}})
    assert main(["bench", "--model", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"costs": {"sweep": 1.0}}
