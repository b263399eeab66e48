"""Runs cases for some steps, in a process that has compiled nothing, and prints which kernels each has compiled.

Takes the number of steps. Reads a JSON list of cases from standard input, each a dict as of a case file or a list
[file, changes]; prints a JSON list, for each case the names of its kernels that numba's cache has missed.
"""

import json
import sys

from parsim.case import model as cases
from parsim.case.load import load
from parsim.domain.comm import Comm
from parsim.observe.observers import rows_now
from parsim.run import warm
from parsim.run.simulation import Simulation

from numba.core.dispatcher import Dispatcher  # isort: skip (the settings of numba must come first)


def run(case, steps):
    """Run and measure a case for some steps, then go on from a snapshot and over t = 0."""
    simulation = Simulation(case, Comm())
    for _ in range(steps):
        simulation.step()
    rows_now(case, simulation)
    simulation = Simulation(case, Comm(), simulation.snapshot())
    simulation.time = -1e-9
    simulation.step()


def missed():
    """How often numba's cache has missed for each kernel loaded so far: {name: number}."""
    modules = [module for name, module in sys.modules.items() if name.startswith("parsim.")]
    kernels = {id(item): item for module in modules for item in vars(module).values() if isinstance(item, Dispatcher)}
    return {
        f"{kernel.__module__}.{kernel.__name__}": sum(kernel.stats.cache_misses.values()) for kernel in kernels.values()
    }


def main(wanted, steps):
    """The kernels that each case has compiled: a list of lists of names."""
    told = []
    for case in wanted:
        before = missed()
        run(cases.parse(case) if isinstance(case, dict) else load(*case), steps)
        told.append([name for name, count in missed().items() if count > before.get(name, 0)])
    return told


if __name__ == "__main__":
    warm.prepare()
    print(json.dumps(main(json.load(sys.stdin), int(sys.argv[1]))))
