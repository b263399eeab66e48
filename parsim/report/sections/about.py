"""What a run was made from."""

import platform

import matplotlib

from parsim.report.page import preformatted, section, table


def parts(page):
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


def versions(run, pictures):
    """Versions of the run and of what made this page."""
    info = run.info
    rows = [("parsim", info.get("parsim", "unknown")), *(info.get("versions") or {}).items()]
    rows += [(key, info[key]) for key in ("kernel", "host", "started") if key in info]
    return [
        *rows,
        ("report", f"Python {platform.python_version()}, matplotlib {matplotlib.__version__}, pictures by {pictures}"),
    ]
