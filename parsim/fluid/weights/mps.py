"""W = re / r - 1, the weight of the MPS method (Koshizuka & Oka 1996; Mellado 2021, eq. 5.4).

A sheared lattice of particles with this weight is stiff: the sum of e e W is up to 18 % off isotropic, so that water
under pressure resists shear like a weak solid, by 0.07 to 0.1 of its pressure. Kept to compare with.
"""

from typing import NamedTuple

from parsim.fluid.weights.choice import implements

OWN = 0.0


class MPS(NamedTuple):
    """radius: re, m."""

    radius: float


def of_radius(radius):
    """The weight of this radius, m."""
    return MPS(radius)


@implements(MPS)
def _mps(weight, r2, inverse):
    w = max(weight.radius * inverse - 1.0, 0.0)
    return w, w * inverse * inverse, w
