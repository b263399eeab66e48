"""Put the report together: choose the moments, draw, and write OUT/report."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from parsim.errors import InputError
from parsim.output.frames import replacing, write_text
from parsim.output.reader import MENDED
from parsim.output.reader import open as open_run
from parsim.report.animation import chosen
from parsim.report.measures import asked, moments
from parsim.report.page import listing, page, picture
from parsim.report.pictures import Gallery, wanted
from parsim.report.sections import SECTIONS

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from parsim.output.reader import Run

DOTS = 110
LARGEST = 2**15  # dots along a side: matplotlib draws no more than twice that


class Page:
    """What a section works with: run; frames of the pictures and of the film; gallery, which draws them.

    Every picture is kept as a file in OUT/report, `folder`, and given to the page.
    """

    def __init__(self, run: Run, vtk: bool = True) -> None:
        self.run, self.folder, times = run, run.folder / "report", run.times("water")
        self.frames, self.film = moments(times, asked(run, "snapshots", ())), chosen(len(times)) if len(times) else []
        self.gallery = Gallery(run, wanted(run, self.frames, self.film), vtk)

    def keep(self, name: str, suffix: str, data: bytes, alternative: str, caption: str) -> str:
        """Write one file and return its place in the page."""
        with replacing(self.folder / f"{name}.{suffix}") as part:
            part.write_bytes(data)
        return picture(data, suffix, alternative, caption)

    def figure(self, name: str, drawn: Figure | None, alternative: str, caption: str) -> str:
        """Keep a figure as PNG; nothing for None."""
        if drawn is None:
            return ""
        target = io.BytesIO()
        drawn.savefig(target, format="png", dpi=min(DOTS, LARGEST / max(drawn.get_size_inches())))
        return self.keep(name, "png", target.getvalue(), alternative, caption)


def build(out: Path | str, vtk: bool = True) -> Path:
    """Write OUT/report/index.html and the pictures beside it; returns the page's path. ``vtk`` allows pyvista.

    Raises InputError when ``out`` is no output folder, WriteError when the report cannot be written.
    """
    run = open_run(out)
    if run.series_names and not run.case:
        raise InputError(f"OUT = {run.folder}: its case.toml is gone; {MENDED}")
    work = Page(run, vtk)
    parts = [listing(summary(run)), *(each.parts(work) for each in SECTIONS)]
    path = work.folder / "index.html"
    name = run.folder.resolve().name  # "." has none
    write_text(path, page(run.case.get("title") or name, f"parsim report of {name}", parts))
    return path


def summary(run: Run) -> list[str]:
    """A few lines that say how the run went."""
    return [line for each in SECTIONS if hasattr(each, "lines") for line in each.lines(run)]
