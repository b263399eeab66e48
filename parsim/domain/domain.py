"""Slabs of whole cell layers: who owns what, halos, migration, balance, exact sums.

Models know three verbs of a domain: `refresh(*fields)`, `sum`, `max`; they never see a rank. Memory of a rank reads
left halo | owned | right halo, each sorted by (cell, layer, id), so that a particle meets its neighbours in the same
order on any number of ranks.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from parsim.domain import exact_sums
from parsim.domain.balance import accumulate, even_cuts, uneven
from parsim.domain.images import Images
from parsim.domain.slab import Slab
from parsim.machine.timers import Timers
from parsim.particles.cells import HALO, LAYERS, REACH, Stack, holding, occupied, sort_by_cell, sort_key, spread
from parsim.particles.state import POSITION, Particles

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from parsim.domain.comm import Comm
    from parsim.domain.slab import Source
    from parsim.particles.cells import Grid
    from parsim.particles.state import Field

_UNEVEN = 1.005  # largest work of a rank over the mean that leaves the cuts alone


class Domain:
    """One rank's slab. `sources` give it samples of what is solid, `fields` are those of its particles.

    `particles` holds halos and owned, `own` the slice of owned ones, `stack` the pieces they are stored in, `first` the
    offsets of the cells of all pieces, `border` (owned,) bool those that may see a halo. `uneven` is the largest work
    of a rank over the mean, as `balance` has seen it last. `lost` counts this rank's particles that have left the grid,
    `gone` are those that the last rebuild has found outside.
    """

    def __init__(
        self, grid: Grid, comm: Comm, sources: Sequence[Source], fields: tuple[Field, ...], timers: Timers | None = None
    ) -> None:
        self.grid, self.comm, self.sources, self._fields = grid, comm, sources, fields
        self.timers = timers or Timers()
        self.uneven = 1.0
        self.cuts = even_cuts(np.ones(grid.layers), comm.size)
        self.lost = 0
        self._buffers: dict[str, np.ndarray] = {}

    @property
    def layers(self) -> tuple[int, int]:
        """First layer owned and the one past the last."""
        return int(self.cuts[self.comm.rank]), int(self.cuts[self.comm.rank + 1])

    def owns(self, x: np.ndarray) -> np.ndarray:
        """Which of the points x (n,) lie in this rank's slab: bool (n,)."""
        layer = self.grid.layer(x)
        return (layer >= self.layers[0]) & (layer < self.layers[1])

    def rebuild(self, fluid: Particles, time: float) -> None:
        """Take the owned fluid (Particles), migrate it, add boundary samples and images, sort, fill the halos.

        Before: `fluid` may lie anywhere. After: `particles`, `own`, `first` and the halo slices are new, and all
        earlier indices are void.
        """
        fluid = self._migrate(self._wrap(fluid))
        slab = Slab(self.grid, *self.layers, self._awake(fluid))
        parts = [fluid, *(source.samples(slab, time) for source in self.sources)]
        self._assemble(self._with_images(parts))

    def refresh(self, *names: str) -> None:
        """Bring `names` up to date in the images and halos."""
        with self.refreshing(*names):
            pass

    @contextmanager
    def refreshing(self, *names: str) -> Iterator[None]:
        """The same, with the halos only up to date at the end of the block, which runs while the messages travel.

        The block may not write the fields `names`, nor look at them in a halo.
        """
        p = self.particles
        with self.timers("halo"):
            self._images.copy(p, names)
            ends = (slice(0, self.own.start), slice(self.own.stop, len(p)))
            out = [np.stack([getattr(p, name)[at] for name in names]).astype(float, copy=False) for at in self._send]
            back = [np.empty((len(names), at.stop - at.start)) for at in ends]
            requests = self.comm.start(*out, *back)
        yield
        with self.timers("halo"):
            self.comm.wait(requests)
            for at, values, shift in zip(ends, back, (self._period_left, self._period_right), strict=True):
                for name, row in zip(names, values, strict=True):
                    getattr(p, name)[at] = row + shift if name == "x" else row

    def near(self, value: int, name: str) -> np.ndarray:
        """Which particles may have a neighbour whose field `name` is `value`, by cells: bool (particles,)."""
        marks = holding(value, getattr(self.particles, name), self.first).reshape(-1, *self.grid.count[1:])
        columns = np.maximum.reduceat(marks, self.stack.pieces[:-1])
        marks = spread(columns, REACH)[self.stack.column].ravel()
        return np.repeat(marks.view(bool), np.diff(self.first))

    def sum(
        self,
        values: np.ndarray,
        units: np.ndarray | float,
        index: np.ndarray | None = None,
        count: int = 1,
        also: np.ndarray | None = None,
    ) -> np.ndarray:
        """Exact sums over all ranks of values (n, c): (c,), or (count, c) by row `index` (n,).

        `units`, one or as many as sums: powers of two, the same on all ranks. Nothing is lost down to 1e-18 of them;
        terms up to 1e9 and sums up to 1e12 of them fit: a sum beyond is nan, with a term beyond or no number all are.
        also (k,) int64 becomes its sum over all ranks, by the same message.
        """
        values = np.ascontiguousarray(values, float)
        rows = np.zeros(len(values), np.int64) if index is None else index
        limbs = np.zeros((count, values.shape[1], 2), np.int64)
        units = np.array(np.broadcast_to(units, limbs.shape[:2]), float, order="C")
        good = exact_sums.accumulate(values, rows, units, limbs)
        more = np.zeros(0, np.int64) if also is None else also
        sums = self.comm.sum_integers(np.concatenate([limbs.ravel(), [not good], more]))
        more[:] = sums[limbs.size + 1 :]
        total = exact_sums.value(sums[: limbs.size].reshape(limbs.shape), units)
        if sums[limbs.size]:
            total[:] = np.nan
        return total[0] if index is None else total

    def dot(self, one: np.ndarray, two: np.ndarray, unit: float, also: np.ndarray | None = None) -> float:
        """Exact sum over all ranks of the products of one (n,) and two (n,), in `unit`; also: see `sum`."""
        return float(self.sum((one * two)[:, None], unit, also=also)[0])

    def whole(self, numbers: np.ndarray) -> np.ndarray:
        """Sums over all ranks of whole numbers (n,) int64, element by element."""
        return self.comm.sum_integers(numbers)

    def count(self, *numbers: int) -> list[int]:
        """Sums over all ranks of whole numbers."""
        return [int(n) for n in self.comm.sum_integers(np.array(numbers, np.int64))]

    def max(self, *values: float) -> np.ndarray:
        """Largest over all ranks, element by element."""
        return self.comm.max(values)

    def balance(self, work: np.ndarray, move: bool) -> None:
        """Compare the work (owned,) int64 of the ranks; if it is uneven and `move`, the next rebuild has other cuts."""
        layers = np.zeros(self.grid.layers, np.int64)
        accumulate(self.grid.layer(self.particles.x[self.own]), work, layers)
        layers = self.comm.sum_integers(layers)
        self.uneven = uneven(layers, self.cuts)
        if move and self.uneven > _UNEVEN:
            cuts = even_cuts(layers, self.comm.size)
            if uneven(layers, cuts) < self.uneven:
                self.cuts = cuts

    def cut_evenly(self, x: np.ndarray, count: np.ndarray) -> None:
        """Cut to an equal number of particles, `count` (n,) of them at each x (n,), before anything is stored.

        Every rank gives its own: an x that all ranks give counts for all of them.
        """
        work = self.comm.sum_integers(np.bincount(self.grid.layer(x), count, self.grid.layers).astype(np.int64))
        if work.any():
            self.cuts = even_cuts(work, self.comm.size)

    def _wrap(self, fluid):
        """Periodic positions back into the box; what left the grid is counted as lost and taken out."""
        outside = np.zeros(len(fluid), bool)
        for axis, name in enumerate(POSITION):
            field = getattr(fluid, name)
            if self.grid.periodic[axis]:
                period, low = self.grid.period[axis], self.grid.low[axis]
                field[field < low] += period
                field[field >= low + period] -= period
                field[field < low] = low
            else:
                outside |= ~((field >= self.grid.low[axis]) & (field < self.grid.high[axis]))
        self.lost += int(outside.sum())
        self.gone = fluid.take(outside)
        return fluid.take(~outside) if outside.any() else fluid

    def _migrate(self, fluid):
        """Pass particles from neighbour to neighbour until each is in its slab: one hop unless the cuts moved."""
        while self.comm.size > 1:
            begin, end = self.layers
            layer = self.grid.layer(fluid.x)
            middle = (begin + end) // 2
            away = (layer < begin) | (layer >= end)
            if self.grid.periodic[0]:  # the shorter way round
                offset = (layer - middle) % self.grid.layers
                leftward = away & (offset > self.grid.layers // 2)
            else:
                leftward = layer < begin
            rightward = away & ~leftward
            if self.max(float(away.any()))[0] == 0.0:
                break
            received = self.comm.exchange(fluid.take(leftward).pack(), fluid.take(rightward).pack())
            arrived = (Particles.unpack(buffer, self._fields) for buffer in received)
            fluid = Particles.join([fluid.take(~away), *arrived])
        return fluid

    def _awake(self, fluid):
        """Flat marks of the slab's cells within reach of fluid, that of the neighbouring slabs included."""
        begin, end = self.layers
        g = self.grid
        first, last = begin // LAYERS, -(-end // LAYERS)
        cell = g.cell(g.layer(fluid.x) // LAYERS - first, fluid.y, fluid.z)
        marks = occupied(cell, (last - first) * g.per_column).reshape(-1, *g.count[1:])
        for axis in (1, 2):  # images are fluid too
            if g.periodic[axis]:
                marks = np.moveaxis(marks, axis, 0)
                marks[:REACH] |= marks[-2 * REACH : -REACH]
                marks[-REACH:] |= marks[REACH : 2 * REACH]
                marks = np.ascontiguousarray(np.moveaxis(marks, 0, axis))
        # a column with a cut in it is marked by both owners: hence one more than the reach
        left, right = (
            side.reshape(-1, *g.count[1:])
            for side in self.comm.exchange(marks[: REACH + 1].ravel(), marks[-REACH - 1 :].ravel())
        )
        padded = np.zeros((len(marks) + 2 * REACH, *marks.shape[1:]), np.uint8)
        padded[REACH:-REACH] = marks
        until, since = -(-begin // LAYERS) - first + REACH, end // LAYERS - first + REACH
        left, right = left[-until:], right[: len(padded) - since]
        padded[until - len(left) : until] |= left
        padded[since : since + len(right)] |= right
        return spread(padded, REACH)[REACH:-REACH].ravel()

    def _with_images(self, parts):
        """Parts and the images of what is within REACH cells of a periodic side in y and z (corners included)."""
        for axis in (1, 2):
            if not self.grid.periodic[axis]:
                continue
            low, period = self.grid.low[axis], self.grid.period[axis]
            reach = REACH * self.grid.edge[axis]
            copies = []
            for part in parts:
                field = getattr(part, POSITION[axis])
                for near, shift in ((field < low + reach, period), (field >= low + period - reach, -period)):
                    copy = part.take(near)
                    setattr(copy, POSITION[axis], getattr(copy, POSITION[axis]) + shift)
                    copy.image[:] = 1
                    copies.append(copy)
            parts = [*parts, *copies]
        return parts

    def _assemble(self, parts):
        """Exchange the layers next to the cuts, sort everything, and note what every refresh sends."""
        g, (begin, end) = self.grid, self.layers
        layers = [g.layer(part.x) for part in parts]
        layer, count = np.concatenate(layers), sum(map(len, parts))
        sides = zip(*map(self._shared, layers), strict=True)
        halos = self.comm.exchange(
            *(
                Particles.join([part.take(shared) for part, shared in zip(parts, side, strict=True)]).pack()
                for side in sides
            )
        )
        left, right = (Particles.unpack(buffer, self._fields) for buffer in halos)
        left_end, right_end = self.comm.rank == 0, self.comm.rank == self.comm.size - 1
        stored = np.concatenate([g.layer(left.x) - g.layers * left_end, layer, g.layer(right.x) + g.layers * right_end])
        self._period_left, self._period_right = -g.period[0] * left_end, g.period[0] * right_end
        left.x += self._period_left
        right.x += self._period_right
        self.own, self.stack = slice(len(left), len(left) + count), Stack(begin, end)
        parts = [left, *parts, right]
        y, z, ident = (np.concatenate([getattr(part, name) for part in parts]) for name in ("y", "z", "id"))
        cell = g.cell(self.stack.piece[stored - begin + HALO], y, z)
        order, self.first = sort_by_cell(cell, sort_key(stored, ident), self.stack.column.size * g.per_column)
        self.particles = Particles.sorted(parts, order, self._buffers)
        stored = stored[order][self.own]
        shared = self._shared(stored)
        self._send = [self.own.start + np.flatnonzero(side) for side in shared]
        self.border = shared[0] | shared[1]
        self._images = Images(self.particles, self.own, g)

    def _shared(self, layer):
        """Which owned particles, given their layers (owned,), are in the halo of the left and of the right slab."""
        begin, end = self.layers
        none = np.zeros(layer.size, bool)
        return (
            none if self.comm.left is None else layer < begin + HALO,
            none if self.comm.right is None else layer >= end - HALO,
        )
