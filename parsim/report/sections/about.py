"""What a run was made from."""

from __future__ import annotations

import platform
from typing import TYPE_CHECKING, Any

import matplotlib

from parsim.report.page import preformatted, section, table

if TYPE_CHECKING:
    from parsim.output.reader import Run
    from parsim.report.build import Page


def parts(page: Page) -> str:
    """Versions and the case."""
    run = page.run
    path = run.folder / "case.toml"
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    return "".join(
        (
            section("Versions", table(("part", "version"), versions(run, page.gallery.method))),
            section("The case", preformatted(text)),
        )
    )


def versions(run: Run, pictures: str) -> list[tuple[str, Any]]:
    """Versions of the run and of what made this page."""
    info = run.info
    rows = [("parsim", info.get("parsim", "unknown")), *(info.get("versions") or {}).items()]
    rows += [(key, info[key]) for key in ("kernel", "host", "started") if key in info]
    return [
        *rows,
        ("report", f"Python {platform.python_version()}, matplotlib {matplotlib.__version__}, pictures by {pictures}"),
    ]
