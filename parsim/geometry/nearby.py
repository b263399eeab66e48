"""What is near what: nothing here grows with the square of a number."""

import numpy as np

from parsim.machine.jit import kernel


@kernel
def near_points(points, place, reach, used):
    """Balls at `place` (b, 3) of radius `reach` (b,), m, that points (n, 3) are in: near[first[k]:first[k + 1]] of k.

    `used` (3,): the axes that count. Points are looked up by cells as wide as most balls: 300,000 points and 10,000
    balls took 4 s in a sweep along x.
    """
    count, near = np.zeros(len(points) + 1, np.int64), np.empty(0, np.int64)
    edge, low, number = 0.0, np.zeros(3), np.ones(3, np.int64)
    if len(place):
        edge = 2.0 * np.median(reach)
    for a in range(3):
        if used[a] and len(points) and edge > 0.0:
            low[a] = points[:, a].min()
            number[a] += int((points[:, a].max() - low[a]) / edge)
    key = np.empty(len(points), np.int64)
    for k in range(len(points)):
        key[k] = 0
        for a in range(3):
            key[k] = key[k] * number[a] + _cell(points[k, a], low[a], edge, number[a])
    order = np.argsort(key, kind="mergesort")
    key = key[order]
    begin, end = np.empty(3, np.int64), np.empty(3, np.int64)
    for again in range(2):
        for b in range(len(place)):
            for a in range(3):
                begin[a] = _cell(place[b, a] - reach[b], low[a], edge, number[a])
                end[a] = _cell(place[b, a] + reach[b], low[a], edge, number[a])
            for cx in range(begin[0], end[0] + 1):
                for cy in range(begin[1], end[1] + 1):
                    row = (cx * number[1] + cy) * number[2]
                    t = np.searchsorted(key, row + begin[2])
                    while t < key.size and key[t] <= row + end[2]:
                        k, square = order[t], 0.0
                        for a in range(3):
                            square += (points[k, a] - place[b, a]) ** 2 if used[a] else 0.0
                        if square < reach[b] * reach[b]:
                            if again:
                                near[count[k]] = b
                            count[k if again else k + 1] += 1
                        t += 1
        if not again:
            count = np.cumsum(count)
            near = np.empty(count[-1], np.int64)
    first = np.empty(len(points) + 1, np.int64)
    first[0], first[1:] = 0, count[:-1]
    return first, near


@kernel
def _cell(x, low, edge, number):
    """Cell of x among `number` of width `edge` from `low` on, the outermost for what lies beyond."""
    return min(max(int((x - low) / edge), 0), number - 1) if number > 1 else 0


@kernel
def near_bodies(position, span, period):
    """Bodies whose balls of radius `span` (b,), m, meet: others[first[b]:first[b + 1]] of b; period (3,), m."""
    count, period_x = len(position), period[0]
    along = position[:, 0].copy()
    if period_x < np.inf:
        along -= period_x * np.floor(along / period_x)
    order, widest = np.argsort(along, kind="mergesort"), 0.0
    for b in range(count):
        widest = max(widest, span[b])
    first, others = np.zeros(count + 1, np.int64), np.empty(0, np.int64)
    for again in range(2):
        fill = first[:-1].copy()
        for row in range(count):
            b = order[row]
            for step in range(1, count):
                other = (row + step) % count
                around = period_x if row + step >= count else 0.0
                if around == np.inf:
                    break
                c = order[other]
                dx = along[c] + around - along[b]
                if dx > span[b] + widest or dx > 0.5 * period_x:
                    break
                dy, dz = position[c, 1] - position[b, 1], position[c, 2] - position[b, 2]
                if period[1] < np.inf:
                    dy -= period[1] * np.rint(dy / period[1])
                if dx * dx + dy * dy + dz * dz < (span[b] + span[c]) ** 2:
                    for one, two in ((b, c), (c, b)):
                        if again:
                            others[fill[one]] = two
                            fill[one] += 1
                        else:
                            first[one + 1] += 1
        if not again:
            first = np.cumsum(first)
            others = np.empty(first[-1], np.int64)
    return first, others
