"""parsim: free-surface flow carrying solids, by moving particles and discrete elements, parallel over MPI."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from parsim.output.reader import Run

__version__ = "0.1.0"


def open(folder: Path | str) -> Run:
    """Open an output folder for reading: see :class:`parsim.output.reader.Run`."""
    from parsim.output.reader import open as open_run

    return open_run(folder)
