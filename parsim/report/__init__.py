"""Tables, figures and pages made from an output folder; knows no solver."""

from pathlib import Path


def make_report(out: Path | str) -> int:
    """Write OUT/report/index.html, say where, and return 0. Raises InputError or WriteError."""
    from parsim.report.build import build

    print(f"report: {build(out)}")
    return 0
