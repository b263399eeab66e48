"""Tables, figures and pages made from an output folder; knows no solver."""


def make_report(out) -> int:
    """Write OUT/report/index.html, say where, and return 0. Raises InputError or WriteError."""
    from parsim.report.build import build

    print(f"report: {build(out)}")
    return 0
