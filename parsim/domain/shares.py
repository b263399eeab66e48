"""What all ranks would else do alike, shared out among them: who does which part, and what each has found."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from parsim.domain.comm import Comm

_LEAST = 5e-4  # s, a message takes 0.02 to 0.1 ms
_UNEVEN = 1.03


class Shares:
    """The parts of a work, one for each rank: models see their number, `count`, and which is their `own`.

    least: s, what takes less is not shared; uneven: work of the busiest over the mean that is borne to save messages.
    """

    def __init__(self, comm: Comm, least: float = _LEAST, uneven: float = _UNEVEN) -> None:
        self._comm, self.count, self.own = comm, comm.size, comm.rank
        self.least, self.uneven = least, uneven

    def gather(self, found: np.ndarray, counts: Sequence[int] | np.ndarray) -> np.ndarray:
        """What every part has found, floats, in the order of the parts; counts (parts,): of each, known to all."""
        return self._comm.gather(found, counts)

    def gather_any(self, found: np.ndarray) -> np.ndarray:
        """The same where parts do not know of each other how much they have found."""
        return self._comm.gather(found, self.counts(found.size))

    def counts(self, own: int) -> np.ndarray:
        """How many each part has, (parts,), of which this one has `own`."""
        return self._comm.gather(np.array([float(own)]), [1] * self.count).astype(np.int64)
