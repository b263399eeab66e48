"""Numbers out of the series, and the published ones they are held against."""

import csv
from dataclasses import dataclass

import numpy as np

ALIKE_UNTIL = 1.5  # s; repeated experiments part ways after it (Amaro et al. 2021, section 4)
LEVELS = (0.4, 0.8, 1.2)  # s, when the blocks' places are told


def columns(run, name):
    """A series as a dict of columns, None where the run has not written it or it has no rows."""
    if name not in run.series_names:
        return None
    series = run.series(name)
    return series if len(series["step"]) else None


def body_tracks(run):
    """Body name -> its rows of bodies.csv as a dict of columns, in the order of the case."""
    series = columns(run, "bodies")
    if series is None:
        return {}
    written = set(series["body"].tolist())
    return {
        name: {key: values[series["body"] == name] for key, values in series.items()}
        for name in run.body_names if name in written
    }  # fmt: skip


def front_arrival(run):
    """Time (s) at which the front comes within two spacings of the downstream end, None if it does not or is there."""
    front = columns(run, "front")
    if front is None:
        return None
    later = front["time"] >= 0
    there = front["x"][later] >= run.case["box"]["max"][0] - 2 * run.case["spacing"]
    return float(front["time"][later][there.argmax()]) if there.any() and not there[0] else None


def energy_created(energy):
    """(E - E0 - work done from outside) / E0 at each time from t = 0 on: (times, share)."""
    later = energy["time"] >= 0
    work = sum((values[later] for name, values in energy.items() if name.startswith("work")), np.zeros(later.sum()))
    total = energy["total"][later]
    if not len(total) or total[0] == 0:
        return energy["time"][later], np.zeros_like(total)
    return energy["time"][later], (total - total[0] - (work - work[0])) / total[0]


def compared_until(run):
    """The end (s) of what is held against experiments: they repeat until 1.5 s, and the run may end before."""
    series = columns(run, "bodies")
    return ALIKE_UNTIL if series is None else min(ALIKE_UNTIL, float(series["time"][-1]))


def largest_x(track):
    """The largest x (m) of a body's centre while experiments repeat, and when (s); None before t = 0."""
    some = np.flatnonzero((track["time"] >= 0) & (track["time"] <= ALIKE_UNTIL))
    if not len(some):
        return None
    best = some[np.argmax(track["x"][some])]
    return float(track["x"][best]), float(track["time"][best])


def at_time(track, key, time):
    """The value of a column at ``time`` (s), None outside the track."""
    times = track["time"]
    if not len(times) or not times[0] <= time <= times[-1]:
        return None
    return float(np.interp(time, times, track[key]))


def draught(run, name, track):
    """How deep (m) a body sits at the last row with t <= 0: fill level over it minus its lowest corner, or None."""
    before = np.flatnonzero(track["time"] <= 0)
    if not len(before):
        return None
    row, body = before[-1], run.case["bodies"][run.body_names.index(name)]
    x, y = track["x"][row], track["y"][row]
    levels = [fill["max"][2] for fill in run.case["water"].get("fill", [])
              if fill["min"][0] <= x <= fill["max"][0] and fill["min"][1] <= y <= fill["max"][1]]  # fmt: skip
    w, a, b, c = (track[f"q{i}"][row] for i in range(4))
    # the third row of the rotation matrix: how far each half size reaches down
    reach = np.abs([2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)])
    lowest = track["z"][row] - np.dot(reach, body["shape"]["size"]) / 2
    return float(max(levels) - lowest) if levels else None


def archimedes_draught(run, name):
    """The draught (m) of a level box at rest: its density over the water's, times its height; None if it would sink."""
    body = run.case["bodies"][run.body_names.index(name)]
    size = np.array(body["shape"]["size"])
    density = body.get("density") or body["mass"] / np.prod(size)
    share = density / run.case["water"].get("density", 1000.0)
    return float(share * size[2]) if share < 1 else None


@dataclass(frozen=True)
class Published:
    """One published number: experiments from ``low`` to ``high``, the authors' ``model``, None where not quoted."""

    block: str
    quantity: str
    low: float | None
    high: float | None
    model: float | None
    unit: str
    time: float | None
    source: str


def published(run):
    """The rows of reference.csv that are about this case."""
    path = run.folder / "reference.csv"
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    numbers = ("low", "high", "model", "time")
    return [
        Published(**{key: row[key] for key in ("block", "quantity", "unit", "source")},
                  **{key: float(row[key]) if row[key] else None for key in numbers})
        for row in rows if row["case"] == run.info.get("case_name")
    ]  # fmt: skip


def measured(run, number):
    """What this run has for a published number, None when it has nothing comparable."""
    if number.quantity.startswith("front"):
        return front_arrival(run)
    track = body_tracks(run).get(number.block)
    if track is None:
        return None
    if number.quantity.startswith("max X"):
        best = largest_x(track)
        return best[0] if best else None
    if number.quantity == "X" and number.time is not None:
        return at_time(track, "x", number.time)
    return None


def verdict(value, number):
    """In words, where a measured value lies against the experiments."""
    if value is None or number.low is None or number.high is None:
        return "not compared"
    if number.low <= value <= number.high:
        return "inside the experiments' spread"
    nearest = number.low if value < number.low else number.high
    share = f" ({(value - nearest) / nearest:+.0%})" if nearest else ""
    return f"{abs(value - nearest):.3g} {number.unit} {'below' if value < nearest else 'above'}{share}"
