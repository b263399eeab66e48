"""The job script of a Slurm array that makes the runs of a study, each as `jobs/slurm.sh` makes a run."""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from pathlib import Path

import parsim
from parsim.errors import InputError
from parsim.output.frames import write_text
from parsim.study.runs import TABLE, Runs

SCRIPT = "slurm.sh"
_TEXT = """#!/usr/bin/env bash
# The next {count} runs of the study {case}; submit it from where `parsim study` was called:
#   sbatch {script}
# Afterwards the same `parsim study` line tells what follows of them, with --gather in place of --slurm.
# Options of sbatch before the script's name overrule those below.
#SBATCH --job-name=parsim-study
#SBATCH --array={array}
#SBATCH --ntasks={ranks}{time}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --output={log}
set -euo pipefail
export PARSIM={checkout}
exec bash "$PARSIM/jobs/slurm.sh" {words}
"""


def checkout() -> Path:
    """The checkout of parsim whose scripts the jobs use. Raises InputError where there is none."""
    found = Path(os.environ.get("PARSIM") or Path(parsim.__file__).parents[1]).resolve()
    if not (found / "jobs" / "slurm.sh").is_file():
        raise InputError(
            f"--slurm: {found} holds no jobs/slurm.sh; name a checkout of parsim: export PARSIM=/path/to/checkout"
        )
    return found


def write(runs: Runs, numbers: Sequence[int], place: Path, ranks: int, walltime: str | None) -> Path:
    """Write OUT/slurm.sh for runs of these numbers by the checkout at `place`; returns its path. Raises WriteError."""
    out = runs.out.resolve()
    words = [runs.case.resolve(), out / "run", out / TABLE]
    path = runs.out / SCRIPT
    text = _TEXT.format(
        count=len(numbers),
        case=runs.case,
        script=shlex.quote(str(path)),
        array=_ranges(numbers),
        ranks=ranks,
        time=f"\n#SBATCH --time={walltime}" if walltime else "",
        log=shlex.quote(str(out / "run-%a.log")),
        checkout=shlex.quote(str(place)),
        words=shlex.join(map(str, words)),
    )
    write_text(path, text)
    return path


def _ranges(numbers):
    """Numbers as Slurm writes them, such as 1-3,7."""
    ranges: list[list[int]] = []
    for number in sorted(numbers):
        if ranges and ranges[-1][1] == number - 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    return ",".join(f"{first}-{last}" if last > first else f"{first}" for first, last in ranges)
