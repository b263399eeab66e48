"""One measurement of the benchmark, in a process or job of its own: an order as JSON in, figures as JSON out.

The order holds `case` (a nested dict) and may hold `warm` (steps before the clock runs), `steps` or `until` (s) to
run, `kernels` (time single sweeps too), `record` (write frames and series, at the intervals of the case), `settle` (s
of bodies alone before they are timed, and nothing else is) and `messages` (time nothing but messages).
"""

import json
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from parsim.case.model import parse
from parsim.domain.comm import Comm
from parsim.geometry.faces import repeats
from parsim.run.warm import PARTS, exercise, prepare

_WARM = 5  # steps
_CALLS = 7  # of a single sweep; the fastest counts


def measure(order: dict[str, Any]) -> dict[str, Any]:
    """Run what the order asks for; returns the figures (dict), the same on all ranks but for times."""
    case = parse(order["case"])
    comm = Comm(repeats(case)[0])
    if order.get("messages"):
        return {"messages": _messages(comm)}
    prepare()
    from parsim.run.simulation import Simulation

    if order.get("warm", _WARM):
        exercise(PARTS[0])  # machine code is in memory before the particles are
    before = _resident()
    simulation = Simulation(case, comm)
    if "settle" in order:
        return _bodies(simulation, order["settle"], order["steps"])
    with tempfile.TemporaryDirectory() as folder:
        recorder = _recorder(case, comm, simulation, folder) if order.get("record") else None
        _advance(simulation, recorder, max(order.get("warm", _WARM), 1))
        first = time.time()
        figures = _timed(simulation, recorder, order)
    bytes_each = float(comm.max([_resident() - before])[0])
    owned = float(comm.max([simulation.near.fluid.size + simulation.near.boundary.size])[0])
    figures |= {"first_step": first, "bytes": bytes_each / owned, "peak_bytes": (_peak() - before) / owned}
    return figures | ({"kernels": _kernels(simulation)} if order.get("kernels") else {})


def _recorder(case, comm, simulation, folder):
    from parsim.output.folder import Folder
    from parsim.run.recorder import Recorder

    place = Folder(Path(folder) / "out", comm)
    place.make(case, "bench", False)
    recorder = Recorder(case, place)
    recorder.begin(simulation)
    return recorder


def _bodies(simulation, settle, steps):
    """Rate in bodies times sub-steps a second over some steps of bodies alone, after a time, s."""
    while simulation.time < settle:
        simulation.step()
    began, substeps = time.perf_counter(), 0
    for _ in range(steps):
        simulation.step()
        substeps += simulation.contacts.steps
    wall, count = time.perf_counter() - began, len(simulation.bodies)
    touching = simulation.contacts.count / count
    return {
        "bodies": count,
        "touching": touching,
        "substeps": substeps,
        "wall_s": wall,
        "rate": count * substeps / wall,
    }


def _advance(simulation, recorder, steps):
    for _ in range(steps):
        simulation.step()
        if recorder:
            recorder.watch(simulation)


def _timed(simulation, recorder, order):
    """Wall seconds and active particle-steps of the steps asked for, with the seconds of each phase."""
    until, steps = order.get("until", float("inf")), order.get("steps", sys.maxsize)
    earlier, began, work, count = dict(simulation.timers.seconds), time.perf_counter(), 0, 0
    rebuilds = simulation.rebuilds
    while count < steps and simulation.time < until:
        _advance(simulation, recorder, 1)
        count += 1
        work += simulation.active
    wall = time.perf_counter() - began
    phases = {name: spent - earlier.get(name, 0.0) for name, spent in simulation.timers.seconds.items()}
    return {
        "wall_s": wall,
        "work": work,
        "steps": count,
        "rate": work / wall,
        "phases": phases,
        "rebuilds": simulation.rebuilds - rebuilds,
        "active": simulation.active,
        "fluid": simulation.fluid_count,
        "all": simulation.fluid_count + len(simulation.solids.walls) + len(simulation.solids.samples),
        "halo": len(simulation.domain.particles) - simulation.domain.border.size,
        "uneven": simulation.uneven[0],
        "uneven_most": simulation.uneven[1],
    }


def _messages(comm, small=1, large=1 << 17, times=300):
    """Latency, s, and bandwidth, bytes/s, of an exchange with one neighbour, and the time of an all-reduce, s."""

    def seconds(work):
        work()
        begin = time.perf_counter()
        for _ in range(times):
            work()
        return (time.perf_counter() - begin) / times

    def exchange(size):
        arrays = [np.zeros(size) for _ in range(4)]
        return seconds(lambda: comm.exchange_fixed(*arrays))

    latency = exchange(small)
    return {
        "latency": latency / 2,
        "bandwidth": 16 * large / max(exchange(large) - latency, 1e-9),
        "reduce": seconds(lambda: comm.max([1.0])),
    }


def _resident():
    """Resident memory of this process, bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def _peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _kernels(simulation):
    """Nanoseconds of each sweep per true pair of the fluid, and of what bounds them: see `parsim.bench.limits`."""
    from parsim.bench import limits

    return limits.sweeps(simulation, _CALLS)


if __name__ == "__main__":
    figures = measure(json.loads(sys.argv[1]))
    if Comm().rank == 0:
        print(json.dumps(figures), flush=True)
