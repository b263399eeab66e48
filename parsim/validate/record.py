"""The table of the last results: a row for each bar, with when, by what and on what it was measured."""

from __future__ import annotations

import csv
import io
import subprocess
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from parsim import __version__
from parsim.errors import InputError
from parsim.machine.processor import processor
from parsim.output.frames import write_text

COLUMNS = ("case", "quantity", "unit", "value", "reference", "error", "bar", "passed", "date", "version", "machine")


def note(path: Path, rows: Iterable[dict[str, Any]]) -> None:
    """Write what `runs.judged` made of cases into a CSV table, in place of what is there of these quantities.

    Raises InputError where the file is no such table.
    """
    known = {(row["case"], row["quantity"]): row for row in _read(path)}
    by = {"date": datetime.now(UTC).date().isoformat(), "version": _version(), "machine": processor()}
    for row in rows:
        if row["value"] is not None:
            known[row["case"], row["quantity"]] = {name: shown(row[name]) for name in COLUMNS[:8]} | by
    text = io.StringIO()
    table = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    table.writeheader()
    table.writerows(known[key] for key in sorted(known))
    write_text(path, text.getvalue())


def check(path: Path) -> None:
    """Raise InputError, before anything is run, where no such table can be written."""
    _read(path)
    if path.is_dir() or not path.absolute().parent.is_dir():
        raise InputError(f"--record = {path}: must be a file in a folder that there is")


def missed_in(path: Path) -> set[tuple[str, str]]:
    """(case, quantity) of the bars that a table has as missed. Raises InputError where there is no such table."""
    if not path.is_file():
        raise InputError(f"--known = {path}: no such file")
    return {(row["case"], row["quantity"]) for row in _read(path, "--known") if row["passed"] != "True"}


def _read(path: Path, option: str = "--record") -> list[dict[str, str]]:
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        table = csv.DictReader(file)
        rows = list(table)
    if tuple(table.fieldnames or ()) != COLUMNS:
        raise InputError(f"{option} = {path}: is no table of results; its first line must be {','.join(COLUMNS)}")
    return rows


def shown(value: Any) -> str:
    """A value of a row as text; of a range both ends."""
    if isinstance(value, list):
        return " to ".join(f"{each:.6g}" for each in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _version() -> str:
    """The version, and the commit where the program runs from a checkout."""
    ran = subprocess.run(
        ["git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"], capture_output=True, text=True
    )
    return f"{__version__} {ran.stdout.strip()}".strip()
