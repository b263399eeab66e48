"""The measures of a run as tables in the form of its series: a line of units, one of names, exact numbers."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

import numpy as np

from parsim.river.piers import PERCENTS, WINDOWS, percentiles
from parsim.river.verdicts import blocks

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from parsim.river.reader import River
    from parsim.river.verdicts import Verdict

PARTS = {"fx": "N", "fy": "N", "fz": "N", "mx": "N m", "my": "N m", "mz": "N m"}
_PLAIN = {"velocity": "m/s", "ice_speed": "m/s", "concentration": "-", "porosity": "-", "layers": "-"}


def text(units: Mapping[str, str], rows: Iterable[Sequence[object]]) -> str:
    """A table of columns with these units by name, as CSV."""
    target = io.StringIO()
    target.write("# units: " + ", ".join(units.values()) + "\n")
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(units)
    writer.writerows(rows)
    return target.getvalue()


def profiles_table(river: River, moments: Iterable[float]) -> str:
    """Profiles along x in the windows that end at these moments, s: a row for each and each column along x."""
    each = [(time, river.along(time)) for time in moments]
    names = list(each[0][1]) if each else []
    units = {"time": "s"} | {name: _unit(name) for name in names}
    rows = [(time, *map(float, row)) for time, along in each for row in zip(*along.values(), strict=True)]
    return text(units, rows)


def _unit(name):
    return _PLAIN.get(name.rsplit("_", 1)[0] if name[-1].isdigit() else name, "m")


def reach_table(river: River, moments: Iterable[float]) -> str:
    """What holds for the reach as a whole in the windows that end at these moments, s: a row for each."""
    rows = [{"time": time} | river.reach_means(time) for time in moments]
    units = {name: {"time": "s", "energy_slope": "-"}.get(name, _unit(name)) for name in (rows[0] if rows else ())}
    return text(units, [tuple(row.values()) for row in rows])


def jam_table(found: Verdict) -> str:
    """One row: the verdict on a jam, with what it was judged by."""
    units = {"verdict": "-", "kind": "-", "begin": "s", "end": "s", "head": "m", "toe": "m", "layers": "-",
             "supply": "m3/s", "water": "m/s", "window": "s"}  # fmt: skip
    lasts, begin, end = (found.jam.lasts, found.jam.begin, found.jam.end) if found.jam else (found.kind, np.nan, np.nan)
    measured = (begin, end, found.head, found.toe, found.layers, found.supply, found.water, found.window)
    return text(units, [(lasts, found.kind, *map(float, measured))])


def blocks_table(river: River) -> str:
    """A row for each block that drifts against the cover."""
    units = {"body": "-", "class": "-", "critical": "-", "tilt": "degrees"}
    return text(units, [(name, b.name, b.critical, b.tilt) for name, b in blocks(river).items()])


def balance_table(river: River) -> str:
    """Ice at each row of the series of bodies: in the box, in the reach, through each control plane so far, m3, and its
    discharge there, m3/s."""
    planes = river.measure.control
    columns = {"time": river.tracks.time, "stored": river.stored(), "in_reach": river.stored(river.reach)}
    units = {name: "s" if name == "time" else "m3" for name in columns}
    for name, x in planes.items():
        columns |= {f"passed_{name}": river.passed(x), f"discharge_{name}": river.discharge(x)}
        units |= {f"passed_{name}": "m3", f"discharge_{name}": "m3/s"}
    return text(units, [tuple(map(float, row)) for row in zip(*columns.values(), strict=True)])


def piers_table(river: River) -> str:
    """A row for each pier, kind of load, part and window: amounts that it stays below so much of the time."""
    units = {"body": "-", "kind": "-", "part": "-", "unit": "-", "window": "s"}
    units |= {f"p{percent:g}": "see unit" for percent in PERCENTS}
    rows = []
    for body in (river.run.body_names[k] for k in river.piers):
        for kind in ("water", "contact"):
            for part, unit in PARTS.items():
                peaks = river.peaks(body, kind, part)
                if peaks is not None:
                    found = percentiles(peaks)
                    rows += [
                        (body, kind, part, unit, w, *map(float, row)) for w, row in zip(WINDOWS, found, strict=True)
                    ]
    return text(units, rows)
