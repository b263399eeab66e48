"""Where the bodies go and how deep they sit: their curves, their table, the numbers published of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.case.model import Body
from parsim.errors import InputError
from parsim.report.curves import INK, LINES, figure, name_ends
from parsim.report.measures import MANY, asked, columns, published, wet
from parsim.report.page import section, table
from parsim.report.scene import body_colours

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from parsim.output.reader import Run
    from parsim.report.build import Page


def parts(page: Page) -> str:
    """The curves; the table stands with what is published."""
    return section(
        "Trajectories of the bodies",
        page.figure(
            "trajectories",
            trajectories(page.run),
            "Curves of x and z of each body's centre over time.",
            "X is the position of a block's centre, not its displacement. Squares with bars: the experiments' spread "
            "at the quoted time; crosses: the published model.",
        ),
    )


def body_tracks(run: Run) -> dict[str, dict[str, np.ndarray]]:
    """Body name -> its rows of bodies.csv as a dict of columns, in the order of the case."""
    series = columns(run, "bodies")
    if series is None:
        return {}
    order = np.argsort(series["body"], kind="stable")
    written, first = np.unique(series["body"][order], return_index=True)
    rows = dict(zip(written.tolist(), np.split(order, first[1:]), strict=True))
    return {
        name: {key: values[rows[name]] for key, values in series.items()} for name in run.body_names if name in rows
    }


def compared_until(run: Run) -> float:
    """The end (s) of what is held against experiments: `report.alike_until`, or the run ends before."""
    series, alike = columns(run, "bodies"), asked(run, "alike_until", np.inf)
    return alike if series is None else min(alike, float(series["time"][-1]))


def largest_x(track: Mapping[str, np.ndarray], end: float) -> tuple[float, float] | None:
    """The largest x (m) of a body's centre from t = 0 to `end`, s, and when (s), or None."""
    some = np.flatnonzero((track["time"] >= 0) & (track["time"] <= end) & np.isfinite(track["x"]))
    if not len(some):
        return None
    best = some[np.argmax(track["x"][some])]
    return float(track["x"][best]), float(track["time"][best])


def at_time(track: Mapping[str, np.ndarray], key: str, time: float) -> float | None:
    """The value of a column at ``time`` (s), None outside the track and where the body is not there."""
    times = track["time"]
    if not len(times) or not times[0] <= time <= times[-1]:
        return None
    value = float(np.interp(time, times, track[key]))
    return value if np.isfinite(value) else None


def draught(run: Run, name: str, track: Mapping[str, np.ndarray]) -> float | None:
    """How deep (m) a body sits at the last row with t <= 0: fill level over it minus its lowest corner, or None."""
    before = np.flatnonzero(track["time"] <= 0)
    if not len(before):
        return None
    row, body = before[-1], run.case["bodies"][run.body_names.index(name)]
    x, y = track["x"][row], track["y"][row]
    levels = [
        fill["max"][2]
        for fill in run.case["water"].get("fill", [])
        if fill["min"][0] <= x <= fill["max"][0] and fill["min"][1] <= y <= fill["max"][1]
    ]
    w, a, b, c = (track[f"q{i}"][row] for i in range(4))
    up = 2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)  # in the body's axes
    lowest = track["z"][row] - _shape(body).reach([-v for v in up])
    return float(max(levels) - lowest) if levels else None


def archimedes_draught(run: Run, name: str) -> float | None:
    """The draught (m) of a level body at rest; None if it would sink, or there is no water."""
    if not wet(run):
        return None
    body = run.case["bodies"][run.body_names.index(name)]
    shape, water = _shape(body), run.case["water"].get("density", 1000.0)
    density = body.get("density") or body["mass"] / shape.volume
    return float(shape.draught(density, water)) if density < water else None


def _shape(body):
    return Body.model_validate(body).shape


def _if_known(draught, *given):
    """A draught, None where the file of the body's mesh is not here, as on another machine."""
    try:
        return draught(*given)
    except InputError:
        return None


def told(run: Run) -> str:
    """A table with a row for each body that is free: draught, places at `report.places`, largest x; of many bodies with
    a row for each of these."""
    rows, times, end = [], asked(run, "places", ()), compared_until(run)
    fixed = {body["name"] for body in run.case.get("bodies", ()) if body.get("fixed")}
    for name, track in body_tracks(run).items():
        if name in fixed:
            continue
        places = [at_time(track, "x", time) for time in times]
        best = largest_x(track, end) or (None, None)
        draughts = _if_known(draught, run, name, track), _if_known(archimedes_draught, run, name)
        rows.append((name, *draughts, *places, *best))
    titles = (
        "body",
        "draught before release (m)",
        "by Archimedes (m)",
        *(f"X at {time:g} s (m)" for time in times),
        f"largest X to {end:.3g} s (m)",
        "when (s)",
    )
    return table(titles, rows) if len(rows) < MANY else _told_together(titles[1:], rows)


def _told_together(titles, rows):
    """A row for each quantity of many bodies."""
    found = []
    for title, values in zip(titles, list(zip(*rows, strict=True))[1:], strict=True):
        known = np.array([value for value in values if value is not None])
        if len(known):
            found.append((title, len(known), *(float(v) for v in np.quantile(known, (0.0, 0.1, 0.5, 0.9, 1.0)))))
    return table(("of the bodies that are free", "bodies", "least", "10 %", "median", "90 %", "most"), found)


def trajectories(run: Run) -> Figure | None:
    """x and z of each body's centre over time, with the published largest x."""
    tracks = body_tracks(run)
    if not tracks:
        return None
    drawn, axes = figure(1, 2, 4.2)
    colours = dict(zip(tracks, body_colours(len(tracks)), strict=True))
    for each, key in zip(axes[0], "xz", strict=True):
        ends = []
        for number, (name, track) in enumerate(tracks.items()):
            style = {"linewidth": 0.6, "alpha": 0.6} if len(tracks) >= MANY else {"linewidth": 1.8}
            each.plot(track["time"], track[key], LINES[number % 4], color=colours[name], **style)
            there = np.flatnonzero(np.isfinite(track[key]))  # a floe may have left, or be still to come
            ends += [(name, track["time"][k], track[key][k], colours[name]) for k in there[-1:]]
        if len(tracks) < MANY:
            name_ends(each, ends)
        each.set_xlabel("time (s)")
        each.set_ylabel(f"{key.upper()} of the centre (m)")
    _published_x(axes[0, 0], run, colours)
    return drawn


def _published_x(axes, run, colours):
    """The experiments' spread as a bar at the quoted time, the published model as a cross."""
    for number in published(run):
        if number.block not in colours or number.time is None:
            continue
        style = {"color": colours[number.block], "zorder": 5}
        if number.low is not None and number.high is not None:
            middle, half = (number.low + number.high) / 2, (number.high - number.low) / 2
            label = f"{number.block} {number.quantity}, experiments"
            axes.errorbar(
                number.time,
                middle,
                half,
                fmt="s",
                capsize=6,
                elinewidth=4,
                markersize=6,
                markeredgecolor=INK,
                label=label,
                **style,
            )
        if number.model is not None:
            label = f"{number.block} {number.quantity}, published model"
            axes.plot(number.time, number.model, "X", markersize=9, markeredgecolor=INK, label=label, **style)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=7, frameon=False, loc="upper left")


def _largest(run, number):
    track = body_tracks(run).get(number.block)
    best = None if track is None else largest_x(track, compared_until(run))
    return best and best[0]


def _place(run, number):
    track = body_tracks(run).get(number.block)
    return None if track is None or number.time is None else at_time(track, "x", number.time)


QUANTITIES = {"max X": _largest, "X": _place}
