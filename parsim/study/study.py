"""`parsim study`: check, make the runs that are wanted, and tell what follows of those that are there."""

from __future__ import annotations

from pathlib import Path

from parsim.case import file
from parsim.case.load import load
from parsim.domain.grid import check_ranks
from parsim.errors import InputError, WriteError
from parsim.launch import exits, stop
from parsim.launch.mpirun import world
from parsim.output.lock import Lock
from parsim.study import page, slurm
from parsim.study import result as results
from parsim.study.plan import Sample, Search, plans
from parsim.study.result import result
from parsim.study.runs import FAILED, NO_OUTCOME, RUNNING, TABLE, Runs
from parsim.study.side import Hands
from parsim.study.table import Study, read


def study(
    case: Path,
    out: Path,
    hands: Hands,
    gather: bool = False,
    array: bool = False,
    time: str | None = None,
    retry: bool = False,
) -> int:
    """Go on with the study in the case file `case`, in the folder `out`; returns the exit code.

    `hands` make the runs; with `gather` none is made, with `array` a Slurm script is written for those that are wanted,
    each with the walltime `time`; `retry` makes those again that have failed. 0: as far as it can go; 1: runs have
    failed, none has an outcome, or there is no edge; 75: stopped, to be gone on with. Raises InputError or WriteError.
    """
    if world()[1] > 1:
        raise InputError(f"{world()[1]} processes of this command are running; start one: -n gives each run its ranks")
    if gather and array:
        raise InputError("--gather and --slurm: give one of them")
    asked, planned = checked(case, hands.ranks)
    runs = Runs(case, asked, out, retry)
    if gather:
        if not len(runs):
            raise InputError(f"--gather: OUT = {out}: holds no {TABLE}, so no run of a study")
        return _told(asked, planned, runs)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(out, error.strerror or error) from None
    lock = Lock(out)
    lock.take()
    try:
        if array:
            return _submitted(planned, runs, hands.ranks, time)
        done = hands.work(planned, runs, lock, lambda number, run: _note(asked, planned, runs, number, run))
        code = _told(asked, planned, runs)
        return code if done else stop.STOPPED
    finally:
        lock.release()


def checked(case: Path, ranks: int) -> tuple[Study, list[Sample | Search]]:
    """The study in a case file and its plans; the first run of each row, or at each end and amid, is a valid case.

    Raises InputError with every fault found.
    """
    asked = read(case)
    planned = plans(asked)
    told: dict[str, str] = dict.fromkeys(asked.outcome.faults(None), "")
    for plan in planned:
        for run in plan.first():
            try:
                loaded = load(case, run.changes)
                told |= dict.fromkeys(asked.outcome.faults(loaded), "")
                check_ranks(loaded, ranks)
            except InputError as error:
                for message in error.messages:
                    told.setdefault(message, f"study, {', '.join(run.changes)}: ")
    if told:
        raise InputError(place + message for message, place in told.items())
    return asked, planned


def _submitted(planned, runs, ranks, time):
    wanted = [run for plan in planned for run in plan.wanted(runs.known) if runs.seen(run).state != RUNNING]
    if not wanted:
        print("no run is wanted; --gather tells what follows of those there are")
        return exits.DONE
    place = slurm.checkout()
    path = slurm.write(runs, runs.enter(wanted), place, ranks, time)
    print(f"wrote {path}: {len(wanted)} runs; next: sbatch {path}")
    return exits.DONE


def _note(asked, planned, runs, number, run):
    """Tell of a run that has ended, and of what follows now."""
    found = result(asked, planned, runs)
    results.write(found, runs)
    seen = runs.seen(run)
    outcome = results.shown(seen.outcome) or f"{seen.state}{': ' if seen.note else ''}{seen.note}"
    print(f"run {number}, {', '.join(run.changes)}: {outcome}", flush=True)
    print(f"  {page.lines(found)[run.row - 1]}", flush=True)


def _told(asked, planned, runs):
    found = result(asked, planned, runs)
    results.write(found, runs)
    title = file.read(runs.case).get("title") or runs.case.stem
    path = page.write(found, f"Study: {title}", runs.out)
    print(page.outcome(found), *page.lines(found), sep="\n")
    print(f"{page.counted(found)}\npage: {path}", flush=True)
    silent = found.counts[NO_OUTCOME] and not any(row.outcomes for row in found.rows)
    no_edge = any(row.edge and row.edge.note for row in found.rows)
    return exits.FAILED if found.counts[FAILED] or found.cut_short or silent or no_edge else exits.DONE
