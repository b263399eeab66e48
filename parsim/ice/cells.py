"""Floes cut from a whole cover: cells of a power diagram that grow and shrink until each holds its floe's area.

The line between two cells lies where the squared distances to both sites, less their weights, are equal; both keep half
of the gap from it (Aurenhammer 1987). Sites go to the centres of their cells (Lloyd 1982). Lengths in m, areas in m2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.ice.draw import area_of
from parsim.ice.outlines import Outlines, gaps, near

if TYPE_CHECKING:
    from parsim.ice.place import Region

ROUNDS = 300
_FAR = 2.4  # sites that cut each other are at most so many of their radii apart
_GROWTH = 0.2  # of the weight, m2, over the area that a cell lacks: a side's length over twice that between sites, 1.7
_KEPT = 0.8  # of the last change of weights: what is lacking far off comes sooner
_MOVE = 0.1  # of the way to the centre of its cell that a site goes in a round
_MOVES = 0.4  # share of the rounds after which sites stay where they are, for areas to come right
_EVERY = 10  # rounds after which neighbours are sought anew
_SHORT = 0.12  # of the root of the area: shorter sides are left out
_ROOM = 24  # corners of a cell at most, while it is cut


def cut(
    sites: np.ndarray, areas: np.ndarray, fixed: Outlines, region: Region, gap: float, rounds: int = ROUNDS
) -> list[np.ndarray] | None:
    """Convex polygons (k, 2) of these `areas` (n,) about `sites` (n, 2), a `gap` apart and off what is `fixed`, in the
    region; None where these areas are not reached."""
    x, y = sites.T.copy()
    radius = np.sqrt(areas / np.pi)
    weight, change = radius**2, np.zeros(len(x))
    for done in range(rounds):
        if done % _EVERY == 0:
            order, ranks = _neighbours(x, y, radius)
            walls = _lines_off(fixed, x, y, radius)
        cells = _cells(x, y, weight, order, ranks, walls, region, gap)
        held, cx, cy = _moments(*cells)
        if (held > areas).all():
            return [_plain(np.stack(cell, 1), area) for cell, area in zip(zip(*cells, strict=True), areas, strict=True)]
        some = (held > 0.0) & (done < _MOVES * rounds)
        x, y = np.where(some, x + _MOVE * (cx - x), x), np.where(some, y + _MOVE * (cy - y), y)
        change = _KEPT * change + _GROWTH * (areas * held.sum() / areas.sum() - held)
        weight = weight + change
    return None


def _neighbours(x, y, radius):
    """(for each site its neighbours, nearest first, in one row (m,); for each rank the sites that have so many, and
    where in the row that neighbour is)."""
    box = _FAR * radius[:, None] * np.array([[-1.0, 1.0, 1.0, -1.0]])
    tall = _FAR * radius[:, None] * np.array([[-1.0, -1.0, 1.0, 1.0]])
    i, j = near(Outlines(x[:, None] + box, y[:, None] + tall, x, y, radius, radius), 0.0)
    i, j = np.concatenate([i, j]), np.concatenate([j, i])
    order = np.lexsort((j, (x[j] - x[i]) ** 2 + (y[j] - y[i]) ** 2, i))
    i, j = i[order], j[order]
    first = np.searchsorted(i, np.arange(len(x) + 1))
    count = np.diff(first)
    ranks = []
    for rank in range(int(count.max(initial=0))):
        rows = np.flatnonzero(count > rank)
        ranks.append((rows, first[rows] + rank))
    return j, ranks


def _lines_off(fixed, x, y, radius):
    """Lines between sites and what is fixed: for each of these the sites near it, normal and level there."""
    found = []
    for row in range(len(fixed.cx)):
        one = fixed.take(np.array([row]))
        rows = np.flatnonzero((x - one.cx) ** 2 + (y - one.cy) ** 2 < (_FAR * radius + one.radius) ** 2)
        if not len(rows):
            continue
        point = Outlines(x[rows, None], y[rows, None], x[rows], y[rows], np.zeros(len(rows)), np.zeros(len(rows)))
        off = gaps(one.take(np.zeros(len(rows), int))._replace(round=np.zeros(len(rows))), point)
        found.append((rows, -off.nx, -off.ny, -(off.nx * x[rows] + off.ny * y[rows]) + off.apart))
    return found


def _cells(x, y, weight, order, ranks, walls, region, gap):
    """Corners x, y (n, k) of all cells."""
    n, half = len(x), 0.5 * gap
    (x0, y0), (x1, y1) = region
    px, py = np.tile([x0, x1, x1, x0], (n, 1)), np.tile([y0, y0, y1, y1], (n, 1))
    px, py = (np.concatenate([p, np.repeat(p[:, -1:], _ROOM - 4, axis=1)], axis=1) for p in (px, py))
    for rows, nx, ny, level in walls:
        px[rows], py[rows] = _cut(px[rows], py[rows], nx, ny, level - gap)
    for rows, where in ranks:
        other = order[where]
        dx, dy = x[other] - x[rows], y[other] - y[rows]
        length = np.maximum(np.sqrt(dx * dx + dy * dy), 1e-30)
        nx, ny = dx / length, dy / length
        along = 0.5 * (length + (weight[rows] - weight[other]) / length) - half
        px[rows], py[rows] = _cut(px[rows], py[rows], nx, ny, nx * x[rows] + ny * y[rows] + along)
    return px, py


def _cut(x, y, nx, ny, level):
    """What of polygons (n, k) lies where nx x + ny y <= level, with as many corners, the last repeated."""
    over = nx[:, None] * x + ny[:, None] * y - level[:, None]
    if not (over > 0.0).any():
        return x, y
    hit = np.flatnonzero((over > 0.0).any(axis=1))
    x, y = x.copy(), y.copy()
    px, py, over = x[hit], y[hit], over[hit]
    ahead = np.roll(over, -1, axis=1)
    inside, crosses = over <= 0.0, (over <= 0.0) != (ahead <= 0.0)
    inside &= (px != np.roll(px, -1, axis=1)) | (py != np.roll(py, -1, axis=1))
    share = np.where(crosses, over / np.where(crosses, over - ahead, 1.0), 0.0)
    keep = np.stack([inside, crosses], 2).reshape(len(hit), -1)
    count = keep.sum(axis=1)
    pick = np.minimum(np.arange(px.shape[1]), np.maximum(count - 1, 0)[:, None])
    place = np.take_along_axis(np.argsort(~keep, axis=1, kind="stable"), pick, axis=1)
    for into, p in ((x, px), (y, py)):
        corners = np.stack([p, p + share * (np.roll(p, -1, axis=1) - p)], 2).reshape(len(hit), -1)
        into[hit] = np.where(count[:, None] > 0, np.take_along_axis(corners, place, axis=1), p[:, :1])
    return x, y


def _moments(x, y):
    """Areas and centres (n,) of polygons (n, k)."""
    x0, y0 = x[:, :1], y[:, :1]
    u, v = x - x0, y - y0
    p, q = np.roll(u, -1, axis=1), np.roll(v, -1, axis=1)
    cross = u * q - p * v
    area = 0.5 * cross.sum(axis=1)
    safe = np.where(area > 0.0, 6.0 * area, 1.0)
    return area, x0[:, 0] + ((u + p) * cross).sum(axis=1) / safe, y0[:, 0] + ((v + q) * cross).sum(axis=1) / safe


def _plain(corners, area):
    """A polygon without its short sides, as far as it is large enough without, shrunk to this area about its centre."""
    made = corners[(corners != np.roll(corners, -1, axis=0)).any(axis=1)]
    while len(made) > 3:
        lengths = np.hypot(*(np.roll(made, -1, axis=0) - made).T)
        fewer = np.delete(made, int(lengths.argmin()), axis=0)
        if lengths.min() >= _SHORT * np.sqrt(area) or area_of(fewer - fewer[0]) < area:
            break
        made = fewer
    centre = np.array([float(part[0]) for part in _moments(made[None, :, 0], made[None, :, 1])[1:]])
    return centre + np.sqrt(area / area_of(made - centre)) * (made - centre)
