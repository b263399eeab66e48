"""The same cases by several schemes of the water, side by side: what each measures, misses, refuses and takes."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import parsim
from parsim.case.load import load
from parsim.errors import InputError, nearest, suggestion
from parsim.fluid import SCHEMES
from parsim.launch.exits import BAD_INPUT
from parsim.machine.processor import processor
from parsim.output.frames import write_text
from parsim.report.measures import published
from parsim.report.page import page, section, table
from parsim.validate.bars import Bar, bars
from parsim.validate.record import shown
from parsim.validate.runs import ended, judged, measured

REFUSED, FAILED = "refused", "failed"


class Told(NamedTuple):
    """What a run of a case by a scheme came to: its rows by quantity, or its `fault`, REFUSED or FAILED, and what it
    said; time, s, of the run."""

    rows: dict[str, dict[str, Any]]
    fault: str = ""
    said: str = ""
    time: float = float("nan")


def compare(
    names: Sequence[str],
    level: str,
    as_json: bool,
    out: Path | None,
    hands: tuple[int, int],
    tables: tuple[Path | None, Path | None],
    kinds: Sequence[str],
) -> int:
    """Run what is named at a level by each scheme of the `kinds` and print all that is measured beside each other.

    `out`: keep the runs in OUT/KIND/CASE and write OUT/index.html. `hands`: so many runs side by side, each on so many
    ranks. Returns 1 where a run failed, else 0: who misses what is what is asked. Raises InputError for a scheme that
    is none, and for `tables`, which are of cases as they are.
    """
    if any(tables):
        raise InputError("--record, --known: are tables of the cases as they are; leave them or --scheme out")
    for kind in kinds:
        if kind not in SCHEMES:
            hint = suggestion(nearest(kind, SCHEMES))
            raise InputError(f"--scheme = {kind}: no such scheme{hint}; allowed: {', '.join(SCHEMES)}")
    held = {path: each for path, each in bars(list(names), level).items() if load(path).water.scheme.WET}
    wanted = [(path, each, kind) for path, each in held.items() for kind in kinds]
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(hands[0]) as pool:
        folder = Path(out or scratch)
        told = list(pool.map(lambda one: _told(*one, folder, hands[1]), wanted))
    found = {(path, kind): one for (path, _, kind), one in zip(wanted, told, strict=True)}
    titles, lines = ("case", "quantity", "unit", "reference", "bar", *kinds), _lines(held, kinds, found)
    if as_json:
        print(json.dumps([dict(zip(titles, line, strict=True)) for line in lines], indent=1))
    else:
        for line in [titles, *lines]:
            print("  ".join(str(cell) for cell in line))
    if out:
        path = _write(out, titles, lines, found)
        if not as_json:
            print(f"page: {path}")
    return 1 if any(one.fault == FAILED for one in told) else 0


def _told(path: Path, each: Sequence[Bar], kind: str, folder: Path, ranks: int) -> Told:
    out = folder / kind / f"{path.parent.name}-{path.stem}"
    words = ["run", str(path), "-o", str(out), "--force", "--set", f'water.scheme={{kind="{kind}"}}']
    ran = ended(words, ranks)
    if ran.returncode:
        said = ran.stderr.strip().rpartition("error: ")[2]
        return Told({}, REFUSED if ran.returncode == BAD_INPUT else FAILED, said)
    run = parsim.open(out)
    numbers = {number.quantity: number for number in published(run)}
    rows = {bar.quantity: judged(bar, measured(bar, run), numbers.get(bar.quantity)) for bar in each}
    return Told(rows, time=run.info["wall_s"])


def _lines(held, kinds, found):
    """A row for each quantity of each case, and one with the times of its runs."""
    lines = []
    for path, each in held.items():
        of_case = [found[path, kind] for kind in kinds]
        if not any(one.rows for one in of_case):
            lines.append((each[0].case, "all", "-", "-", "-", *(one.fault for one in of_case)))
            continue
        for bar in each:
            rows = [one.rows.get(bar.quantity) for one in of_case]
            known = next(row for row in rows if row)
            cells = [_cell(row) if row else one.fault for row, one in zip(rows, of_case, strict=True)]
            lines.append(
                (bar.case, bar.quantity, known["unit"], shown(known["reference"]), f"{bar.within:.2g}", *cells)
            )
        times = [f"{one.time:.3g}" if one.rows else one.fault for one in of_case]
        lines.append((each[0].case, "time of the run", "s", "-", "-", *times))
    return lines


def _cell(row):
    if row["value"] is None:
        return "not measured"
    return f"{row['value']:.5g}" + ("" if row["passed"] else " MISSED")


def _write(out, titles, lines, found):
    refused = [(path.parent.name + "/" + path.stem, kind, one.said) for (path, kind), one in found.items() if one.fault]
    parts = [
        section("Side by side", table(titles, lines)),
        section("What was refused, or failed", table(("case", "scheme", "what it said"), refused)),
    ]
    path = Path(out) / "index.html"
    write_text(path, page("parsim schemes", f"{', '.join(titles[5:])} on {processor()}", parts))
    return path
