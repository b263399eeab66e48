"""HEC-RAS geometry (.g01 to .g99): the cross-sections of a reach, read from fields of fixed width.

Numbers fill their 8 columns (16 in cut lines) and then run together: "     13592.39202" is 135 and 92.39202.
"""

from __future__ import annotations

import itertools
import math
import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.errors import InputError, nearest, suggestion
from parsim.terrain import sections

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from parsim.terrain.triangles import Triangles

_SECTION = "1"  # the type of a node that is a cross-section; others are culverts, bridges and weirs
_WIDTHS = {"#Sta/Elev": (8, 2), "#Mann": (8, 3), "XS GIS Cut Line": (16, 2)}  # columns, numbers of an entry
Node = tuple[int, list[str], list[str]]  # line number, words of its head, lines


class Section(NamedTuple):
    """A cross-section, seen downstream, in the units of its file: river station; length of the channel to the next one
    downstream; stations (n,) from left to right and elevations (n,); left and right bank station; Manning's n (m, 2) by
    the station from which it holds; cut line (k, 2) on the map, empty if not given; ice, the values of its keys."""

    river_station: float
    length: float
    station: np.ndarray
    elevation: np.ndarray
    banks: tuple[float, float]
    manning: np.ndarray
    cut: np.ndarray
    ice: dict[str, tuple[float, ...]]


def read(path: Path, reach: str | None = None) -> list[Section]:
    """The sections of a reach, "River, Reach", in order downstream; of the only one if left out. Raises InputError."""
    found = dict(_reaches(path))
    if not found:
        raise InputError(f'{path}: holds no cross-section, "Type RM Length L Ch R = 1"; is it HEC-RAS geometry?')
    if reach is None and len(found) > 1:
        raise InputError(f"{path}: has {len(found)} reaches; name one of {'; '.join(found)}")
    names = {_plain(name): name for name in found}
    name = next(iter(found)) if reach is None else names.get(_plain(reach))
    if name is None:
        hint = suggestion(nearest(reach or "", found))
        raise InputError(f'{path}: has no reach "{reach}"; allowed: {"; ".join(found)}{hint}')
    nodes = [_section(path, *node) for node in found[name]]
    _ordered(path, nodes)
    return nodes


def surface(path: Path, layout: str, reach: str | None) -> Triangles:
    """The ground between the sections: "straight", see `sections.straight`, or where the cut lines are, "map"."""
    nodes = read(path, reach)
    bare = [f"{node.river_station:g}" for node in nodes if len(node.cut) < 2]
    if layout == "map" and bare:
        raise InputError(f'{path}: section {bare[0]} has no cut line on the map; use layout = "straight"')
    return sections.straight(nodes) if layout == "straight" else sections.on_map(nodes)


def _plain(name):
    return ",".join(part.strip() for part in name.split(",")).lower()


def _reaches(path):
    """Yield ("River, Reach", [Node] of its cross-sections)."""
    name, nodes = "", list[Node]()
    lines = path.read_text(encoding="utf-8-sig", errors="replace").split("\n")
    for number, line in enumerate(lines, 1):
        key, _, value = line.partition("=")
        if key.strip() == "River Reach":
            if nodes := _of_sections(nodes):
                yield name, nodes
            name, nodes = ", ".join(part.strip() for part in value.split(",")), []
        elif key.strip() == "Type RM Length L Ch R":
            head = [part.strip() for part in value.split(",")]
            nodes.append((number, head, []))
        elif nodes:
            nodes[-1][2].append(line.rstrip("\r"))
    if nodes := _of_sections(nodes):
        yield name, nodes


def _of_sections(nodes: list[Node]) -> list[Node]:
    return [node for node in nodes if node[1][0] == _SECTION]


def _section(path, number, head, lines):
    place = f"{path}: section {head[1] if len(head) > 1 else '?'} (line {number})"
    try:
        river_station = float(head[1].rstrip("*"))
        length = float(head[3]) if len(head) > 3 and head[3] else 0.0
    except (IndexError, ValueError):
        raise InputError(f"{place}: Type RM Length L Ch R = {','.join(head)}: must be 1, station, L, Ch, R") from None
    blocks, ice, banks = {}, {}, None
    told = False  # in a description, which may say anything
    for at, line in enumerate(lines):
        key, equals, value = line.partition("=")
        key = key.strip()
        told = (told or key.startswith("BEGIN DESCRIPTION")) and not key.startswith("END DESCRIPTION")
        if told or not equals:
            continue
        if key in _WIDTHS:
            blocks[key] = _fields(place, key, value, lines[at + 1 :])
        elif key == "Bank Sta":
            banks = _numbers(place, key, value)
        elif key.startswith("Ice "):
            ice[key] = _numbers(place, key, value)
    profile = blocks.get("#Sta/Elev", np.zeros((0, 2)))
    if len(profile) < 2:
        raise InputError(f"{place}: #Sta/Elev has {len(profile)} points; must have two or more")
    back = np.flatnonzero(np.diff(profile[:, 0]) < 0.0)
    if len(back):
        one, other = profile[back[0] : back[0] + 2, 0]
        raise InputError(f"{place}: #Sta/Elev: station {other:g} comes after {one:g}; stations must ascend")
    low, high = profile[0, 0], profile[-1, 0]
    if banks is None or len(banks) != 2 or not low <= banks[0] < banks[1] <= high:
        raise InputError(f"{place}: Bank Sta = {banks}: must be two stations, left and right, from {low:g} to {high:g}")
    manning = blocks.get("#Mann", np.zeros((0, 3)))[:, :2]
    cut = blocks.get("XS GIS Cut Line", np.zeros((0, 2)))
    return Section(river_station, length, profile[:, 0], profile[:, 1], banks, manning, cut, ice)


def _fields(place, key, value, lines):
    """The numbers (n, k) that follow a line "key= n", in fields of fixed width."""
    width, each = _WIDTHS[key]
    try:
        count = int(value.split(",")[0])
    except ValueError:
        raise InputError(f"{place}: {key}= {value.strip()}: must begin with a whole number") from None
    words: list[str] = []
    for line in lines:
        if len(words) >= count * each:
            break
        words += _cut(line.rstrip(), width)
    try:
        numbers = [float(word or 0.0) if key == "#Mann" else float(word) for word in words[: count * each]]
    except ValueError as error:
        raise InputError(f"{place}: {key}: a field of {width} columns is no number: {error}") from None
    if len(numbers) != count * each:
        raise InputError(f"{place}: {key}: holds {len(numbers)} numbers; {count} entries need {count * each}")
    if not np.isfinite(numbers).all():
        raise InputError(f"{place}: {key}: holds {next(n for n in numbers if not math.isfinite(n))}; must be finite")
    return np.array(numbers, float).reshape(count, each)


def _cut(line: str, width: int) -> Iterator[str]:
    """The fields of a line."""
    for at in range(0, len(line), width):
        yield line[at : at + width].strip()


def _numbers(place, key, value):
    """The numbers that follow a key, between commas."""
    try:
        return tuple(float(word) for word in re.split(r"\s*,\s*", value.strip()) if word)
    except ValueError:
        raise InputError(f"{place}: {key}={value}: must be numbers") from None


def _ordered(path, nodes):
    """Refuse sections that are not in order downstream, or of which one has no length to the next."""
    for upper, lower in itertools.pairwise(nodes):
        if not upper.river_station > lower.river_station:
            raise InputError(
                f"{path}: sections are out of order: {lower.river_station:g} comes after {upper.river_station:g}; "
                "river stations must descend, from upstream to downstream"
            )
        if not 0.0 < upper.length < math.inf:
            raise InputError(
                f"{path}: section {upper.river_station:g}: the length of its channel to section "
                f"{lower.river_station:g} is {upper.length:g}; must be greater than 0 and finite"
            )
    if len(nodes) < 2:
        raise InputError(f"{path}: has one cross-section, {nodes[0].river_station:g}; a reach needs two or more")
