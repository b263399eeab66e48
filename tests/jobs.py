"""Jobs that tests disturb: parsim as a process or under mpirun, watched by what it writes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import parsim
from parsim.launch import mpirun

CASE = Path(__file__).with_name("survive.toml")
PATIENCE = 120.0


class Job:
    """`parsim WORDS` on `ranks` ranks, by `parsim -n` or, `bare`, by mpirun itself."""

    def __init__(self, words, ranks=1, bare=False, log=None, program=("-m", "parsim")):
        line = [sys.executable, *program, *map(str, words)]
        if bare:
            line = mpirun.command(ranks, line)
        elif ranks > 1:
            line += ["-n", str(ranks)]
        self.log = open(log, "a+") if log else subprocess.DEVNULL
        self.process = subprocess.Popen(
            line,
            env=mpirun.environment(),
            stdin=subprocess.DEVNULL,
            stdout=self.log,
            stderr=self.log,
            start_new_session=True,
        )

    def until(self, happened, pause=0.02):
        """Wait until `happened()`, asked after pauses, s, that leave the job its core; it must not end before."""
        begin = time.monotonic()
        while not happened():
            time.sleep(pause)
            assert self.process.poll() is None, f"ended early with {self.process.returncode}: {self.said()}"
            assert time.monotonic() - begin < PATIENCE, self.said()

    def end(self):
        """Wait for the end: exit code."""
        return self.process.wait(PATIENCE)

    def said(self):
        """What it has printed."""
        if self.log == subprocess.DEVNULL:
            return ""
        self.log.seek(0)
        return self.log.read()

    def ranks(self):
        """Process numbers of the ranks, by rank."""
        found = {}
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                if os.getsid(int(folder.name)) != self.process.pid:
                    continue
                variables = (folder / "environ").read_bytes().split(b"\0")
            except OSError:
                continue
            for variable in variables:
                if variable.startswith(b"OMPI_COMM_WORLD_RANK="):
                    found[int(variable.split(b"=")[1])] = int(folder.name)
        return found

    def left(self):
        """Number of processes of the job that are still there, but for those that only wait to be buried."""
        lines = subprocess.run(["ps", "-eo", "sid,stat"], capture_output=True, text=True).stdout.split("\n")[1:]
        rows = [line.split() for line in lines if line]
        return sum(sid == str(self.process.pid) and not stat.startswith("Z") for sid, stat in rows)

    def close(self):
        """End whatever is left."""
        subprocess.run(["pkill", "-KILL", "-s", str(self.process.pid)])
        self.process.wait()


def time_of(out):
    """Time that the series of an output folder have come to, s; -1 before there are any."""
    try:
        return parsim.open(out).series("energy")["time"][-1]
    except (parsim.errors.InputError, IndexError, ValueError):
        return -1.0


def gone(job, seconds=5.0):
    """Whether no process of the job is left within `seconds`."""
    begin = time.monotonic()
    while job.left() and time.monotonic() - begin < seconds:
        time.sleep(0.05)
    return not job.left()


def send(job, number):
    """Send a signal to the process that was started."""
    os.kill(job.process.pid, number)


KILL, TERM, USR1, STOP = signal.SIGKILL, signal.SIGTERM, signal.SIGUSR1, signal.SIGSTOP
