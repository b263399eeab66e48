"""The contact law "hertz": elastic half-spaces.

Round on round, or on a face: F = 4/3 E* sqrt(R) d^(3/2) (Hertz 1882; Mellado 2021, eq. 4.19). A face on a face: the
flat punch of its area A, F = 2 E* sqrt(A / pi) d (Sneddon 1965).
"""

import math
from typing import Literal

from pydantic import Field

from parsim.machine.compiled import compiled
from parsim.solid.laws.law import LawTable, compliance


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


@compiled
def stiffness(own, area, radius, depth):
    """See `kernels.stiffness`."""
    if radius == 0.0:
        return 2.0 * own * math.sqrt(area / math.pi) / area, 0.5
    return 4.0 / 3.0 * own * math.sqrt(radius * depth) / area, 0.4
