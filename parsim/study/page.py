"""The page of a study, OUT/index.html: what follows of its runs, the curve, and the table of all runs."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np

from parsim.case.file import inline
from parsim.output.frames import write_text
from parsim.report.curves import ACCENT, FAINT, INK, WATER, figure
from parsim.report.page import listing, page, picture, section, table, text
from parsim.study.result import Result, shown
from parsim.study.statistics import wilson
from parsim.study.table import cells

_SIZE, _DOTS, _SMALL = (6.0, 3.6), 150, 9  # inches, dots per inch, points: legible on a narrow screen too
_FINE = 200  # points of a curve
_WHOLE = (-0.02, 1.02)  # an axis of probabilities


def write(found: Result, title: str, out: Path) -> Path:
    """Write the page of a study into its folder `out`; returns its path. Raises WriteError."""
    drawn = io.BytesIO()
    _drawing(found).savefig(drawn, format="png", dpi=_DOTS)
    parts = [
        listing(_doubts(found), "warnings"),
        section(_asked(found), f"<p>{text(outcome(found))}</p>", *_tables(found)),
        picture(drawn.getvalue(), "png", "the same as a picture", _caption(found)),
        section("All runs", _runs(found)),
    ]
    path = out / "index.html"
    write_text(path, page(title, f"parsim study: {counted(found)}", parts))
    return path


def counted(found: Result) -> str:
    """How many runs there are of each state, in words."""
    told = [f"{count} {state}" for state, count in found.counts.items()]
    return f"{len(found.runs)} runs: {', '.join(told)}" + ("" if found.complete else "; more are wanted")


def outcome(found: Result) -> str:
    """What each run is asked, as the study has it."""
    return f"Of each run: {inline(found.study.outcome.model_dump(exclude_none=True))}"


def lines(found: Result) -> list[str]:
    """What follows of each row, a line each."""
    return [f"{row.label}: {_said(found, row)}" for row in found.rows] + _of_curve(found.key, found.curve)


def _said(found, row):
    if row.edge:
        return _edge(found, row) + "".join(f"; {line}" for line in _of_curve(found.key, row.curve))
    if row.estimate is None:
        return "no outcome yet"
    if found.study.outcome.decides:
        return f"yes in {sum(map(bool, row.outcomes))} of {len(row.outcomes)}, p = {_interval(row.estimate)}"
    told = [f"mean {_interval(row.estimate)} of {len(row.outcomes)}"]
    shares = zip(found.study.quantiles, row.quantiles, strict=True)
    return ", ".join(told + [f"{share:g} quantile {_interval(each)}" for share, each in shares])


def _edge(found, row):
    edge = row.edge
    if edge.note:
        return edge.note
    so_far = "" if row.complete else " so far"
    told = f"no at {edge.no:.6g}, yes at {edge.yes:.6g}{so_far}"
    if edge.monotone is not None:
        told += f"; a value beside it is {'as expected' if edge.monotone else 'NOT as expected: not monotone'}"
    return told


def _of_curve(key, curve):
    if curve is None:
        return []
    return [f"logistic: p = 1/2 at {key} = {curve.middle:.4g} ({curve.low:.4g} to {curve.high:.4g})"]


def _interval(estimate):
    if math.isnan(estimate.low):
        return f"{estimate.value:.4g}"
    return f"{estimate.value:.4g} ({estimate.low:.4g} to {estimate.high:.4g})"


def _asked(found):
    if found.study.bisection:
        return f"Edge of {found.key}"
    return "Probability of yes" if found.study.outcome.decides else "Mean and quantiles"


def _doubts(found):
    counts = found.counts
    told = [
        f"{words}: {counts[state]} of {len(found.runs)} runs"
        for state, words in (("failed", "Failed and not counted"), ("no outcome", "Done without an outcome"))
        if counts[state]
    ]
    if not found.complete:
        told.append("The study is not complete; the same command goes on with it.")
    told += [f"{row.label}: {row.edge.note}" for row in found.rows if row.edge and row.edge.note]
    told += [
        f"{row.label}: the outcome is not monotone beside the edge"
        for row in found.rows
        if row.edge and row.edge.monotone is False
    ]
    if found.study.fit and not _of_curve(found.key, found.curve) and not any(row.curve for row in found.rows):
        told.append("No logistic curve: one value parts all yes from all no, or all outcomes are the same.")
    return told


def _tables(found):
    titles: tuple[str, ...]
    if found.study.bisection:
        titles = ("row", "no at", "yes at", "runs", "beside it")
        words = {None: "not looked at", True: "as expected", False: "NOT as expected"}
        edges = [(row, row.edge) for row in found.rows if row.edge]
        ends = [(None, None) if edge.note else (edge.no, edge.yes) for _, edge in edges]
        rows = [
            (row.label, *pair, len(row.outcomes), words[edge.monotone])
            for pair, (row, edge) in zip(ends, edges, strict=True)
        ]
        told = [f"{row.label}: {line}" for row in found.rows for line in _of_curve(found.key, row.curve)]
    elif found.study.outcome.decides:
        titles = ("row", "runs", "yes", "probability", "95 % from", "to")
        rows = [(r.label, len(r.outcomes), sum(map(bool, r.outcomes)), *_ends(r.estimate)) for r in found.rows]
        told = _of_curve(found.key, found.curve)
    else:
        titles = ("row", "runs", "quantity", "value", "95 % from", "to")
        names = ["mean", *(f"{share:g} quantile" for share in found.study.quantiles)]
        rows = [
            (row.label, len(row.outcomes), name, *_ends(each))
            for row in found.rows
            if row.estimate
            for name, each in zip(names, (row.estimate, *row.quantiles), strict=True)
        ]
        told = _of_curve(found.key, found.curve)
    return table(titles, rows), listing(told)


def _ends(estimate):
    return [None if value is None or math.isnan(value) else value for value in estimate or (None,) * 3]


def _runs(found):
    keys, values = cells(run.changes for run, _ in found.runs)
    rows = []
    for (_, seen), changed in zip(found.runs, values, strict=True):
        told = seen.outcome if isinstance(seen.outcome, float) else shown(seen.outcome) or None
        rows.append((seen.number or None, *changed, seen.state, told, seen.note))
    return table(("run", *keys, "state", "outcome", ""), rows)


def _drawing(found):
    drawn, ((axes,),) = figure()
    drawn.set_size_inches(_SIZE)
    if found.study.bisection:
        _draw_edges(axes, found)
    elif len(found.rows) == 1:
        _draw_one(axes, found, found.rows[0])
    else:
        _draw_rows(axes, found)
    axes.tick_params(labelsize=_SMALL)
    return drawn


def _draw_one(axes, found, row):
    """The estimate of the first 1, 2, ... runs, or the numbers themselves in their order of size."""
    told = row.outcomes
    if found.study.outcome.decides:
        counts = np.arange(1, len(told) + 1)
        every = np.array([wilson(int(sum(map(bool, told[:n]))), int(n)) for n in counts]).reshape(-1, 3)
        axes.fill_between(counts, every[:, 1], every[:, 2], color=WATER, alpha=0.2, linewidth=0)
        axes.plot(counts, every[:, 0], "o-", color=WATER, markersize=3)
        axes.set(xlabel="runs", ylabel="probability of yes", ylim=_WHOLE)
        axes.xaxis.get_major_locator().set_params(integer=True)
        return
    axes.plot(np.sort(told), (np.arange(len(told)) + 0.5) / max(len(told), 1), "o", color=WATER, markersize=4)
    for share, each in zip(found.study.quantiles, row.quantiles, strict=False):
        axes.plot([each.low, each.high], [share, share], color=ACCENT, linewidth=2, alpha=0.6)
    axes.set(xlabel="outcome", ylabel="share of the runs up to it", ylim=_WHOLE)


def _draw_rows(axes, found):
    for x, row in zip(found.places(), found.rows, strict=True):
        if row.estimate is None:
            continue
        if not found.study.outcome.decides:
            axes.plot([x] * len(row.outcomes), row.outcomes, ".", color=FAINT, markersize=4)
        value, low, high = row.estimate
        axes.plot([x, x], [low, high], color=WATER, linewidth=2, alpha=0.6)
        axes.plot(x, value, "o", color=WATER, markersize=5)
    if found.curve:
        _draw_curve(axes, found.curve)
    axes.set(xlabel=found.key or "row", ylabel="mean of the outcome")
    if found.study.outcome.decides:
        axes.set(ylabel="probability of yes", ylim=_WHOLE)


def _draw_edges(axes, found):
    """Every outcome at its value, a line of rows above each other."""
    for row in found.rows:
        base = -1.5 * (row.number - 1)
        for run, seen in row.runs:
            if seen.outcome is not None:
                axes.plot(run.value, base + seen.outcome, "o", color=ACCENT if seen.outcome else WATER, markersize=4)
        if row.edge and not row.edge.note:
            low, high = sorted((row.edge.no, row.edge.yes))
            axes.fill_betweenx([base, base + 1], low, high, color=INK, alpha=0.25, linewidth=0)
        if row.curve:
            _draw_curve(axes, row.curve, base)
    axes.set(xlabel=found.key, yticks=[])
    axes.set_ylabel("no below, yes above" + ("" if len(found.rows) == 1 else "; first row on top"))


def _draw_curve(axes, curve, base=0.0):
    low, high = axes.get_xlim()
    x = np.linspace(low, high, _FINE)
    axes.plot(x, base + curve.at(x), color=INK, linewidth=1)


def _caption(found):
    if found.study.bisection:
        return "Outcomes by the value of the key, blue no and red yes; grey: between the last no and the first yes."
    if len(found.rows) > 1:
        return "Each row with its 95 % interval."
    if found.study.outcome.decides:
        return "Probability after so many runs, with its 95 % interval (Wilson)."
    return "Outcomes in their order of size; red: 95 % intervals of the quantiles."
