"""W = q^2 (1 - q)^3, q = r / re: r times the slope of the C2 function of Wendland (1995).

With it the operators of the MPS method are those of smoothed particles with Wendland's kernel. At supports below 2.3
spacings it keeps the sum of e e W more isotropic than the C4 function does, but water at rest boils with both.

The sum of W itself tells the density badly: it is 0.4 to 0.7 % lower in water that flows than on the lattice of the
same density, the sum of Wendland's function C2 with the particle's own share 0.04 to 0.2 % higher. Their mix
C2 + 1.5 W is within 0.04 %, in 2D and 3D: the measure of concentration.
"""

from typing import NamedTuple

from parsim.fluid.weights.choice import implements

OWN = 1.0


class WendlandC2(NamedTuple):
    """over: one over the radius re, 1/m."""

    over: float


def of_radius(radius):
    """The weight of this radius, m."""
    return WendlandC2(1.0 / radius)


@implements(WendlandC2)
def _wendland_c2(weight, r2, inverse):
    q = r2 * inverse * weight.over
    t = max(1.0 - q, 0.0)
    cube = t * t * t
    return q * q * cube, cube * (weight.over * weight.over), cube * (t * (4.0 * q + 1.0) + 1.5 * q * q)
