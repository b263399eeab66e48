"""A run to its end: steps until the time is up, kept and watched; or until it has to stop."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from parsim.domain.comm import Comm
from parsim.domain.grid import check_ranks
from parsim.errors import RunError
from parsim.geometry.faces import repeats
from parsim.launch import mpirun
from parsim.launch.stop import STOPPED, Stop
from parsim.launch.watch import Watch
from parsim.output.folder import Folder
from parsim.run.checkpoints import Keeper
from parsim.run.recorder import Recorder
from parsim.run.simulation import Simulation

if TYPE_CHECKING:
    from parsim.case.model import Case
    from parsim.run.resume import Found


def run(case: Case, source: Path | str, out: Path | str, force: bool = False, walltime: float | None = None) -> int:
    """Run a case, read from the file `source`, to its end and write everything to the folder `out`.

    `walltime`, s: of the job. Returns 0, or 75 when the run was stopped before its end and has left a checkpoint.
    Raises InputError for what the case cannot do on this many ranks, WriteError where nothing can be written.
    """
    with Folder(out, _comm(case)) as folder:
        folder.make(case, source, force)
        return _advance(case, folder, Path(source).stem, walltime)


def resume(found: Found, folder: Folder, walltime: float | None = None) -> int:
    """Go on with what `parsim.run.resume` has found in a Folder that is taken; as `run`."""
    folder.comm = comm = _comm(found.case)
    account = snapshot = None
    if found.checkpoint:
        account = found.checkpoint.account
        snapshot = found.checkpoint.snapshot(found.case.water.scheme.fields, comm.rank, comm.size)
    folder.reopen(found.case, account)
    return _advance(found.case, folder, found.name, walltime, account, snapshot)


def _comm(case):
    comm = Comm(repeats(case)[0])
    mpirun.check(comm.size)
    check_ranks(case, comm.size)
    return comm


def _advance(case, folder, name, walltime, account=None, snapshot=None):
    comm = folder.comm
    with Watch(comm, case.run.patience), Recorder(case, folder, name, account) as recorder, Stop(walltime) as stop:
        simulation = Simulation(case, comm, snapshot)
        recorder.begin(simulation)
        keeper = Keeper(case, recorder, stop, simulation)
        while simulation.time < case.run.until:
            if simulation.rebuilds_next():
                reason = keeper.look(simulation)
                if reason:
                    recorder.stopped(simulation, reason)
                    return STOPPED
            _step(simulation, recorder)
            recorder.watch(simulation)
        keeper.finish()
        recorder.finish(simulation)
    return 0


def _step(simulation, recorder):
    try:
        simulation.step()
    except RunError:
        recorder.fault(simulation)
        raise
