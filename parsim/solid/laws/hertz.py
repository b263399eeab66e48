"""The contact law "hertz": elastic half-spaces.

Round on round, or on a face: F = 4/3 E* sqrt(R) d^(3/2) (Hertz 1882; Mellado 2021, eq. 4.19). A cylinder's side of
length L: F = pi/4 E* L d (Popov 2010, sec. 5.4; the exact depth goes with a logarithm of the force). A face on a face:
the flat punch of its area A, F = 2 E* sqrt(A / pi) d (Sneddon 1965). Sideways 8 G* a s on a circle of radius a (Mindlin
1949), 1/G* = sum of 2 (1 + nu)(2 - nu) / E: 4 G*/E* of what the normal force grows by with the depth.
"""

import math
from typing import Literal

from pydantic import Field

from parsim.machine.compiled import compiled
from parsim.solid.laws.law import FLAT, LINE, LawTable, compliance


class HertzLaw(LawTable):
    """Elastic half-spaces, of the materials' moduli alone."""

    NUMBER = 1

    kind: Literal["hertz"] = Field(description="elastic half-spaces: Hertz for what is round, flat punches for faces")

    def doubts(self, planar):
        """In a plane a face is a strip without end, which sinks into a half-space without end."""
        if not planar:
            return []
        return ['contacts.law = "hertz": takes the faces of a 2D case for punches one metre long']

    def of_pair(self, one, two, thinnest):
        """E*, Pa."""
        return 1.0 / compliance(one, two)

    def shear(self, one, two):
        """4 G*/E*."""
        return (
            4.0 * compliance(one, two) / sum(2.0 * (1.0 + m.poisson) * (2.0 - m.poisson) / m.young for m in (one, two))
        )


@compiled
def stiffness(own, area, bend, radius, depth):
    """See `kernels.stiffness`; the length of a line follows from its area, `touch.spot_area`."""
    if bend == FLAT:
        return 2.0 * own * math.sqrt(area / math.pi) / area, 0.5, 1.0
    if bend == LINE:
        return math.pi / 4.0 * own / (4.0 / 3.0 * math.sqrt(2.0 * radius * depth)), 0.5, 1.0
    return 4.0 / 3.0 * own * math.sqrt(radius * depth) / area, 0.4, 1.5
