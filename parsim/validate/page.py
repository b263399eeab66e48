"""One page of what was validated: the table of all bars, and of each case its numbers and its pictures."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from parsim.machine.processor import processor
from parsim.output.frames import write_text
from parsim.output.reader import open as open_run
from parsim.report.build import build
from parsim.report.page import page, picture, section, table
from parsim.validate.curves import drawn
from parsim.validate.record import shown

if TYPE_CHECKING:
    from parsim.validate.bars import Bar

TITLES = ("quantity", "value", "unit", "reference", "error", "error of the source's own model", "bar", "")
_PICTURES = ("bodies", "sensors", "gauges", "front")  # of the page of a run, besides its last snapshot


def write(folder: Path, rows: Iterable[dict[str, Any]], bars: Sequence[Bar]) -> Path:
    """Write the pages of all runs in `folder`, and FOLDER/index.html over them; returns its path.

    `rows`: see `runs.judged`, of the `bars`; the run of case a/b is in FOLDER/a-b.
    """
    rows = list(rows)
    met = sum(row["passed"] for row in rows)
    parts = [section("All bars", table(("case", *TITLES), [(row["case"], *_told(row)) for row in rows]))]
    for case, own in itertools.groupby(rows, key=lambda row: row["case"]):
        told = list(own)
        lost = {row["quantity"] for row in told if row["value"] is None}
        mine = [bar for bar in bars if bar.case == case and bar.quantity not in lost]
        parts.append(_section(folder / case.replace("/", "-"), case, told, mine))
    path = folder / "index.html"
    write_text(path, page("parsim validation", f"{met} of {len(rows)} bars met, on {processor()}", parts))
    return path


def _section(out: Path, case: str, rows: list[dict[str, Any]], bars: list[Bar]) -> str:
    told = table(TITLES, [_told(row) for row in rows])
    if all(row["value"] is None for row in rows):
        return section(case, told, "<p>The run failed, or has nothing to measure.</p>")
    build(out, vtk=False)
    run, report = open_run(out), out / "report"
    title = run.case.get("title", case)
    curves = picture(drawn(run, bars), "png", f"curves of {case}", f"{title}: curves beside their references")
    pictures = [*sorted(report.glob("snapshot_*.png"))[-1:], *(report / f"{name}.png" for name in _PICTURES)]
    link = f'<p><a href="{out.name}/report/index.html">All of this run</a></p>'
    pages = [
        picture(path.read_bytes(), "png", f"{path.stem} of {case}", f"{title}: {path.stem.split('_')[0]}")
        for path in pictures
        if path.is_file()
    ]
    return section(case, told, curves, *pages, link)


def _told(row: dict[str, Any]) -> tuple[Any, ...]:
    result = "failed" if row["value"] is None else "met" if row["passed"] else "MISSED"
    return (
        row["quantity"],
        row["value"],
        row["unit"],
        shown(row["reference"]),
        row["error"],
        row["document"],
        row["bar"],
        result,
    )
