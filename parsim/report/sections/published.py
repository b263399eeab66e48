"""What is measured here beside what is published."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.report import measures
from parsim.report.page import section, table
from parsim.report.sections import bodies

if TYPE_CHECKING:
    from parsim.output.reader import Run
    from parsim.report.build import Page


def parts(page: Page) -> str:
    """The table of what is published, and that of the bodies."""
    return section("Here and published", compared(page.run), bodies.told(page.run))


def measured(run: Run, number: measures.Published) -> float | None:
    """What this run has for a published number, None when it has nothing comparable."""
    from parsim.report.sections import SECTIONS  # which has this one among its own

    for each in SECTIONS:
        if number.quantity in getattr(each, "QUANTITIES", {}):
            return each.QUANTITIES[number.quantity](run, number)
    return None


def compared(run: Run) -> str:
    """A row for each published number."""
    rows, end = [], bodies.compared_until(run)
    for number in measures.published(run):
        value = measured(run, number)
        spread = [f"{end:g}" for end in dict.fromkeys((number.low, number.high)) if end is not None]
        short = number.quantity == "max X" and number.time is not None and end < number.time
        quantity = f"{number.quantity} (here to {end:.3g} s)" if short else number.quantity
        rows.append(
            (
                quantity,
                number.block or "-",
                number.unit,
                value,
                " to ".join(spread) or "not quoted",
                number.model,
                measures.verdict(value, number),
                number.source,
            )
        )
    titles = ("quantity", "body", "unit", "here", "experiments", "published model", "against the experiments", "source")
    return table(titles, rows)
