"""A case run for a few seconds, to tell what the whole will take on this machine."""

import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import parsim
from parsim.case.model import Case
from parsim.commands.ranks import changed
from parsim.errors import InputError
from parsim.output.reader import is_output
from parsim.run.progress import duration

_STEPS = "t = "  # in the first line of a log that comes with steps


def tried(
    path: Path | str, changes: Iterable[str] | None, until: float | None, ranks: int, seconds: float
) -> dict[str, Any]:
    """What `run.json` says of a case that has been stopped so many seconds after its first steps, or has ended.

    Raises InputError where the run fails.
    """
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "out"
        words = ["run", path, "-o", out, *changed(changes, None, None), *(["-n", ranks] if ranks > 1 else [])]
        words += ["--until", repr(until)] if until is not None else []
        line = [sys.executable, "-P", "-m", "parsim", *map(str, words)]
        with (
            tempfile.TemporaryFile("w+") as errors,  # a pipe that nobody reads would stop a run of many warnings
            subprocess.Popen(line, stdout=subprocess.PIPE, stderr=errors, text=True) as process,
        ):
            assert process.stdout is not None
            while (said := process.stdout.readline()) and _STEPS not in said:
                pass  # kernels may be compiled before
            try:
                process.communicate(timeout=seconds)
            except subprocess.TimeoutExpired:
                process.terminate()
                process.communicate()
            errors.seek(0)
            told = errors.read()
        found = parsim.open(out).info if is_output(out) else {}
    if "wall_s" not in found:
        raise InputError(f"--trial: the run failed: {told.strip().rpartition('error: ')[2]}")
    return found


def told(case: Case, found: dict[str, Any], ranks: int) -> str:
    """What follows for the whole case from `tried`, in words."""
    done, whole, wall = found["time"] - case.start, case.run.until - case.start, found["wall_s"]
    if found["status"] == "done":
        return f"all {found['steps']} steps took {duration(wall)}"
    if not done > 0.0:
        return f"no step in {duration(wall)}; try it for longer"
    seconds = wall * whole / done
    return (
        f"{found['steps']} steps to {found['time']:.3g} s took {duration(wall)}; at that pace the whole takes "
        f"{duration(seconds)}, {seconds * ranks / 3600.0:.2g} core-hours"
    )
