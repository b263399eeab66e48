"""A dry case with a study, and a machine that makes its runs at once: what they say is a law of the test's own."""

import json
from pathlib import Path
from types import SimpleNamespace

from parsim.case.load import load
from parsim.observe.observers import TABLES
from parsim.output.series import Table
from parsim.study import side

CASE = """
title = "A sphere that falls"
dimensions = 3
[box]
max = [0.4, 0.4, 0.8]
[materials.rubber]
young = 1e7
poisson = 0.3
friction = 0.3
restitution = 0.8
[[bodies]]
name = "sphere"
shape = {kind = "sphere", diameter = 0.1}
density = 1000.0
position = [0.2, 0.2, 0.55]
material = "rubber"
[run]
until = 0.02
[study]
"""
OUTCOME = 'outcome = {kind = "last", series = "bodies", column = "z", rows = {body = "sphere"}, %s}\n'
NUMBER, BELOW = OUTCOME.replace(", %s", ""), OUTCOME % "below = 0.3"
SEEDS = 'seeds = {key = "bodies.sphere.position.0", first = 0.2, step = 0.001%s}\n'
SEARCH = 'bisection = {key = "bodies.sphere.position.2", no = 0.5, yes = 0.1, width = 0.02%s}\n'


def write(folder, text):
    """The case with the lines `text` in its study, as a file."""
    path = Path(folder) / "fall.toml"
    path.write_text(CASE + text, encoding="utf-8")
    return path


class Machine:
    """Makes runs as `subprocess.Popen` of side.py; each is done after `slower` looks more than the one before.

    `law`(case, number) is the height at which the sphere ends; or how the run ends otherwise: "fail", "kill", "stop",
    "bad", "full", "crash" before it writes anything. `calls`: the words of each, `most`: how many were there at a time.
    """

    def __init__(self, monkeypatch, law, slower=0):
        self.law, self.slower, self.calls, self.running, self.most = law, slower, [], 0, 0
        self.processes = []
        monkeypatch.setattr(side, "subprocess", SimpleNamespace(Popen=self.start, DEVNULL=None))
        monkeypatch.setattr(side, "_LOOK", 0.0)

    def start(self, words, stdout, **options):
        words = words[len(side.PARSIM) :]
        self.calls.append(words)
        self.running += 1
        self.most = max(self.most, self.running)
        self.processes.append(Process(self, words, stdout))
        return self.processes[-1]

    @property
    def numbers(self):
        """The runs that were made, by their numbers."""
        return [int(words[words.index("--row") + 1]) for words in self.calls]


class Process:
    """One run, made at the last look at it."""

    def __init__(self, machine, words, log):
        self.machine, self.words, self.log, self.returncode = machine, words, log, None
        self.left = 1 + machine.slower * len(machine.calls)
        self.signalled = []

    def send_signal(self, number):
        self.signalled.append(number)

    def poll(self):
        self.left -= 1
        if self.left == 0:  # once: a signal may come while the run is made
            self.machine.running -= 1
            self.returncode = self._made()
        return self.returncode

    def wait(self):
        while self.poll() is None:
            pass

    def _made(self):
        words = self.words
        resumed = words[0] == "resume"
        out = Path(words[1] if resumed else words[words.index("-o") + 1])
        file = words[words.index("--case") + 1] if resumed else words[1]
        row = int(words[words.index("--row") + 1])
        case = load(file, table=words[words.index("--table") + 1], row=row)
        said = "stop" if self.signalled else self.machine.law(case, row)
        if said in ("bad", "full"):
            self.log.write(b"error: one thing\nerror: the other\n")
            self.log.flush()
            return 2 if said == "bad" else 74
        if said == "crash":
            return 1
        folder(out, case, said)
        return {"fail": 1, "kill": -9, "stop": 75}.get(said, 0)


def folder(out, case, said):
    """An output folder as a run leaves it that has ended as it is `said`."""
    (out / "series").mkdir(parents=True, exist_ok=True)
    (out / "case.toml").write_text(case.to_toml())
    status = {"fail": "failed", "kill": "running", "stop": "stopped"}.get(said, "done")
    info = {"status": status, "time": case.run.until} | ({"error": "RunError: it flew"} if said == "fail" else {})
    (out / "run.json").write_text(json.dumps(info))
    if status == "done":
        table = Table(out / "series" / "bodies.csv", TABLES["bodies"])
        columns = list(TABLES["bodies"])
        for step in (0, 1):
            values = {"step": step, "time": step * case.run.until, "body": "sphere", "z": 0.5 if step == 0 else said}
            table.row(*(values.get(column, 0.0) for column in columns))
        table.close()
