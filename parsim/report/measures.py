"""What several sections need of a run: columns of its series, what its case wants told, and published numbers."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from parsim.output.reader import Run


def asked(run: Run, key: str, default: Any = None) -> Any:
    """What the case of a run says under `report`, the default where it says nothing."""
    return run.case.get("report", {}).get(key) or default


def columns(run: Run, name: str) -> dict[str, np.ndarray] | None:
    """A series as a dict of columns, None where the run has not written it or it has no rows."""
    if name not in run.series_names:
        return None
    series = run.series(name)
    return series if len(series["step"]) else None


def wet(run: Run) -> bool:
    """Whether there is water in a run, as far as its case tells."""
    return run.case.get("water", {}).get("scheme", {}).get("kind") != "none"


def wall_time(run: Run) -> float:
    """Wall time, s, of all pieces of a run that have told theirs."""
    pieces = run.info.get("pieces") or [run.info]
    return sum(piece.get("wall_s", 0.0) for piece in pieces)


def percent(share: float) -> str:
    """A share with as many digits as show it."""
    return f"{100 * share:.2g} %"


def moments(times: np.ndarray, wanted: Iterable[float]) -> list[int]:
    """Frames nearest to the ``wanted`` times that the run has reached; the thirds of the run if there are none."""
    if not len(times):
        return []
    slack = (times[-1] - times[0]) / max(len(times) - 1, 1) / 2
    reached = [time for time in wanted if time <= times[-1] + slack + 1e-9]
    reached = reached or [times[-1] * share for share in (1 / 3, 2 / 3, 1)]
    return sorted({int(abs(times - time).argmin()) for time in reached})


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


def published(run: Run) -> list[Published]:
    """The rows of reference.csv that are about this case; their first column names one or more, apart by spaces.

    None, where the file is a table of another kind, which happens to have the name. Raises InputError.
    """
    path = run.folder / "reference.csv"
    if not path.is_file():
        return []
    text = path.read_bytes().decode("utf-8-sig", errors="replace")  # editors of Windows begin a file with a mark
    lines = [line for line in text.splitlines(keepends=True) if line.strip() and not line.startswith("#")]
    rows, known = csv.DictReader(lines, restval=""), {field.name for field in fields(Published)} | {"case"}
    if not known <= set(rows.fieldnames or ()):
        return []
    return [
        Published(
            block=row["block"],
            quantity=row["quantity"],
            low=_number(path, row, "low"),
            high=_number(path, row, "high"),
            model=_number(path, row, "model"),
            unit=row["unit"],
            time=_number(path, row, "time"),
            source=row["source"],
        )
        for row in rows
        if run.info.get("case_name") in row["case"].split()
    ]


def _number(path, row, key):
    """The number in a column of a row, None where there is none."""
    try:
        value = float(row[key]) if row[key].strip() else None
    except ValueError:
        value = math.nan
    if value is not None and not math.isfinite(value):
        place = ", ".join(word for word in (row["case"], row["block"], row["quantity"]) if word)
        raise InputError(f"{path}: {place}: {key} = {row[key]!r}: must be a finite number, such as 0.18, or nothing")
    return value


def verdict(value: float | None, number: Published) -> str:
    """In words, where a measured value lies against the experiments."""
    if value is None or number.low is None or number.high is None:
        return "not compared"
    if number.low <= value <= number.high:
        return "inside the experiments' spread"
    nearest = number.low if value < number.low else number.high
    share = f" ({(value - nearest) / nearest:+.0%})" if nearest else ""
    return f"{abs(value - nearest):.3g} {number.unit} {'below' if value < nearest else 'above'}{share}"


MANY = 12  # bodies and more are told, drawn and named together


def flows_through(run: Run) -> bool:
    """Whether water comes in or goes out at a side: what it carries is no loss, nor made of nothing."""
    faces = run.case.get("box", {}).get("faces", {})
    return any(isinstance(face, dict) and face.get("kind") in ("inlet", "outlet") for face in faces.values())


def mean_profile(series: dict[str, np.ndarray], line: str, after: float) -> tuple[np.ndarray, np.ndarray]:
    """Heights, m, on a line of the series of velocities, and the mean velocity downstream there after a time, s."""
    here = (series["line"] == line) & (series["time"] >= after)
    z, row = np.unique(series["z"][here], return_inverse=True)
    count = series["particles"][here]
    return z, np.bincount(row, series["u"][here] * count) / np.bincount(row, count)
