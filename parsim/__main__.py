"""The commands. Parsing only: each command hands over to the part that does the work, imported when it is asked for."""

import functools
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from parsim import __version__
from parsim.case.examples import path_of
from parsim.commands import options as given
from parsim.errors import InputError
from parsim.launch import exits, stop

app = typer.Typer(
    help="Free-surface flow carrying solids. SI units; exit codes: 0 done, 1 failed, 2 bad input, 3 a comparison "
    "missed, 74 cannot write, 75 checkpoint written.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command in `arguments` (default: those of the process); returns the exit code."""
    try:
        app(args=arguments, prog_name="parsim")
    except SystemExit as ending:
        return ending.code if isinstance(ending.code, int) else exits.FAILED
    return exits.DONE


def command(function: Callable[..., int | None]) -> Callable[..., int | None]:
    """Make `function` a command: what it returns, or the error it raises, becomes the exit code."""

    @functools.wraps(function)
    def guarded(*positional, **named):
        raise typer.Exit(exits.code_of(functools.partial(function, *positional, **named)))

    app.command()(guarded)
    return function


@command
def run(
    case: given.CaseFile,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="output folder, made by the run")],
    until: given.Until = None,
    changes: given.Changes = None,
    table: given.TableFile = None,
    row: given.Row = None,
    force: Annotated[bool, typer.Option("--force", help="overwrite an output folder")] = False,
    threads: given.Threads = None,
    ranks: given.Ranks = None,
    kernel: Annotated[str | None, typer.Option(metavar="NAME", help="kernel variant, in place of the fastest")] = None,
    walltime: given.Walltime = None,
) -> int:
    """Run a case. Under mpirun or srun every rank runs this command."""
    from parsim.case.load import load

    case = path_of(case)
    loaded, limit = load(case, changes, until, table, row), _settings(threads, kernel, walltime)
    if ranks:
        from parsim.commands.ranks import changed, launched

        words = ["run", case, "-o", out, *changed(changes, table, row), *["--force"] * force]
        return launched(ranks, words, until, kernel, limit, loaded)
    from parsim.run.warm import prepare

    prepare()
    from parsim.run.loop import run as solve

    return solve(loaded, case, out, force, limit)


@command
def validate(
    names: given.Examples = None,
    level: Annotated[str, typer.Option(metavar="LEVEL", help="quick, or full: the long ones too")] = "quick",
    as_json: Annotated[bool, typer.Option("--json", help="print rows as JSON")] = False,
    out: given.KeptRuns = None,
    jobs: given.Jobs = 1,
    ranks: given.RanksOfEach = 1,
    record: given.Record = None,
    known: given.Known = None,
    scheme: given.Schemes = None,
) -> int:
    """Run examples and compare them with published and exact numbers; exit code 3 if a bar is missed."""
    if scheme:
        from parsim.validate.schemes import compare as compare_schemes

        return compare_schemes(names or [], level, as_json, out, (jobs, ranks), (record, known), scheme)
    from parsim.validate.runs import validate as check

    return check(names or [], level, as_json, out, (jobs, ranks), (record, known))


@command
def study(
    case: Annotated[Path, typer.Argument(metavar="CASE", help="case file (TOML) that holds a table [study]")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="folder of all runs; one there goes on")],
    jobs: given.Jobs = 1,
    ranks: given.RanksOfEach = 1,
    threads: given.Threads = None,
    walltime: given.Walltime = None,
    gather: Annotated[bool, typer.Option("--gather", help="make no run, tell what follows of those there are")] = False,
    slurm: given.Slurm = False,
    retry: Annotated[bool, typer.Option("--retry", help="go on with runs that have failed, too")] = False,
) -> int:
    """Make many runs of a case, by seeds, tables or bisection, and tell probabilities, quantiles and edges."""
    from parsim.study.side import Hands
    from parsim.study.study import study as go_on

    hands = Hands(jobs, ranks, _settings(threads, None, walltime))
    return go_on(path_of(case), out, hands, gather, slurm, walltime, retry)


@command
def resume(
    out: given.Folder,
    until: given.Until = None,
    threads: given.Threads = None,
    ranks: given.Ranks = None,
    kernel: Annotated[str | None, typer.Option(metavar="NAME", help="another kernel variant: other last bits")] = None,
    walltime: given.Walltime = None,
    case: given.OfCase = None,
    changes: given.Changes = None,
    table: given.TableFile = None,
    row: given.Row = None,
) -> int:
    """Go on with a run from its newest whole checkpoint, on any number of ranks, to the same bits."""
    from parsim.case.load import load
    from parsim.domain.comm import Comm
    from parsim.output import folder as folders
    from parsim.run.resume import find

    limit = _settings(threads, kernel, walltime)
    if case is None and (changes or table or row):
        raise InputError("--set, --table and --row belong to the case that --case names")
    case = path_of(case) if case else None
    wanted = load(case, changes, until, table, row) if case else None
    if ranks:
        from parsim.commands.ranks import changed, launched

        words = ["resume", out, *(["--case", case] if case else []), *changed(changes, table, row)]
        return launched(ranks, words, until, kernel, limit, wanted)
    with folders.Folder(out, Comm()) as folder:
        folder.take()
        found = folder.comm.first(find, out, until, kernel, wanted)
        return exits.DONE if found is None else _gone_on(found, folder, limit)


def _gone_on(found, folder, limit):
    from parsim.machine import variant

    if found.kernel:
        os.environ[variant.NAME] = variant.checked(found.kernel)
    from parsim.run.warm import prepare

    prepare()
    from parsim.run.loop import resume as solve

    return solve(found, folder, limit)


def _settings(threads, kernel, walltime):
    """Hand threads and kernel variant on to this process and its children; returns the walltime in s, or None."""
    from parsim.machine import variant

    if threads:
        os.environ["NUMBA_NUM_THREADS"] = str(threads)
    if kernel is not None:
        os.environ[variant.NAME] = variant.checked(kernel)
    return None if walltime is None else stop.seconds(walltime)


@command
def check(
    case: given.CaseFile,
    changes: given.Changes = None,
    until: given.Until = None,
    ranks: given.RanksToEstimate = 1,
    table: given.TableFile = None,
    trial: given.Trial = None,
) -> None:
    """Check a case, or all runs of a table, and estimate size, memory, time and disk; runs nothing but a trial."""
    from parsim.commands.check import check_cases

    check_cases(path_of(case), changes, until, ranks, table, trial)


@command
def info(out: given.Folder) -> None:
    """Say what an output folder holds."""
    from parsim.commands.info import tell

    tell(out)


@command
def compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="output folder")],
    second: Annotated[Path, typer.Argument(metavar="B", help="output folder")],
) -> int:
    """Compare two output folders bit by bit; exit code 3 when they differ."""
    from parsim.output.compare import compare_outputs

    return compare_outputs(first, second)


@command
def report(out: given.Folder) -> int:
    """Make tables, figures and a page from an output folder."""
    from parsim.report import make_report

    return make_report(out)


@command
def bench(
    as_json: Annotated[bool, typer.Option("--json", help="print every figure as JSON")] = False,
    with_model: Annotated[bool, typer.Option("--model", help="fit and print the cost model instead")] = False,
) -> int:
    """Measure what parsim does on this machine: speed, balance, memory, start-up. Takes some ten minutes."""
    from parsim.bench import bench_machine

    return bench_machine(as_json, with_model)


@command
def doctor() -> int:
    """Say whether this machine can run parsim: packages, MPI, threads, disk."""
    from parsim.commands.doctor import examine_machine

    return examine_machine()


@command
def schema() -> None:
    """Print the JSON schema of case files, for editors that complete and check TOML."""
    import json

    from parsim.case.model import schema as case_schema
    from parsim.study.table import schema as with_study

    print(json.dumps(with_study(case_schema()), indent=2))


@command
def new(
    name: Annotated[str | None, typer.Argument(metavar="NAME", help="writes NAME.toml")] = None,
    example: given.Example = None,
    listed: Annotated[bool, typer.Option("--list", help="print the examples")] = False,
    first: given.FirstStation = None,
    last: given.LastStation = None,
    spacing: given.Spacing = None,
    level: given.Level = None,
    river_reach: given.RiverReach = None,
    scale: given.Scale = 1.0,
) -> None:
    """Write a case to start from; never overwrites."""
    from parsim.commands import new as cases
    from parsim.commands.new_reach import Asked

    if listed:
        cases.show()
    else:
        cases.new_case(name, example, Asked(first, last, spacing, level, river_reach, scale))


def _version(asked: bool) -> None:
    if asked:
        print(f"parsim {__version__}")
        raise typer.Exit()


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="print the version and end")
    ] = False,
) -> None:
    """Options of the program as a whole."""


def program() -> NoReturn:
    """The command of the shell: `main`, but for what HDF5 does at the end of a process when a disk was full."""
    stop.listen()
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    if code == exits.CANNOT_WRITE:
        os._exit(code)
    sys.exit(code)


if __name__ == "__main__":
    program()
