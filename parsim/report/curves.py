"""What the curves of the page have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes

WATER, INK, FAINT, ACCENT = "#2b7bba", "#1f2933", "#9aa5b1", "#c8553d"
LINES = ("-", "--", "-.", ":")


def figure(rows: int = 1, across: int = 1, height: float = 3.4, **options: Any) -> tuple[Figure, np.ndarray]:
    """A figure of the page's width and its axes, with a light grid."""
    drawn = Figure(figsize=(9, height * rows), layout="constrained")
    axes = drawn.subplots(rows, across, squeeze=False, **options)
    for each in axes.flat:
        each.grid(color="#e4e7eb", linewidth=0.7)
        each.spines[["top", "right"]].set_visible(False)
        each.tick_params(labelsize=8)
    return drawn, axes


def name_ends(axes: Axes, ends: Iterable[tuple[str, float, float, Any]]) -> None:
    """Write names right of the ends of curves, moved apart where they would overlap: ``ends`` (name, x, y, colour)."""
    low, high = axes.get_ylim()
    gap, last = 0.05 * (high - low), -np.inf
    for name, x, y, colour in sorted(ends, key=lambda end: end[2]):
        last = max(y, last + gap)
        axes.text(x, last, f" {name}", color=colour, fontsize=8, fontweight="bold", va="center")
