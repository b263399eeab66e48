"""Where to cut: work counted by layers, and cuts that split it evenly."""

import numpy as np

from parsim.machine.jit import kernel
from parsim.particles.cells import HALO


def uneven(work: np.ndarray, cuts: np.ndarray) -> float:
    """Largest work of a rank over the mean: work (layers,), cuts (ranks + 1,)."""
    shares = np.add.reduceat(work, cuts[:-1])
    return float(shares.max() / max(shares.mean(), 1.0))


def even_cuts(work: np.ndarray, ranks: int) -> np.ndarray:
    """Cuts (ranks + 1,) between layers that split work (layers,) evenly, at least HALO layers each."""
    before = np.concatenate([[0], np.cumsum(work)])
    cuts = np.searchsorted(before, before[-1] * np.arange(ranks + 1) / ranks)
    for k in range(1, ranks + 1):  # the nearer of the two layers beside the ideal place
        at = cuts[k]
        if at > 0 and before[-1] * k / ranks - before[at - 1] < before[at] - before[-1] * k / ranks:
            cuts[k] = at - 1
    cuts[0], cuts[-1] = 0, work.size
    for k in range(1, ranks):
        cuts[k] = max(cuts[k], cuts[k - 1] + HALO)
    for k in range(ranks - 1, 0, -1):
        cuts[k] = min(cuts[k], cuts[k + 1] - HALO)
    return cuts.astype(np.int64)


@kernel
def accumulate(at, values, total):
    """total[at] += values, element by element, whole numbers."""
    for k in range(at.size):
        total[at[k]] += values[k]
