"""`parsim new --from FILE`: a case of still water over the ground in a file, cut to where it is wet."""

import json
import math
import shutil
from pathlib import Path
from typing import NamedTuple

import numpy as np

from parsim import __version__, terrain
from parsim.case import model
from parsim.errors import InputError, WriteError
from parsim.terrain import hecras, sections
from parsim.terrain.frame import Frame

GRAVITY = 9.81  # m/s2
_LOOKS = 401  # places along and across, at least, at which the ground is looked at first
_ROWS = 10  # particles over the greatest depth, where no spacing is asked for
_MOST = 10**7  # heights of a bed: its field has several nodes under each
_BANK = 4  # spacings of dry bank beside the water, and of ground under it: what the water sees


class Asked(NamedTuple):
    """What of the reach is wanted: river stations of sections, else x in the file, None for its ends; spacing, m;
    level of the water in the file; "River, Reach" of sections; m of one unit of the file."""

    first: float | None = None
    last: float | None = None
    spacing: float | None = None
    level: float | None = None
    river_reach: str | None = None
    scale: float = 1.0


class _Cut(NamedTuple):
    """The box of a reach: spacing, m; origin and datum in the file; counts of spacings (x, y, level, top); whether
    there is water where the ground ends."""

    spacing: float
    origin: tuple
    datum: float
    counts: tuple
    held: bool


def roughness(manning: float) -> float:
    """Equivalent sand roughness ks, m, of Manning's n, s/m^(1/3): n = ks^(1/6) / (8.1 sqrt(g)) (Strickler 1923)."""
    return (8.1 * math.sqrt(GRAVITY) * manning) ** 6


def new_reach(name: str, source: Path, asked: Asked) -> None:
    """Write the folder NAME with case.toml and the file of its ground; never overwrites.

    Raises InputError for what cannot be made of the file, WriteError where the folder cannot be written.
    """
    folder = Path(name)
    if folder.exists():
        raise InputError(f"NAME = {name}: {folder} exists already and is not overwritten; choose another name")
    surface = terrain.read(source, "straight", asked.river_reach)
    nodes = hecras.read(source, asked.river_reach) if terrain.sections_in(source) else []
    ends = _ends(surface, nodes, asked)
    box = _cut(surface, nodes, ends, asked)
    n = sections.manning(nodes, *ends) if nodes else None
    part = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(part, ignore_errors=True)  # of one that was killed
    try:
        part.mkdir(parents=True)
        shutil.copy(source, part / source.name)
        (part / "case.toml").write_text(_text(source.name, asked, box, n), encoding="utf-8")
        model.load(part / "case.toml")
        part.rename(folder)
    except OSError as error:
        raise WriteError(folder, error.strerror or error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
    nx, ny, level, top = box.counts
    print(f"a box of {nx * box.spacing:g} x {ny * box.spacing:g} x {top * box.spacing:g} m, spacing {box.spacing:g} m")
    if box.held:
        print("beside the water the ground ends, or has holes: there a side of the box holds the water")
    if n is not None:
        print(
            f"Manning's n {n:.4g} between the banks is a roughness ks of {roughness(n):.4g} m: "
            "n = ks^(1/6) / (8.1 sqrt(g))"
        )
    print(f"wrote {folder / 'case.toml'} and {folder / source.name}; next: parsim check {folder / 'case.toml'}")


def _ends(surface, nodes, asked):
    """Where the reach begins and ends along x, in the file."""
    known = [node.river_station for node in nodes] or [surface.low[0], surface.high[0]]
    first, last = (end if given is None else given for end, given in ((known[0], asked.first), (known[-1], asked.last)))
    for key, value in (("--from-station", first), ("--to-station", last)):
        if not min(known) <= value <= max(known):
            raise InputError(f"{key} {value:.10g}: must be from {known[0]:.10g} to {known[-1]:.10g}")
    ends = [sections.place_of(nodes, station) for station in (first, last)] if nodes else [first, last]
    if not ends[0] < ends[1]:
        raise InputError(f"--to-station {last:.10g}: must be downstream of --from-station {first:.10g}")
    return ends


def _cut(surface, nodes, ends, asked):
    """The box around the water at the level that is asked for."""
    scale = asked.scale
    y, z, whole = _looked(surface, nodes, ends, asked.spacing / scale if asked.spacing else math.inf)
    if asked.level is not None and not math.isfinite(asked.level):
        raise InputError(f"--level {asked.level:g}: must be a finite number")
    lowest, highest = float(np.nanmin(z)), float(np.nanmax(z))
    if asked.level is None:
        banks = [np.interp(node.banks, node.station, node.elevation).min() for node in nodes]
        said = f", the banks from {min(banks):.6g}" if banks else ""
        raise InputError(
            f"--level: missing; the level of the water, a height in the file, whose ground reaches from {lowest:.6g} "
            f"to {highest:.6g}{said}"
        )
    if asked.level <= lowest:
        raise InputError(
            f"--level {asked.level:g}: is not over the ground, which reaches from {lowest:.6g} to {highest:.6g}"
        )
    spacing = asked.spacing or _nice(scale * (asked.level - lowest) / _ROWS)
    unit = spacing / scale
    y, z, whole = _looked(surface, nodes, ends, unit)
    lowest = float(np.nanmin(z))
    low, high = _wet(z, y, asked.level)
    held = low < y[whole[0]] or high > y[whole[-1]]
    low, high = max(low - _BANK * unit, y[whole[0]]), min(high + _BANK * unit, y[whole[-1]])
    nx, ny = math.floor((ends[1] - ends[0]) / unit + 1e-6), math.floor((high - low) / unit + 1e-6)
    if min(nx, ny) < 1:
        raise InputError(
            f"--spacing {spacing:g}: the reach is {scale * (ends[1] - ends[0]):g} m long, its ground without holes "
            f"{scale * (high - low):g} m wide; must be less"
        )
    if nx * ny > _MOST:
        raise InputError(f"--spacing {spacing:g}: makes a bed of {nx} x {ny} heights; at most {_MOST:g}")
    under = math.ceil((asked.level - lowest) / unit - 1e-6) + _BANK
    datum = asked.level - under * unit
    frame = Frame((ends[0], low), 0.0, datum, scale)
    ground = surface.on(spacing * np.arange(nx + 1), spacing * np.arange(ny + 1), frame).z
    if np.isnan(ground).any():
        i, j = np.argwhere(np.isnan(ground))[0]
        raise InputError(
            f"--from: no data at {np.isnan(ground).sum()} of {ground.size} places in the box, such as "
            f"x = {ends[0] + i * unit:.10g}, y = {low + j * unit:.10g} in the file; fill them in it, or choose "
            "other stations"
        )
    top = max(math.ceil(ground.max() / spacing), under + (under - _BANK + 1) // 2)
    return _Cut(spacing, frame.origin, datum, (nx, ny, under, top), held)


def _looked(surface, nodes, ends, step):
    """Places y (ny,) across a reach, the ground (nx, ny) there, and which y have no hole along x, all in the file.

    They are a `step` apart, or less fine if that makes too many. Raises InputError where every y has holes.
    """
    inside = [way for way in (sections.chainage(nodes) if nodes else ()) if ends[0] < way < ends[1]]
    counts = [max(_LOOKS, math.ceil(span / step) + 1) for span in (ends[1] - ends[0], surface.high[1] - surface.low[1])]
    if math.prod(counts) > _MOST:
        counts = [_LOOKS, _LOOKS]
    x = np.unique([*np.linspace(ends[0], ends[1], counts[0]), *inside])
    y = np.linspace(surface.low[1], surface.high[1], counts[1])
    z = surface.on(x, y, Frame()).z
    whole = np.flatnonzero(~np.isnan(z).any(axis=0))
    if not len(whole):
        raise InputError("--from: there is no strip along x without holes in the ground; choose other stations")
    return y, z, whole


def _wet(z, y, level):
    """From where to where across there is water that is one with that over the lowest ground of its section.

    Infinite where the ground ends before the water.
    """
    low, high = list[float](), list[float]()
    for row in z:
        dry = ~(row < level)
        at = int(np.nanargmin(np.where(np.isnan(row), np.inf, row)))
        if dry[at]:
            continue
        for ends, open_end, beside in (
            (low, -math.inf, np.flatnonzero(dry[:at])[::-1]),
            (high, math.inf, at + np.flatnonzero(dry[at:])),
        ):
            ends.append(y[beside[0]] if len(beside) and not np.isnan(row[beside[0]]) else open_end)
    return min(low), max(high)


def _nice(value):
    """The largest of 1, 2 and 5 times a power of ten that is at most `value`, give or take a hundredth."""
    power = 10.0 ** math.floor(math.log10(1.01 * value))
    return max(round(step * power, 12) for step in (1.0, 2.0, 5.0) if step * power <= 1.01 * value)


def _text(file, asked, box, n):
    nx, ny, level, top = (round(count * box.spacing, 9) for count in box.counts)
    depth = (box.counts[2] - _BANK) * box.spacing
    keys = {
        "file": json.dumps(file, ensure_ascii=False),
        "scale": repr(float(asked.scale)),
        "origin": f"[{float(box.origin[0])!r}, {float(box.origin[1])!r}]",
        "datum": repr(round(float(box.datum), 9)),
    }
    if asked.river_reach:
        keys["river_reach"] = json.dumps(asked.river_reach, ensure_ascii=False)
    rough = "" if n is None else f"roughness = {roughness(n):.4g}{'':23}# ks, m, of Manning's n = {n:.4g}\n"
    friction = "" if n is None else 'friction = {kind = "wall_law", walls = []}    # of the bed alone\n'
    return (
        "#:schema ./case.schema.json\n"
        f"# Still water over the ground of {json.dumps(file)}, made by parsim {__version__}.\n"
        "# SI units; x downstream, y to the left, z up.\n"
        f"title = {json.dumps('Reach of ' + file, ensure_ascii=False)}\n"
        f"dimensions = 3\nspacing = {box.spacing!r}\n\n[box]\nmax = [{nx!r}, {ny!r}, {top!r}]\n\n"
        "[bed]                                   # it stands in the box as a fixed body\n"
        + "".join(f"{key} = {value}\n" for key, value in keys.items())
        + 'nodata = "refuse"                       # or "nearest", "linear": fill holes\n\n[water]\n'
        f"speed = {round(2.0 * math.sqrt(GRAVITY * depth), 3)!r}     # largest expected speed, m/s\n"
        f"{friction}"
        f"fill = [{{min = [0.0, 0.0, 0.0], max = [{nx!r}, {ny!r}, {level!r}]}}]    # the bed is cut out of it\n\n"
        "[materials.bed]\nyoung = 1e9\npoisson = 0.3\nfriction = 0.5\nrestitution = 0.3\n"
        f"{rough}\n[run]\nuntil = 1.0\n"
    )
