"""Floes of a plane in a row along x: any order, any gaps, all as likely as each other. Lengths in m."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.ice.draw import evenly

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from parsim.ice.draw import Floe

_ROW = 3  # part of a floe's counter


def row(
    floes: Sequence[Floe], low: float, high: float, blocked: Iterable[tuple[float, float]], gap: float
) -> list[float | None]:
    """Centres of floes from `low` to `high`, a gap from each other and from what is blocked, (from, to); None of those
    for which no room is left."""
    free = [[start, end, end - start] for start, end in _free(low, high, blocked, gap)]  # with the room left
    dice = [evenly(floe.key, _ROW, 3) for floe in floes]
    held: list[list[int]] = [[] for _ in free]
    for number in sorted(range(len(floes)), key=lambda k: (-floes[k].size, k)):
        size = floes[number].size
        rooms = [room if size <= room + 1e-12 * high else 0.0 for _, _, room in free]
        rest, chosen = dice[number][0] * sum(rooms), None
        for part, room in enumerate(rooms):
            if room > 0.0 and rest <= room:
                chosen = part
                break
            rest -= room
        if chosen is not None:
            held[chosen].append(number)
            free[chosen][2] -= size + gap
    centres: list[float | None] = [None] * len(floes)
    for (start, _, room), numbers in zip(free, held, strict=True):
        numbers.sort(key=lambda k: dice[k][1])
        slack = max(room + gap, 0.0)
        for number, off in zip(numbers, sorted(slack * dice[k][2] for k in numbers), strict=True):
            centres[number] = start + off + 0.5 * floes[number].size
            start += floes[number].size + gap
    return centres


def _free(low, high, blocked, gap):
    """What is left from `low` to `high`."""
    for first, last in sorted(blocked):
        if first - gap > low:
            yield low, min(first - gap, high)
        low = max(low, last + gap)
        if low >= high:
            return
    yield low, high
