"""What the report says in words and tables."""

import platform

import matplotlib
import numpy as np

from parsim.report import measures
from parsim.report.budgets import LEAKS
from parsim.report.page import table

LIMIT_NAMES = {"wall_s": "wall time (s)", "steps": "steps", "ranks": "ranks", "threads": "threads per rank"}


def summary(run):
    """A few lines that say how the run went."""
    info = run.info
    lines = [f"Status: {info.get('status', 'unknown')}."]
    if "steps" in info and "time" in info:
        lines.append(f"Simulated to {info['time']:.4g} s in {info['steps']} steps: {info.get('wall_s', 0):.4g} s of "
                     f"wall time on {info.get('ranks', '?')} ranks x {info.get('threads', '?')} threads.")  # fmt: skip
    if particles := info.get("particles"):
        lines.append("Particles: " + ", ".join(f"{count} {kind}" for kind, count in particles.items()) + ".")
    arrival = measures.front_arrival(run)
    if arrival is not None:
        lines.append(f"The front reached the end wall at {arrival:.3f} s.")
    if (energy := measures.columns(run, "energy")) is not None:
        created = measures.energy_created(energy)[1]
        lines.append(f"Energy created, at most: {_percent(np.max(created, initial=0.0))} of that at the start.")
    if (counts := measures.columns(run, "counts")) is not None:
        drift = np.max(np.abs(counts["volume"] / counts["volume"][0] - 1))
        leaks = [f"{counts[name].max()} {name.replace('_', ' ')}" for name in LEAKS if name in counts]
        lines.append(f"Volume within {_percent(drift)} of its first value; particles at most " + ", ".join(leaks) + ".")
    if info.get("warnings"):
        lines.append(f"Warnings: {len(info['warnings'])}, listed below.")
    return lines


def _percent(share):
    """A share with as many digits as show it."""
    return f"{100 * share:.2g} %"


def compared(run):
    """Tables of what is measured here beside what is published, and of the bodies."""
    rows, end = [], measures.compared_until(run)
    for number in measures.published(run):
        value = measures.measured(run, number)
        spread = [f"{end:g}" for end in dict.fromkeys((number.low, number.high)) if end is not None]
        short = number.quantity.startswith("max X") and number.time is not None and end < number.time
        quantity = f"{number.quantity} (here to {end:.3g} s)" if short else number.quantity
        rows.append((quantity, number.block or "-", number.unit, value, " to ".join(spread) or "not quoted",
                     number.model, measures.verdict(value, number), number.source))  # fmt: skip
    titles = ("quantity", "body", "unit", "here", "experiments", "published model", "against the experiments", "source")
    places = [f"X at {time:g} s (m)" for time in measures.LEVELS]
    of_bodies = ("body", "draught before release (m)", "by Archimedes (m)", *places, f"largest X to {end:.3g} s (m)",
                 "when (s)")  # fmt: skip
    return table(titles, rows) + table(of_bodies, bodies(run))


def bodies(run):
    """One row for each body: draught, places, largest x."""
    rows = []
    for name, track in measures.body_tracks(run).items():
        places = [measures.at_time(track, "x", time) for time in measures.LEVELS]
        best = measures.largest_x(track) or (None, None)
        rows.append((name, measures.draught(run, name, track), measures.archimedes_draught(run, name), *places, *best))
    return rows


def speed(run):
    """Rates and times as rows."""
    info = run.info
    rows = [(LIMIT_NAMES[key], info[key]) for key in LIMIT_NAMES if key in info]
    rows += [(key.replace("_", " "), value) for key, value in _flat(info.get("rate") or {})]
    if info.get("wall_s") and info.get("time"):
        rows.append(("wall seconds per simulated second", info["wall_s"] / info["time"]))
    return rows


def _flat(values, before=""):
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{key} ")
        else:
            yield before + key, value


def versions(run, pictures):
    """Versions of the run and of what made this page."""
    info = run.info
    rows = [("parsim", info.get("parsim", "unknown")), *(info.get("versions") or {}).items()]
    rows += [(key, info[key]) for key in ("kernel", "host", "started") if key in info]
    return [*rows, ("report", f"Python {platform.python_version()}, matplotlib {matplotlib.__version__}, "
                    f"pictures by {pictures}")]  # fmt: skip
