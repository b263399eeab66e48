"""Run cases, measure them, and tell which bars they meet."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import parsim
from parsim.errors import InputError
from parsim.output.reader import Run, is_output
from parsim.report.measures import Published, published
from parsim.validate.bars import Bar, bars
from parsim.validate.measures import MEASURES
from parsim.validate.page import write
from parsim.validate.record import check, missed_in, note, shown

MISSED = 3


def validate(
    names: Iterable[str],
    level: str,
    as_json: bool,
    out: Path | None,
    hands: tuple[int, int] = (1, 1),
    tables: tuple[Path | None, Path | None] = (None, None),
) -> int:
    """Run what is named at a level and print a row for each bar; returns 3 where one is missed, 1 where a run failed
    or cannot be measured.

    Runs whose output is in `out` go on there, if they are of the same case and not done, and out/index.html shows all
    that was run. `hands`: so many runs side by side, each on so many ranks. `tables`, of results: the rows of what has
    been run take the place of those before in the first, and what the second has as missed is no reason to return 3.
    """
    held, (record, known) = bars(list(names), level), tables
    excused = missed_in(known) if known else set()
    if record:
        check(record)
    with tempfile.TemporaryDirectory() as scratch:
        rows = list(_rows(held, Path(out or scratch), hands, as_json))
    if record:
        note(record, rows)
    if out:
        told = write(out, rows, [bar for each in held.values() for bar in each])
        if not as_json:
            print(f"page: {told}")
    if as_json:
        print(json.dumps([_plain(row) for row in rows], indent=1))
    if any(row["value"] is None for row in rows):
        return 1
    missed = [row for row in rows if not row["passed"]]
    new = [row for row in missed if (row["case"], row["quantity"]) not in excused]
    if not as_json:
        if not rows:
            print("nothing was compared: what is asked for has no bars, or not at this level")
        before = f", {len(missed) - len(new)} of them as in {known}" if known else ""
        print(f"{len(rows) - len(missed)} of {len(rows)} bars met, {len(missed)} missed{before}")
    return MISSED if new else 0


def _rows(held: dict[Path, list[Bar]], folder: Path, hands: tuple[int, int], quiet: bool) -> Iterator[dict[str, Any]]:
    jobs, ranks = hands
    outs = [folder / f"{path.parent.name}-{path.stem}" for path in held]
    with ThreadPoolExecutor(jobs) as pool:
        runs = pool.map(_run, held, outs, [ranks] * len(outs))
        for each, out, whole in zip(held.values(), outs, runs, strict=True):
            yield from _judged(each, out if whole else None, quiet)


def _judged(each: list[Bar], out: Path | None, quiet: bool) -> Iterator[dict[str, Any]]:
    """The rows of the bars of one case, whose run is in `out`; None: it has failed."""
    if not quiet:
        print(f"{each[0].case}", flush=True)
    run = parsim.open(out) if out else None
    numbers = {number.quantity: number for number in published(run)} if run else {}
    for bar in each:
        row = judged(bar, measured(bar, run) if run else None, numbers.get(bar.quantity))
        if not quiet:
            print(told(row), flush=True)
        yield row


def measured(bar: Bar, run: Run) -> float | None:
    """What a bar measures; None, and why on the standard error, where this run has nothing of the kind."""
    try:
        return MEASURES[bar.measure](run, **bar.arguments)
    except (InputError, LookupError, ValueError) as error:
        print(f"{bar.case}: {bar.quantity}: cannot be measured: {error}", file=sys.stderr)
        return None


def _run(path: Path, out: Path, ranks: int) -> bool:
    words = ["resume", str(out), "--case", str(path)] if is_output(out) else ["run", str(path), "-o", str(out)]
    ran = ended(words, ranks)
    if ran.returncode:
        print(ran.stderr, file=sys.stderr)
    return ran.returncode == 0


def judged(bar: Bar, value: float | None, number: Published | None) -> dict[str, Any]:
    """A row: value, reference, error and whether it is within the bar; document: the error of the published model.

    The reference is a number or a range, in which the error is zero; without one the value itself is the error.
    """
    low, high = (number.low or 0.0, number.high or 0.0) if number else (0.0, 0.0)

    def off(value: float) -> float:
        nearest = min(max(value, low), high)
        error = value - nearest
        return error if bar.absolute or nearest == 0.0 else error / abs(nearest)

    error = None if value is None else off(value)
    return {
        "case": bar.case,
        "quantity": bar.quantity,
        "unit": number.unit if number else "-",
        "value": value,
        "reference": low if low == high else [low, high],
        "error": error,
        "document": off(number.model) if number and number.model is not None else None,
        "bar": bar.within,
        "passed": error is not None and abs(error) <= bar.within,
    }


def ended(words: list[str], ranks: int) -> subprocess.CompletedProcess[str]:
    """A `parsim` with these words and on so many ranks that has come to its end."""
    line = [sys.executable, "-m", "parsim", *words, *(["-n", str(ranks)] if ranks > 1 else [])]
    return subprocess.run(line, capture_output=True, text=True)


def _plain(row: dict[str, Any]) -> dict[str, Any]:
    """A row as JSON has it, which knows no nan."""
    return {key: None if isinstance(cell, float) and not math.isfinite(cell) else cell for key, cell in row.items()}


def told(row: dict[str, Any]) -> str:
    """A row as a line of text."""
    if row["value"] is None:
        return f"  {row['quantity']}: no value; the run failed, or it has nothing to measure"
    words = f"  {'met   ' if row['passed'] else 'MISSED'} {row['quantity']}: {row['value']:.6g} {row['unit']}"
    words += f", reference {shown(row['reference'])}, error {row['error']:.2g}, bar {row['bar']:.2g}"
    return words + (f", the document's own error {row['document']:.2g}" if row["document"] is not None else "")
