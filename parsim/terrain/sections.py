"""The ground between cross-sections, which are aligned by their bank stations, and what holds along a reach.

A place on a section is a number t: 0 to 1 on the left overbank, 1 to 2 between the banks, 2 to 3 on the right overbank.
Between two sections the ground goes straight from each t to the same t.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.terrain.triangles import Triangles

if TYPE_CHECKING:
    from collections.abc import Sequence

    from parsim.terrain.hecras import Section

_ACROSS, _ALONG = 32, 8  # cuts of each third of a section, and of the way to the next: a twisted strip is not flat


def straight(nodes: Sequence[Section]) -> Triangles:
    """The reach laid straight: x along the channel from the first section on, y to the left from between the banks."""
    way = chainage(nodes)
    return _strips(nodes, lambda k, station: (np.full(station.shape, way[k]), sum(nodes[k].banks) / 2.0 - station))


def on_map(nodes: Sequence[Section]) -> Triangles:
    """The reach where its cut lines lie: stations run evenly along each of them, from its first point to its last."""

    def place(k, station):
        node, line = nodes[k], nodes[k].cut
        run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
        share = (station - node.station[0]) / (node.station[-1] - node.station[0])
        return tuple(np.interp(share * run[-1], run, line[:, axis]) for axis in range(2))

    return _strips(nodes, place)


def chainage(nodes: Sequence[Section]) -> np.ndarray:
    """Distance (n,) of each section along the channel from the first."""
    return np.concatenate([[0.0], np.cumsum([node.length for node in nodes[:-1]])])


def place_of(nodes: Sequence[Section], river_station: float) -> float:
    """Distance along the channel from the first section of a river station, between sections in proportion."""
    stations = np.array([node.river_station for node in nodes])
    return float(np.interp(-river_station, -stations, chainage(nodes)))


def manning(nodes: Sequence[Section], first: float, last: float) -> float | None:
    """Mean Manning's n between the banks of the sections from one distance to another, None where none has it."""
    way = chainage(nodes)
    inside = [node for node, x in zip(nodes, way, strict=True) if first <= x <= last]
    inside = inside or [nodes[int(np.abs(way - 0.5 * (first + last)).argmin())]]
    found = [_of_channel(node) for node in inside if len(node.manning)]
    return float(np.mean(found)) if found else None


def _of_channel(node):
    """Mean n between the banks of a section, by the widths on which values hold."""
    begin = np.clip(node.manning[:, 0], *node.banks)
    begin[0] = node.banks[0]
    width = np.diff(begin, append=node.banks[1])
    return float((node.manning[:, 1] * width).sum() / width.sum())


def _strips(nodes, place):
    """Triangles between each section and the next; `place`(k, station) gives x and y of stations of section k."""
    points, triangles, first = [], [], 0
    for k in range(len(nodes) - 1):
        shares = [_shares(node) for node in nodes[k : k + 2]]
        t, ends = np.unique(np.concatenate([*shares, np.linspace(0.0, 3.0, 3 * _ACROSS + 1)])), []
        for n, node, own in zip((k, k + 1), nodes[k : k + 2], shares, strict=True):
            x, y = place(n, np.interp(t, own, node.station))
            ends.append(np.stack([x, y, np.interp(t, own, node.elevation)], -1))
        share = np.linspace(0.0, 1.0, _ALONG + 1)[:, None, None]
        points.append(((1.0 - share) * ends[0] + share * ends[1]).reshape(-1, 3))
        node = first + np.arange((_ALONG + 1) * len(t)).reshape(-1, len(t))
        a, b, c, d = (part.ravel() for part in (node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]))
        triangles += [np.stack([a, b, d], -1), np.stack([d, b, c], -1)]
        first += node.size
    return Triangles(np.concatenate(points), np.concatenate(triangles))


def _shares(node):
    """t (n,) of the points of a section; of points above each other the second comes a little later."""
    marks = [node.station[0], *node.banks, node.station[-1]]
    count = [0.0, 1.0, 2.0, 3.0]
    if marks[0] == marks[1]:  # a section without an overbank begins or ends at its bank
        marks, count = marks[1:], count[1:]
    if marks[-2] == marks[-1]:
        marks, count = marks[:-1], count[:-1]
    t = np.interp(node.station, marks, count)
    return np.maximum.accumulate(t + 1e-12 * np.arange(len(t)))
