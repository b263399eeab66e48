"""Arguments and options that several commands have."""

from pathlib import Path
from typing import Annotated

import typer

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="case file (TOML), or the name of an example")]
Folder = Annotated[Path, typer.Argument(metavar="OUT", help="output folder of a run")]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="replace one value, e.g. spacing=0.002 or bodies.A1.density=900"),
]
Threads = Annotated[int | None, typer.Option(min=1, metavar="N", help="threads of each rank")]
Ranks = Annotated[int | None, typer.Option("-n", min=1, metavar="N", help="start N ranks with mpirun")]
Walltime = Annotated[
    str | None,
    typer.Option(metavar="H:M:S", help="time that the job has, from now on: stops with a checkpoint before it is over"),
]
TableFile = Annotated[
    Path | None,
    typer.Option(
        "--table", metavar="TABLE", help="CSV: the first line names keys of the case, each further line is a run"
    ),
]
Row = Annotated[int | None, typer.Option(metavar="N", help="the row of the table to run")]
Until = Annotated[float | None, typer.Option(metavar="T", help="end time, s, in place of run.until")]
FirstStation = Annotated[
    float | None,
    typer.Option("--from-station", metavar="A", help="river station where a reach begins, else x in the file"),
]
LastStation = Annotated[
    float | None, typer.Option("--to-station", metavar="B", help="the same where it ends, downstream")
]
Spacing = Annotated[float | None, typer.Option(min=1e-6, metavar="S", help="spacing of a reach, m")]
Level = Annotated[float | None, typer.Option(metavar="Z", help="level of the water of a reach, a height in the file")]
RiverReach = Annotated[
    str | None, typer.Option(metavar="NAME", help='"River, Reach" of a file of sections with several')
]
Scale = Annotated[
    float, typer.Option(min=1e-6, metavar="M", help="m of one unit of the file of a reach: 0.3048 for feet")
]
RanksToEstimate = Annotated[int, typer.Option("-n", min=1, metavar="N", help="ranks to estimate for")]
Trial = Annotated[
    float | None, typer.Option(min=1.0, metavar="S", help="run it for S seconds here, and tell the time by that")
]
RanksOfEach = Annotated[int, typer.Option("-n", min=1, metavar="N", help="ranks of each run")]
KeptRuns = Annotated[
    Path | None, typer.Option("-o", "--out", metavar="OUT", help="keep the runs in this folder, and use those there")
]
Example = Annotated[
    str | None,
    typer.Option(
        "--from", metavar="EXAMPLE", help="start from an example, or from a file of ground: then NAME is a folder"
    ),
]
Jobs = Annotated[int, typer.Option(min=1, metavar="N", help="runs side by side")]
Known = Annotated[
    Path | None, typer.Option(metavar="CSV", help="bars that this table of results has as missed may be missed again")
]
Examples = Annotated[
    list[str] | None, typer.Argument(metavar="[NAME]...", help="examples, or folders of them; left out: all")
]
Schemes = Annotated[
    list[str] | None,
    typer.Option("--scheme", metavar="KIND", help="run them by this scheme of the water; several stand side by side"),
]
Record = Annotated[Path | None, typer.Option("--record", metavar="CSV", help="bring this table of results up to date")]
Slurm = Annotated[bool, typer.Option("--slurm", help="write the script of a Slurm array that makes the runs")]
OfCase = Annotated[
    Path | None, typer.Option("--case", metavar="CASE", help="go on only if the run is of this case; its end holds")
]
