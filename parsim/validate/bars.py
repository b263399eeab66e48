"""What each example case is held to: `_bars.toml` beside it, its numbers in `reference.csv`.

A case in `_bars.toml` has a level and `bars`, or the name of the case whose bars it has too: `like = "10_rows"`.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from parsim.case.examples import paths
from parsim.errors import InputError, nearest, suggestion
from parsim.validate.measures import MEASURES

LEVELS = ("quick", "full")
FILE = "_bars.toml"


@dataclass(frozen=True)
class Bar:
    """One quantity of one case: how it is measured, and how far off it may be.

    within: over the reference; with absolute = true in the unit of the quantity. measure: name of a function of
    `measures`, arguments: what it takes besides the run.
    """

    case: str
    level: str
    quantity: str
    measure: str
    within: float
    absolute: bool
    arguments: dict[str, Any]


def bars(names: Sequence[str], level: str) -> dict[Path, list[Bar]]:
    """{case file: its bars} of the named cases or folders of cases, all if none is named; "full" takes both levels."""
    if level not in LEVELS:
        raise InputError(f"--level = {level}: must be quick or full")
    known = paths()
    folders = {name.split("/")[0] for name in known}
    wrong = [name for name in names if name not in known and name not in folders]
    if wrong:
        allowed = sorted({name for name in known if _of(known[name], name)} | folders)
        raise InputError(
            [
                f"NAME = {name}: no such example{suggestion(nearest(name, allowed))}; see parsim new --list"
                for name in wrong
            ]
        )
    found = {}
    for name, path in known.items():
        if not names or name in names or name.split("/")[0] in names:
            held = [bar for bar in _of(path, name) if level == "full" or bar.level == "quick"]
            if held:
                found[path] = held
    return found


def _of(path: Path, name: str) -> list[Bar]:
    file = path.parent / FILE
    return [bar for bar in _read(file) if bar.case == name] if file.is_file() else []


def _read(file: Path) -> Iterator[Bar]:
    with file.open("rb") as opened:
        cases = tomllib.load(opened)
    for stem, table in cases.items():
        for row in cases[table["like"]]["bars"] if "like" in table else table["bars"]:
            given = dict(row)
            if given.get("measure") not in MEASURES:
                likely = suggestion(nearest(str(given.get("measure")), MEASURES))
                raise InputError(f"{file}: {stem}: measure = {given.get('measure')}: there is no such one{likely}")
            yield Bar(
                case=f"{file.parent.name}/{stem}",
                level=table["level"],
                quantity=given.pop("quantity"),
                measure=given.pop("measure"),
                within=float(given.pop("within")),
                absolute=bool(given.pop("absolute", False)),
                arguments=given,
            )
