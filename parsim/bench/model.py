"""The cost model of a step, fitted to measurements, and what it predicts where slabs are many.

On R ranks of h threads a step takes

    T = sweep A / (R h) + halo H + 6 (latency + bytes H / (2 bandwidth)) + 2 log2(R) latency

with A the active particles of all ranks and H the halo particles of one: 3 exchanges a step with each of 2 neighbours,
2 all-reduces. `sweep` and `halo` are fitted by least squares to runs on 1 to 8 ranks, more than there are cores, where
C cores do the work of R ranks; `switch` is what each rank beyond the cores adds to every message there.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from parsim.bench.account import measured
from parsim.launch import mpirun

RANKS = (1, 2, 4, 8)
TROUGHS = ((96, 12, 12), (96, 24, 16), (192, 16, 16))  # particles along x, y, z of the fitted runs
SHAPES = {"channel, 40 : 4 : 1": (40, 4, 1), "tank, 4 : 1 : 1": (4, 1, 1)}
COUNTS = (10**7, 10**8, 10**9)
NETWORK = {"latency": 2e-6, "bandwidth": 10e9}  # s, bytes/s between nodes: assumed for the predictions
HALO_BYTES = 19 * 8  # of one halo particle in one step
_LAYERS = 3.5  # spacings of one halo
_STEPS, _EFFICIENT = 40, 0.7


def fitted(tell: Callable[[str], object]) -> dict[str, Any]:
    """Measure and fit; returns coefficients, the runs they come from with the model's time, and predictions."""
    link = measured({"case": trough(*TROUGHS[0]), "messages": True}, min(2, mpirun.cores()))["messages"]
    runs = []
    for size in TROUGHS:
        for ranks in RANKS:
            tell(f"{size[0] * size[1] * size[2]:,} particles on {ranks} ranks")
            run = measured({"case": trough(*size), "warm": 5, "steps": _STEPS}, ranks)
            runs.append(
                {"ranks": ranks, "active": run["active"], "halo": run["halo"], "step_s": run["wall_s"] / run["steps"]}
            )
    costs = fit(runs, mpirun.cores())
    for run in runs:
        run["model_s"] = float(_terms(run, mpirun.cores()) @ [costs["sweep"], costs["halo"], costs["switch"]])
    return {
        "costs": costs,
        "link": link,
        "runs": runs,
        "predictions": [predict(shape, count, costs) for shape in SHAPES for count in COUNTS],
    }


def trough(along: int, across: int, deep: int) -> dict[str, Any]:
    """Water that runs along a periodic trough, `along` x `across` x `deep` particles."""
    l0 = 0.01
    size = [round(n * l0, 9) for n in (along, across, deep)]
    box = {"max": [*size[:2], round(size[2] + 5 * l0, 9)], "faces": {"x_min": "periodic", "x_max": "periodic"}}
    return {
        "dimensions": 3,
        "spacing": l0,
        "run": {"until": 100.0},
        "box": box,
        "water": {"speed": 2.0, "fill": [{"min": [0.0, 0.0, 0.0], "max": size, "velocity": [1.0, 0.0, 0.0]}]},
    }


def _terms(run, cores):
    """What `sweep`, `halo` and `switch` are multiplied with in the time of a step on `cores` cores."""
    rounds = run["ranks"] / min(run["ranks"], cores)
    return np.array([run["active"] / run["ranks"] * rounds, run["halo"] * rounds, 8.0 * (rounds - 1.0)])


def fit(runs: Sequence[Mapping[str, Any]], cores: int) -> dict[str, float]:
    """Seconds of `sweep`, `halo` and `switch`, none negative, with the least relative error over the runs."""
    rows = np.array([_terms(run, cores) / run["step_s"] for run in runs])
    names, keep = ["sweep", "halo", "switch"], [0, 1, 2]
    while True:
        found = np.linalg.lstsq(rows[:, keep], np.ones(len(rows)), rcond=None)[0]
        if (found >= 0.0).all():
            break
        keep.pop(int(found.argmin()))
    costs = dict.fromkeys(names, 0.0) | {names[k]: float(value) for k, value in zip(keep, found, strict=True)}
    return costs | {"error": float(np.sqrt(np.mean((rows[:, keep] @ found - 1.0) ** 2)))}


def step_time(count: float, shape: Sequence[float], ranks: int, threads: int, costs: Mapping[str, float]) -> float:
    """Seconds of a step of `count` particles in a block of proportions `shape` on a network; walls are left out."""
    along, section = _block(count, shape)
    halo = 2.0 * _LAYERS * section if ranks > 1 else 0.0
    messages = 6.0 * (NETWORK["latency"] + HALO_BYTES * halo / 2.0 / NETWORK["bandwidth"]) if ranks > 1 else 0.0
    reduces = 2.0 * math.log2(ranks) * NETWORK["latency"]
    return costs["sweep"] * count / (ranks * threads) + costs["halo"] * halo + messages + reduces


def _block(count, shape):
    """Particles along the block and in its cross-section."""
    unit = (count / math.prod(shape)) ** (1 / 3)
    return shape[0] * unit, shape[1] * shape[2] * unit**2


def predict(name: str, count: int, costs: Mapping[str, float], threads: int = 8) -> dict[str, Any]:
    """The most ranks at which slabs still work at 0.7 of one rank's speed, and the time of a step there."""
    along, _ = _block(count, SHAPES[name])
    alone, ranks = step_time(count, SHAPES[name], 1, threads, costs), 1
    for more in range(2, int(along / _LAYERS) + 1):
        if alone / (more * step_time(count, SHAPES[name], more, threads, costs)) < _EFFICIENT:
            break
        ranks = more
    step = step_time(count, SHAPES[name], ranks, threads, costs)
    return {
        "shape": name,
        "particles": count,
        "ranks": ranks,
        "threads": threads,
        "step_s": step,
        "most_ranks": int(along / _LAYERS),
        "core_hours_per_1e5_steps": step * 1e5 * ranks * threads / 3600,
    }


def lines(found: dict[str, Any]) -> Iterator[str]:
    """The model in words."""
    costs = found["costs"]
    yield (
        f"sweep {1e6 * costs['sweep']:.3f} us per active particle, halo {1e6 * costs['halo']:.3f} us per halo one, "
        f"switch {1e3 * costs['switch']:.2f} ms per message and rank beyond the cores; error {costs['error']:.1%}"
    )
    link = found["link"]
    yield (
        f"measured between two ranks here: {1e6 * link['latency']:.1f} us, {link['bandwidth'] / 1e9:.1f} GB/s; "
        f"all-reduce {1e6 * link['reduce']:.1f} us"
    )
    yield ""
    yield f"{'ranks':>6}{'active':>10}{'halo':>8}{'measured, ms':>14}{'model, ms':>11}"
    for run in found["runs"]:
        yield (
            f"{run['ranks']:>6}{run['active']:>10,}{run['halo']:>8,}{1e3 * run['step_s']:>14.2f}"
            f"{1e3 * run['model_s']:>11.2f}"
        )
    yield ""
    yield (
        f"predicted for {1e6 * NETWORK['latency']:g} us and {NETWORK['bandwidth'] / 1e9:g} GB/s between nodes: the "
        f"most ranks at {_EFFICIENT:g} of one rank's speed"
    )
    yield (
        f"{'shape':<22}{'particles':>15}{'ranks':>7}{'of':>7}{'x threads':>11}{'step, s':>9}"
        f"{'core-hours, 1e5 steps':>23}"
    )
    for row in found["predictions"]:
        yield (
            f"{row['shape']:<22}{row['particles']:>15,}{row['ranks']:>7}{row['most_ranks']:>7}{row['threads']:>11}"
            f"{row['step_s']:>9.3f}{row['core_hours_per_1e5_steps']:>23,.0f}"
        )
