"""Which samples of fixed bodies lie within others: a pier in a bed, an obstacle made of parts."""

import numpy as np

from parsim.case.places import Place, clearance
from parsim.geometry.rotation import matrices


def buried(bodies, samples):
    """Which of the samples (n,) lie within a fixed body that comes before their own, which is fixed too: (n,) bool."""
    b, found, fixed, turn = (
        bodies,
        np.zeros(len(samples), bool),
        np.flatnonzero(bodies.fixed),
        matrices(bodies.quaternion),
    )
    for one in fixed:
        off = np.sqrt(((b.position[fixed] - b.position[one]) ** 2).sum(1))
        around = fixed[(off < b.radius[fixed] + b.radius[one]) & (fixed < one)]
        at = np.flatnonzero(samples.body == one) if around.size else np.zeros(0, np.int64)
        points = b.position[one] + samples.offsets[at] @ turn[one].T
        for other in around:
            found[at] |= clearance(Place(b.position[other], turn[other], b.shapes[other]), points) <= 0.0
    return found
