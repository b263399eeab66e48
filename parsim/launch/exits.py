"""How a command ends: exit codes, one message for all ranks, and no rank left behind."""

import sys
import time
import traceback
from collections.abc import Callable

from parsim.errors import InputError, RunError, WriteError

DONE, FAILED, BAD_INPUT, CANNOT_WRITE, INTERRUPTED = 0, 1, 2, 74, 130


def code_of(work: Callable[[], int | None]) -> int:
    """Exit code of `work`, a function without arguments that returns a code or None; errors are told and counted."""
    from parsim.launch.mpirun import world

    rank, size = world()
    try:
        return work() or DONE
    except InputError as error:
        if rank == 0:
            print(*(f"error: {message}" for message in error.messages), sep="\n", file=sys.stderr, flush=True)
        return _together(BAD_INPUT)
    except RunError as error:
        if rank == 0:
            print(f"error: {error}", file=sys.stderr, flush=True)
        return _together(FAILED)
    except WriteError as error:
        if rank == 0 or not error.shared:
            print(f"error: {error}", file=sys.stderr, flush=True)
        return _together(CANNOT_WRITE)
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        raise  # the reader of a pipe has left: the command line ends quietly
    except Exception:
        print(f"error: rank {rank} of {size} failed", file=sys.stderr)
        traceback.print_exc()
        return _abort(FAILED)


def _world():
    """The world communicator if MPI is running here with several ranks, else None."""
    mpi = sys.modules.get("mpi4py.MPI")
    return mpi.COMM_WORLD if mpi and mpi.Is_initialized() and mpi.COMM_WORLD.Get_size() > 1 else None


def _together(code, patience=2.0):
    """Return `code` once every rank is about to end; end the job if one is not, for it would wait for this one."""
    world = _world()
    if world:
        everyone, start = world.Ibarrier(), time.monotonic()
        while not everyone.Test():
            if time.monotonic() - start > patience:
                return _abort(code)
            time.sleep(0.01)
    return code


def _abort(code):
    """End all ranks at once; a rank that fails alone would leave the others waiting for ever."""
    world = _world()
    if world:
        sys.stdout.flush()
        sys.stderr.flush()
        world.Abort(code)
    return code
