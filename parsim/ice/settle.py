"""Floes that overlap pushed apart, turned and moved, until all keep their gap: positions projected pair by pair.

As position-based dynamics does it (Müller et al. 2007), all pairs at once, with the mean of what a floe's pairs want.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.ice.outlines import Outlines, gaps, joined, moved, near

if TYPE_CHECKING:
    from parsim.ice.place import Region

_STEP = 1.3  # of the mean of what a floe's pairs want
_KEPT = 0.85  # of the last move: what is crowded spreads faster
_LOOK, _FALL = 100, 0.9  # rounds after which what is lacking must have fallen to this share of itself
_SKIN = 0.15  # of the mean radius: pairs are sought anew when something has moved half of it
_MORE = 0.02  # of the mean radius, that is aimed at beyond the gap


class Settled(NamedTuple):
    """Where floes have come to, x, y (n,), m, cosine and sine of their turn (n,), and who still lacks how much of the
    gap (n,), m."""

    x: np.ndarray
    y: np.ndarray
    cos: np.ndarray
    sin: np.ndarray
    lack: np.ndarray


def settle(own: Outlines, start: Settled, fixed: Outlines, region: Region, gap: float, rounds: int) -> Settled:
    """Floes with outlines `own`, about their centres, pushed apart and away from what is `fixed`, in a region.

    Ends after so many rounds, or when what is lacking hardly falls any more; then some still lack some.
    """
    n = len(own.cx)
    mean = float(own.radius.sum()) / n
    skin, more = _SKIN * mean, _MORE * mean
    goal = gap + more
    size = own.radius**2
    light = np.concatenate([1.0 / size, np.zeros(len(fixed.cx))])
    swing = np.concatenate([2.0 / size**2, np.zeros(len(fixed.cx))])  # 1 / inertia; a disc's
    x, y, cos, sin = (part.copy() for part in start[:4])
    drift = [np.zeros(n)] * 3
    far, pairs, best = np.inf, (np.zeros(0, int),) * 2, start
    least = np.inf
    for done in range(rounds):
        there = joined(moved(own, x, y, cos, sin), fixed)
        if far > 0.5 * skin:
            i, j = near(there, goal + skin)
            some, far = (i < n) | (j < n), 0.0
            pairs = i[some], j[some]
        lack, push = _pushes(there, pairs, light, swing, region, goal, more, n)
        if not (lack > more).any():
            return Settled(x, y, cos, sin, np.zeros(n))
        if done % _LOOK == 0:
            if (total := float(lack.sum())) > _FALL * least:
                break
            least = total
        drift = [_KEPT * old + new for old, new in zip(drift, push, strict=True)]
        dx, dy, turn = drift
        x, y = x + dx, y + dy
        half = 0.5 * turn
        c, s = (1.0 - half * half) / (1.0 + half * half), 2.0 * half / (1.0 + half * half)
        cos, sin = c * cos - s * sin, s * cos + c * sin
        far += float((np.abs(dx) + np.abs(dy) + own.radius * np.abs(turn)).max())
        best = Settled(x, y, cos, sin, np.maximum(lack - more, 0.0))
    return best


def _pushes(there, pairs, light, swing, region, goal, more, n):
    """(What each of n floes lacks of the goal, (n,), m; by how much to move and turn it: three arrays (n,))."""
    i, j = pairs
    dx, dy = there.cx[j] - there.cx[i], there.cy[j] - there.cy[i]
    close = dx * dx + dy * dy < (there.radius[i] + there.radius[j] + goal) ** 2
    i, j = i[close], j[close]
    found = gaps(there.take(i), there.take(j))
    short = goal - found.apart
    some = np.flatnonzero(short > 0.0)
    i, j, short = i[some], j[some], short[some]
    nx, ny, px, py = (part[some] for part in found[1:])
    arms = [(px - there.cx[k]) * ny - (py - there.cy[k]) * nx for k in (i, j)]
    give = light[i] + light[j] + arms[0] ** 2 * swing[i] + arms[1] ** 2 * swing[j]
    push = short / give
    rows, parts = (
        [i, j],
        [
            (-push * light[i] * nx, -push * light[i] * ny, -push * arms[0] * swing[i], short),
            (push * light[j] * nx, push * light[j] * ny, push * arms[1] * swing[j], short),
        ],
    )
    for part in _off_the_rim(there, light, swing, region, more, n):
        rows.append(part[0])
        parts.append(part[1:])
    row = np.concatenate(rows)
    mx, my, turn, lacks = (np.concatenate(column) for column in zip(*parts, strict=True))
    count = np.maximum(np.bincount(row, minlength=len(light)), 1)
    sums = [_STEP * np.bincount(row, weights, len(light))[:n] / count[:n] for weights in (mx, my, turn)]
    lack = np.zeros(len(light))
    np.maximum.at(lack, row, lacks)
    return lack[:n], sums


def _off_the_rim(there, light, swing, region, more, n):
    """The same parts for floes that reach out of the region: row, moves, turn and lack."""
    rows = np.arange(n)
    for axis, corner in enumerate((there.x, there.y)):
        for sign, level in ((1.0, region.low[axis]), (-1.0, region.high[axis])):
            deepest = (sign * corner[:n]).argmin(axis=1)
            lack = sign * level + more - sign * corner[rows, deepest]
            out = np.flatnonzero(lack > 0.0)
            px, py = there.x[out, deepest[out]] - there.cx[out], there.y[out, deepest[out]] - there.cy[out]
            nx, ny = (sign, 0.0) if axis == 0 else (0.0, sign)
            arm = px * ny - py * nx
            push = lack[out] / (light[out] + arm**2 * swing[out])
            yield out, push * light[out] * nx, push * light[out] * ny, push * arm * swing[out], lack[out]
