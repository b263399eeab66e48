"""Compiles the kernels once per machine, version and variant, in a process of its own, before any rank needs them.

Numba's machine code of a reordered sum is not the same in the process that compiled it as in those that load it from
the cache: the last bit of a result would tell a first run from a second, and one rank from another. So no run uses
code that it compiled itself, and the ranks of a cold start do not compile the same thing side by side.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

from parsim import launch, variant

PATIENCE = 900.0  # s that a rank waits for another one's compiler
_FOREIGN = ("OMPI_", "PMIX", "PMI_", "PRTE", "SLURM_")  # the compiler is no rank of the job
_LOCAL = ("OMPI_COMM_WORLD_LOCAL_RANK", "SLURM_LOCALID", "MPI_LOCALRANKID")
_CASE = {
    "dimensions": 3, "spacing": 0.01, "box": {"max": [0.2, 0.06, 0.1]}, "run": {"until": 1.0},
    "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.1, 0.06, 0.05]}]},
    "gate": {"min_x": 0.1, "max_x": 0.105},
    "materials": {"wood": {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}},
    "bodies": [{"name": name, "shape": {"size": [0.03, 0.04, 0.02]}, "density": 600.0, "material": "wood",
                "position": [x, 0.03, 0.05]} for name, x in (("one", 0.03), ("two", 0.0605))],
}  # fmt: skip


def prepare():
    """Choose the kernel variant, if none is named yet, and return when its machine code is in the cache.

    Rank 0 chooses for all. The first rank of each machine has compiled what is missing. Raises InputError for a variant
    that this processor does not have.
    """
    from parsim.comm import Comm

    comm = Comm()
    os.environ[variant.NAME] = variant.checked(comm.share(_chosen() if comm.rank == 0 else None))
    variant.apply()
    mark = _mark()
    if mark is None or mark.exists():
        return
    local = next((int(os.environ[name]) for name in _LOCAL if name in os.environ), launch.world()[0])
    if local == 0:
        if launch.world()[0] == 0:
            print("compiling the kernels: once per version, about a minute", flush=True)
        environment = {key: text for key, text in os.environ.items() if not key.startswith(_FOREIGN)}
        subprocess.run([sys.executable, "-P", "-m", "parsim.warm"], env=environment, check=True)
        mark.touch()
    start = time.monotonic()
    while not mark.exists():
        if time.monotonic() - start > PATIENCE:
            raise TimeoutError(f"{mark} has not appeared in {PATIENCE:g} s: is the kernel cache shared or writable?")
        time.sleep(0.1)


def _chosen():
    name = variant.chosen()
    if name is None:
        from parsim.probe import fastest

        print("choosing the kernel variant: once per kind of processor", flush=True)
        name = fastest()
        variant.remember(name)
    return name


def _mark():
    """The file that says that the cache is complete; None where the cache cannot be written."""
    folder = Path(os.environ.get("NUMBA_CACHE_DIR", ""))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder / f"complete-{variant.code()}" if os.access(folder, os.W_OK) else None


def exercise():
    """Run a small case with everything in it for a few steps, which compiles and caches, or loads, every kernel."""
    from parsim.case import parse
    from parsim.comm import Comm
    from parsim.output.measure import Measure
    from parsim.solver import Simulation

    case = parse(_CASE)
    simulation = Simulation(case, Comm())
    for _ in range(3):
        simulation.step()
    Measure(case, simulation).rows(simulation)


if __name__ == "__main__":
    exercise()
