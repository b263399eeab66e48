"""Where the time of the computer went."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.report.curves import FAINT, figure
from parsim.report.measures import wall_time
from parsim.report.page import section, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page

LIMIT_NAMES = {"steps": "steps", "ranks": "ranks", "threads": "threads per rank"}


def parts(page: Page) -> str:
    """Rates, and the phases of the solver."""
    return section(
        "Speed",
        table(("quantity", "value"), speed(page.run)),
        page.figure(
            "phases",
            phases(page.run),
            "Bars: seconds in each phase of the solver.",
            "Wall time by phase of the solver, with shares"
            + " of the last piece" * (len(page.run.info.get("pieces", ())) > 1)
            + ".",
        ),
    )


def speed(run: Run) -> list[tuple[str, Any]]:
    """Rates and times as rows."""
    info, spent, pieces = run.info, wall_time(run), len(run.info.get("pieces", ()))
    last = f", the last of {pieces} pieces" if pieces > 1 else ""
    rows = [("wall time (s)", spent)] if spent else []
    rows += [(LIMIT_NAMES[key], info[key]) for key in LIMIT_NAMES if key in info]
    rows += [(key.replace("_", " ") + last, value) for key, value in _flat(info.get("rate") or {})]
    lasted = info.get("time", 0.0) + run.case.get("run", {}).get("settle", 0.0)
    if spent and lasted > 0.0:
        rows.append(("wall seconds per simulated second", spent / lasted))
    return rows


def _flat(values, before=""):
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{key} ")
        else:
            yield before + key, value


def phases(run: Run) -> Figure | None:
    """Seconds spent in each phase of the solver, longest on top."""
    spent = run.info.get("phases") or {}
    if not spent:
        return None
    names = sorted(spent, key=lambda name: spent[name])
    seconds = np.array([spent[name] for name in names], float)
    drawn, axes = figure(1, 1, 0.7 + 0.27 * len(names))
    bars = axes[0, 0].barh([name.replace("_", " ") for name in names], seconds, color=FAINT)
    total = max(seconds.sum(), 1e-300)
    axes[0, 0].bar_label(bars, [f" {second / total:.1%}" for second in seconds], fontsize=8)
    axes[0, 0].set_xlabel("wall time (s)")
    return drawn
