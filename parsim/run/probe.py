"""Finds the kernel variant that is fastest here: each is compiled and timed in a process of its own."""

import os
import subprocess
import sys
import time
from collections.abc import Sequence

from parsim.machine import variant

_GAIN = 0.93  # share of the first variant's time that another one must stay below
_EDGE, _REACH, _CALLS = 20, 3.5, 100  # particles along the edge of the probe's lattice, its support, timed calls


def fastest() -> str:
    """Name of the fastest variant; the first possible one unless another is clearly faster."""
    names = variant.possible()
    seconds = measured(names) if len(names) > 1 else {}
    best = min(seconds, key=lambda name: seconds[name], default=names[0])
    return best if seconds.get(best, 0.0) < _GAIN * seconds.get(names[0], 0.0) else names[0]


def measured(names: Sequence[str]) -> dict[str, float]:
    """Seconds of one call of a large sweep for each of `names` that could be timed; compiled side by side."""
    started = {}
    for name in names:
        environment = os.environ | {variant.NAME: name, "NUMBA_NUM_THREADS": "1"}
        started[name] = subprocess.Popen(
            [sys.executable, "-P", "-m", "parsim.run.probe"],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
    told = {name: process.communicate()[0] for name, process in started.items()}
    return {name: float(text) for name, text in told.items() if text and not started[name].returncode}


def _seconds():
    """Least seconds of one call of the continuity sweep, compiled without threads, on a lattice."""
    import numpy as np

    from parsim.fluid import weights
    from parsim.fluid.wcmps import sweeps, tables
    from parsim.machine.jit import FAST, njit
    from parsim.particles.tables import Kinematics, Lists, Traceless, Vectors

    axis = np.arange(_EDGE, dtype=float)
    x, y, z = (a.ravel() for a in np.meshgrid(axis, axis, axis, indexing="ij"))
    reach = int(_REACH)
    offset = np.stack([a.ravel() for a in np.meshgrid(*[np.arange(-reach, reach + 1)] * 3, indexing="ij")])
    r2 = (offset**2).sum(axis=0)
    step = (offset.T @ np.array([_EDGE**2, _EDGE, 1]))[(r2 > 0) & (r2 < _REACH**2)]
    at = np.flatnonzero(np.all([(a >= reach) & (a < _EDGE - reach) for a in (x, y, z)], axis=0))
    index = (at[:, None] + step).astype(np.uint32).ravel()
    start, end = np.zeros(x.size, np.int64), np.zeros(x.size, np.int64)
    start[at] = np.arange(at.size) * step.size
    end[at] = start[at] + step.size
    fields = np.random.default_rng(1).uniform(1.0, 2.0, (8, x.size))
    growth = tables.Growth(1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.9, 3.0)
    rate, *out = np.zeros((12, x.size))
    arguments = (
        at,
        Lists(start, end, end, index),
        Kinematics(Vectors(x, y, z), Vectors(*fields[:3])),
        tables.Density(fields[3], fields[4], np.full(x.size, -1, np.int32)),
        Vectors(*fields[5:]),
        weights.WEIGHTS["wendland_c4"].of_radius(3.1),
        growth,
        tables.Change(rate, Vectors(*out[:3]), Vectors(*out[3:6]), Traceless(*out[6:])),
    )
    sweep = njit(sweeps.continuity.py_func, error_model="numpy", nogil=True, fastmath=FAST)
    times = []
    for _ in range(_CALLS):
        begin = time.perf_counter()
        sweep(*arguments)
        times.append(time.perf_counter() - begin)
    return min(times)


if __name__ == "__main__":
    print(_seconds())
