"""The measurements of the benchmark, each a job of its own, one after another; what is compared takes turns."""

import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

from parsim.bench import cases
from parsim.launch import mpirun
from parsim.machine import variant
from parsim.machine.processor import processor

SUPPORTS = (3.1, 2.1)
SIZES = (10_000, 30_000, 100_000, 300_000, 1_000_000, 2_000_000)
_MANY = 1_000_000
_WORK = 3e6  # particle-steps of one measurement, about
_CYCLE = 20  # steps: what is measured in still water is a whole number of rebuilds
_TURNS = 3
_EDGE, _SETTLED = 20, 0.9  # balls along a heap of 10,000, and s after which it is at rest
_SPEED = 1.0  # m/s of the water that crosses the cut


class BenchError(Exception):
    """A measurement did not end well; carries what it said."""


def measured(
    order: dict[str, Any], ranks: int = 1, threads: int = 1, environment: dict[str, str] | None = None
) -> dict[str, Any]:
    """Figures of one order of `parsim.bench.worker`, and `launched`, the time at which its job was started, s."""
    words = [sys.executable, "-P", "-m", "parsim.bench.worker", json.dumps(order)]
    line = words if ranks == 1 else mpirun.command(ranks, words)
    variables = (environment or mpirun.environment()) | {"NUMBA_NUM_THREADS": str(threads)}
    began = time.time()
    ran = subprocess.run(line, env=variables, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if ran.returncode:
        raise BenchError(f"{ran.stdout[-1000:]}{ran.stderr[-3000:]}")
    return json.loads(ran.stdout.strip().splitlines()[-1]) | {"launched": began, "ranks": ranks, "threads": threads}


def everything(tell: Callable[[str], object]) -> dict[str, Any]:
    """All figures of this machine, as a dict that JSON can hold; `tell` (a function of a line) hears what is next."""
    tell("start-up, cold and warm")
    cold, warm = start_up()
    tell("sweeps")
    kernels = {str(support): _kernels(support) for support in SUPPORTS}
    table = rates(tell)
    tell("one rank against two, one thread against two")
    ranks, threads = paired({"one": (1, 1), "ranks": (2, 1), "threads": (1, 2)})
    balance = {str(count): _balance(count, tell) for count in (2, 4)}
    sizes = [_size(count, tell) for count in SIZES]
    tell("a heap of balls")
    heap = measured({"case": cases.heap(_EDGE), "settle": _SETTLED, "steps": 10})
    tell("memory")
    memory = measured({"case": cases.still_water(_MANY, SUPPORTS[0]), "warm": 3, "steps": _CYCLE})
    lowest = {support: min(row[str(support)]["rate"] for row in table.values()) for support in SUPPORTS}
    each = kernels[str(SUPPORTS[0])]
    return {
        "kernel_ns_per_pair": max(each["momentum"], each["continuity"]),
        "step_rate_31": lowest[3.1],
        "step_rate_21": lowest[2.1],
        "ranks_efficiency": ranks,
        "threads_efficiency": threads,
        "imbalance": balance["2"]["most"],
        "bytes_per_particle": memory["bytes"],
        "peak_bytes_per_particle": memory["peak_bytes"],
        "start_warm_s": warm,
        "start_cold_s": cold,
        "machine": _machine(),
        "kernels": kernels,
        "cases": table,
        "balance": balance,
        "sizes": sizes,
        "heap": heap,
    }


def start_up() -> tuple[float, float]:
    """Seconds from the start of a job of two ranks to the end of its first step: with empty caches, and with full."""
    order = {"case": cases.floating_blocks(0.005, 3.1), "warm": 0, "steps": 1}
    with tempfile.TemporaryDirectory() as empty:
        bare = {key: text for key, text in mpirun.environment().items() if key not in ("NUMBA_CACHE_DIR", variant.NAME)}
        cold = measured(order, 2, environment=bare | {"XDG_CACHE_HOME": empty})
    warm = [measured(order, 2) for _ in range(_TURNS + 1)][1:]  # the first one may have had to compile here too
    return _waited(cold), statistics.median(_waited(one) for one in warm)


def _waited(figures):
    return figures["first_step"] - figures["launched"]


def _kernels(support):
    return measured({"case": cases.still_water(50_000, support), "warm": 12, "steps": 1, "kernels": True})["kernels"]


def rates(tell: Callable[[str], object]) -> dict[str, dict[str, Any]]:
    """Rate and phases of each case at each support, on one core."""
    made: dict[str, Callable[[float], dict[str, Any]]] = {
        "still_water": lambda support: {"case": cases.still_water(50_000, support)},
        "dam_break": lambda support: {"case": cases.dam_break(0.005, support, _SPEED), "warm": 30},
        "floating_blocks": lambda support: {"case": cases.floating_blocks(0.005, support), "record": True},
    }
    table = {}
    for name, order in made.items():
        tell(name.replace("_", " "))
        table[name] = {str(support): measured(order(support) | {"steps": 3 * _CYCLE}) for support in SUPPORTS}
    return table


def paired(ways: dict[str, tuple[int, int]], case: dict[str, Any] | None = None, steps: int = 100) -> list[float]:
    """Efficiency of every way but the first: name -> (ranks, threads), on two cores against one; best of some turns.

    Water runs across the cut all the time.
    """
    order = {"case": case or cases.dam_break(0.003, 3.1, _SPEED, 0.3, 0.099), "warm": 10, "steps": steps}
    turns = [{name: measured(order, *way)["rate"] for name, way in ways.items()} for _ in range(_TURNS)]
    best = {name: max(turn[name] for turn in turns) for name in ways}
    first, *others = ways
    return [best[name] / best[first] / (ways[name][0] * ways[name][1]) for name in others]


def _balance(ranks, tell):
    tell(f"a dam break on {ranks} ranks, to see how even their work stays")
    run = measured({"case": cases.dam_break(0.005, 3.1), "warm": 0, "until": 0.5}, ranks)
    return {"mean": run["uneven"] - 1.0, "most": run["uneven_most"] - 1.0, "steps": run["steps"], "fluid": run["fluid"]}


def _size(count, tell):
    tell(f"{count:,} particles")
    steps = _CYCLE * max(1, round(_WORK / count / _CYCLE))
    return measured({"case": cases.sea(count, SUPPORTS[0]), "warm": 3, "steps": steps})


def _machine():
    return {
        "host": platform.node(),
        "processor": processor(),
        "cores": mpirun.cores(),
        "memory_bytes": _memory(),
        "kernel": variant.chosen(),
        "python": platform.python_version(),
        **{name: version(name) for name in ("parsim", "numba", "numpy", "mpi4py")},
    }


def _memory():
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
