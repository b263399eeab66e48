"""Images of particles beyond sides that repeat in y and z, and how they follow what they are images of."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from parsim.machine.jit import kernel
from parsim.particles.state import POSITION

if TYPE_CHECKING:
    from parsim.particles.cells import Grid
    from parsim.particles.state import Particles


class Images:
    """The images among the particles `own` (slice) of p, the particles that they copy, and the shifts between them."""

    def __init__(self, p: Particles, own: slice, grid: Grid) -> None:
        at = np.arange(own.start, own.stop)
        self._at = at[p.image[at] == 1]
        self._of = self._at
        if self._at.size:
            real = at[p.image[at] == 0]
            real = real[np.argsort(p.id[real])]
            self._of = real[np.searchsorted(p.id[real], p.id[self._at])]
        self._none = np.zeros(self._at.size)
        self._shift = [self._none]
        for name, period in zip(("y", "z"), grid.period[1:], strict=True):
            field = getattr(p, name)
            offset = field[self._at] - field[self._of]
            self._shift.append(np.rint(offset / period) * period if period else self._none)

    def copy(self, p: Particles, names: tuple[str, ...]) -> None:
        """Bring the fields `names` of p up to date in the images."""
        for name in names if self._at.size else ():
            shift = self._shift[POSITION.index(name)] if name in POSITION else self._none
            copy_images(getattr(p, name), self._at, self._of, shift)


@kernel
def copy_images(field, at, of, shift):
    """field[at] = field[of] + shift, element by element."""
    for k in range(at.size):
        field[at[k]] = field[of[k]] + shift[k]
