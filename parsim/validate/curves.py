"""The curves that cases are held to, beside what was computed."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from parsim.report.curves import ACCENT, WATER, figure
from parsim.validate.series_measures import off_curve, scaled

if TYPE_CHECKING:
    from parsim.output.reader import Run
    from parsim.validate.bars import Bar


def drawn(run: Run, bars: Sequence[Bar]) -> bytes:
    """A PNG with one picture for each bar that holds a curve; nothing where none does."""
    held = [bar for bar in bars if bar.measure == off_curve.__name__]
    if not held:
        return b""
    drawing, axes = figure(len(held), 1, 2.6)
    for each, bar in zip(axes[:, 0], held, strict=True):
        given = dict(bar.arguments)
        at, exact = np.array(given.pop("curve"), float).T
        given.pop("over", None)
        times, values = scaled(run, **given)
        shown = times <= 1.1 * at[-1]
        each.plot(times[shown], values[shown], color=WATER, linewidth=1.2, label="parsim")
        each.plot(at, exact, "o", color=ACCENT, markersize=3.5, label="reference")
        each.set_title(bar.quantity, fontsize=9, loc="left")
        each.legend(fontsize=7, frameon=False)
    out = io.BytesIO()
    drawing.savefig(out, dpi=110)
    return out.getvalue()
