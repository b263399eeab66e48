"""A Slurm of two nodes on the loopback address, for tests: munged, slurmctld and slurmds in a folder of their own."""

import os
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

NODES = tuple(f"{name}-{os.getpid()}" for name in ("one", "two"))  # what this machine pretends to be; nobody else's
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue")
_PATH = os.environ["PATH"] + ":/usr/sbin:/sbin"
_CONFIG = """
ClusterName=parsim
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
JobRequeue=1
KillWait=5
MinJobAge=300
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0
NodeName={nodes[0]} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs={cores} State=UNKNOWN
NodeName={nodes[1]} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs={cores} State=UNKNOWN
PartitionName=all Nodes={nodes[0]},{nodes[1]} Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:4
"""


def missing():
    """Why Slurm cannot be started here, "" when it can."""
    if os.geteuid():
        return "only root may start Slurm's daemons"
    absent = [name for name in PROGRAMS if not shutil.which(name, path=_PATH)]
    return f"not installed: {', '.join(absent)}" if absent else ""


class Slurm:
    """Started when it is made, in `folder`; `close` ends it. `environment` is what its commands need."""

    def __init__(self, folder):
        self.folder, self._daemons = Path(folder), []
        host = socket.gethostname().split(".")[0]
        (self.folder / "state").mkdir()
        config = self.folder / "slurm.conf"
        config.write_text(
            _CONFIG.format(host=host, nodes=NODES, folder=self.folder, ports=_free_ports(3), cores=os.cpu_count())
        )
        self.environment = {**os.environ, "PATH": _PATH, "SLURM_CONF": str(config)}
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        self.folder.chmod(0o755)
        place = [f"--{kind}-file={self.folder}/munge.{kind}" for kind in ("key", "pid", "log", "seed")]
        self._start(["munged", "--foreground", "--force", f"--socket={self.folder}/munge.socket", *place])
        self._wait(lambda: (self.folder / "munge.socket").exists(), 10)
        self._start(["slurmctld", "-D"])
        for node in NODES:
            (self.folder / f"spool-{node}").mkdir()
            self._boot(node)
        self._wait(lambda: self.run("sinfo", "--noheader", "--format", "%t %D").strip() == "idle 2", 30)

    def run(self, *words):
        """What a command of Slurm prints."""
        ran = subprocess.run(words, env=self.environment, capture_output=True, text=True, timeout=30)
        return ran.stdout + ran.stderr

    def state(self, job):
        """State of a job, and how often it was started again."""
        fields = dict(word.partition("=")[::2] for word in self.run("scontrol", "show", "job", job).split())
        return fields.get("JobState", "gone"), int(fields.get("Restarts", 0)), fields.get("ExitCode", "")

    def lose(self, node):
        """Kill everything on a node, which then comes back empty."""
        marks = (f"SLURMD_NODENAME={node}\0", f"slurmd\0-D\0-N\0{node}\0")
        for place in Path("/proc").glob("[0-9]*"):
            try:
                text = "".join((place / name).read_text(errors="replace") + "\0" for name in ("cmdline", "environ"))
                if any(mark in text for mark in marks):
                    os.kill(int(place.name), signal.SIGKILL)
            except OSError:
                continue
        daemon = self._daemons.pop()
        daemon.wait()
        self._boot(node)

    def _boot(self, node):
        self._start(["slurmd", "-D", "-N", node])

    def close(self):
        """End jobs and daemons."""
        self.run("scancel", "--user", "root")
        time.sleep(0.5)
        for daemon in reversed(self._daemons):
            daemon.send_signal(signal.SIGTERM)
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def _start(self, words):
        log = open(self.folder / f"{words[0]}-{len(self._daemons)}.out", "w")
        self._daemons.append(
            subprocess.Popen(words, env=self.environment, stdout=log, stderr=log, stdin=subprocess.DEVNULL)
        )

    def _wait(self, happened, seconds):
        begin = time.monotonic()
        while not happened():
            if time.monotonic() - begin > seconds or any(daemon.poll() is not None for daemon in self._daemons):
                logs = "\n".join(path.read_text()[-2000:] for path in self.folder.glob("*.out"))
                self.close()
                raise RuntimeError(f"Slurm does not start:\n{logs}")
            time.sleep(0.1)


def _free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports
