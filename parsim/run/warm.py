"""Compiles the kernels once per machine, version and variant, in processes of their own, before any rank needs them.

Numba's machine code of a reordered sum is not the same in the process that compiled it as in those that load it from
the cache: the last bit of a result would tell a first run from a second, and one rank from another. So no run uses
code that it compiled itself, and the ranks of a cold start do not compile the same thing side by side.
"""

import fcntl
import json
import math
import os
import pickle
import subprocess
import sys
import time
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any

from parsim.errors import InputError
from parsim.launch import mpirun
from parsim.machine import variant

PARTS = "water", "solids"  # compiled side by side
PATIENCE = 900.0  # s that a rank waits for another one's compiler
_FOREIGN = ("OMPI_", "PMIX", "PMI_", "PRTE", "SLURM_")  # the compiler is no rank of the job
_LOCAL = ("OMPI_COMM_WORLD_LOCAL_RANK", "SLURM_LOCALID", "MPI_LOCALRANKID")
_CASE: dict[str, Any] = {
    "dimensions": 3, "spacing": 0.01, "box": {"max": [0.2, 0.06, 0.1]}, "run": {"until": 1.0},
    "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [0.1, 0.06, 0.05]}]},
    "gate": {"min_x": 0.1, "max_x": 0.105},
    "materials": {"wood": {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}},
    "bodies": [{"name": name, "shape": {"size": [0.03, 0.04, 0.02]}, "density": 600.0, "material": "wood",
                "position": [x, 0.03, 0.05]} for name, x in (("one", 0.03), ("two", 0.0605))],
}  # fmt: skip
_PERIODIC: dict[str, Any] = {
    "box": {"max": [0.2, 0.06, 0.1], "faces": {"y_min": "periodic", "y_max": "periodic"}},
    "gate": None,
    "bodies": [],
    "output": {"sensors": [{"name": "one", "x": 0.05}]},
}
RUBS = "wall_law", "no_slip"
OF_SPHALE = "wendland_c2", "wendland_c4"


def prepare() -> None:
    """Choose the kernel variant, if none is named yet, and return when its machine code is in the cache.

    Rank 0 chooses for all. The first rank of each machine has compiled what is missing. Raises InputError for a variant
    that this processor does not have, or other than that of the kernels which this process has loaded already.
    """
    from parsim.domain.comm import Comm

    comm = Comm()
    os.environ[variant.NAME] = variant.checked(comm.share(_chosen() if comm.rank == 0 else None))
    variant.apply()
    folder = os.environ.get("NUMBA_CACHE_DIR", "")
    if Path(folder).name != variant.code():
        raise InputError(
            f"kernel = {os.environ[variant.NAME]}: this process has loaded numba with other settings "
            "already; start parsim in a process of its own"
        )
    mark = variant.mark(folder)
    if _whole(mark):
        return
    local = next((int(os.environ[name]) for name in _LOCAL if name in os.environ), mpirun.world()[0])
    if local == 0:
        _compile(mark)
    start = time.monotonic()
    while not _whole(mark):
        if time.monotonic() - start > PATIENCE:
            raise TimeoutError(f"{mark} has not appeared in {PATIENCE:g} s: is the kernel cache shared or writable?")
        time.sleep(0.1)


def _compile(mark):
    """Compile everything, but for what another job has compiled while this one waited for it."""
    with open(mark.parent / "lock", "w") as file:
        with suppress(OSError):  # where the file system has no locks
            fcntl.flock(file, fcntl.LOCK_EX)
        if not _whole(mark):
            _compile_alone(mark)


def _compile_alone(mark):
    if mpirun.world()[0] == 0:
        reason = "the cache is damaged" if mark.exists() else "once per version"
        print(f"compiling the kernels: {reason}, about a minute", flush=True)
    for path in _code(mark.parent):  # a compiler that was killed may have left half a file
        path.unlink()
    environment = {key: text for key, text in os.environ.items() if not key.startswith(_FOREIGN)}
    # in process groups of their own: mpirun sends signals to all of a rank's
    workers = [
        subprocess.Popen(
            [sys.executable, "-P", "-m", "parsim.run.warm", part],
            env=environment,
            process_group=0,
            preexec_fn=mpirun.die_with_parent,
        )
        for part in PARTS
    ]
    for worker in workers:
        if worker.wait():
            raise subprocess.CalledProcessError(worker.returncode, worker.args)
    sums = {str(path.relative_to(mark.parent)): _sum(path) for path in _code(mark.parent)}
    draft = mark.with_suffix(f".{os.getpid()}")
    draft.write_text(json.dumps(sums), encoding="utf-8")
    draft.replace(mark)


def _whole(mark):
    """Whether the machine code that `mark` tells of is there as it was written."""
    try:
        sums = json.loads(mark.read_text(encoding="utf-8"))
        return all(_sum(Path(mark.parent, name)) == sum for name, sum in sums.items())
    except (OSError, ValueError, AttributeError):
        return False


def _sum(path):
    """Checksum of a file of machine code; of an index, to which Numba may add, only whether it can be read."""
    if path.suffix == ".nbc":
        return zlib.crc32(path.read_bytes())
    try:
        with open(path, "rb") as file:
            pickle.load(file)
            pickle.loads(file.read())
    except Exception:  # whatever a damaged pickle raises
        return None
    return 0


def _code(folder):
    return sorted(path for path in folder.rglob("*") if path.suffix in (".nbi", ".nbc"))


def _chosen():
    name = variant.chosen()
    if name is None:
        from parsim.run.probe import fastest

        print("choosing the kernel variant: once per kind of processor", flush=True)
        name = fastest()
        variant.remember(name)
    return name


def exercise(part: str) -> None:
    """Run small cases with everything in them for a few steps, which compiles and caches, or loads, every kernel.

    The parts run side by side and begin with different kernels: what one has compiled the other loads.
    """
    from parsim.case.model import parse
    from parsim.domain.comm import Comm
    from parsim.fluid.weights import WEIGHTS
    from parsim.observe.observers import rows_now
    from parsim.run.simulation import Simulation

    if part == "solids":
        _touch(parse(_CASE))
        cases = [_CASE | {"water": _CASE["water"] | {"scheme": {"weight": name}}} for name in WEIGHTS]
    else:
        rubbing = [_CASE["water"] | {"friction": {"kind": kind}, "eddies": {"kind": "mixing_length"}} for kind in RUBS]
        cases = [_CASE | {"water": rubbing[0]}, _CASE | _PERIODIC | {"water": rubbing[1]}]
        rubs = {"friction": {"kind": RUBS[0]}}
        implicit = [{"kind": "simps", "weight": name} for name in ("wendland_c2", "mps")]
        cases += [_CASE | {"water": _CASE["water"] | rubs | {"scheme": scheme}} for scheme in implicit]
        riemann = [{"kind": "sphale", "weight": name} for name in OF_SPHALE]
        cases += [_CASE | {"water": _CASE["water"] | {"scheme": scheme}} for scheme in riemann]
    for data in cases:
        case = parse(data)
        simulation = Simulation(case, Comm())
        for _ in range(3):
            simulation.step()
        rows_now(case, simulation)


def _touch(case):
    """One step of the bodies and the gate of a case without water, soft and hard, shared out or not."""
    import numpy as np

    from parsim.boundary.gate import Gate
    from parsim.domain.comm import Comm
    from parsim.domain.shares import Shares
    from parsim.solid.bodies import from_case
    from parsim.solid.contacts import Contacts
    from parsim.solid.laws.impulse import ImpulseLaw

    soft, hard, comm = case.contacts.law, ImpulseLaw.model_validate("impulse"), Comm()
    pairs, islands = Shares(comm, 0.0, 0.0), Shares(comm, 0.0, math.inf)
    for law, shares in ((soft, None), (soft, pairs), (soft, islands), (hard, pairs)):
        bodies = from_case(case)
        given = case.model_copy(update={"contacts": case.contacts.model_copy(update={"law": law})})
        contacts = Contacts(bodies, given, [Gate(case)], shares=shares)
        contacts.step(bodies, np.zeros((len(bodies), 6)), 0.0, 1e-4)
        contacts.elastic_energy()


def _save_one_at_a_time():
    """Let no other process save machine code meanwhile: numba reads an index, adds to it and writes it back."""
    from numba.core.caching import IndexDataCacheFile

    save = IndexDataCacheFile.save

    def locked(self, key, data):
        with open(Path(os.environ["NUMBA_CACHE_DIR"], "saving"), "w") as file:
            with suppress(OSError):  # where the file system has no locks
                fcntl.flock(file, fcntl.LOCK_EX)
            save(self, key, data)

    IndexDataCacheFile.save = locked


if __name__ == "__main__":
    variant.apply()
    _save_one_at_a_time()
    exercise(sys.argv[1])
