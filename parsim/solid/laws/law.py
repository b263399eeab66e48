"""What every law of contact is: how hard the touching area of a pair presses back."""

import math
from typing import ClassVar

from parsim.case.types import ShortTable

FLAT, LINE, SPOT = 0.0, 1.0, 2.0  # what touches: faces and edges, something round along a line, or at a point
SHEAR = 2.0 / 7.0  # tangential over normal stiffness (Schaefer, Dippel & Wolf 1996)


class LawTable(ShortTable):
    """What a case may say of a law. NUMBER tells kernels what it is (`laws.kernels`); INSTANT:
    contacts take no time.

    Restitution and friction are those of the materials, whatever the law.
    """

    NUMBER: ClassVar[int]
    INSTANT: ClassVar[bool] = False

    def doubts(self, planar):
        """What is doubtful about it, messages; `planar`: in a 2D case."""
        return []

    def of_pair(self, one, two, thinnest):
        """What its kernel `stiffness` needs of two materials; `thinnest`: half the least width of any body, m."""
        raise NotImplementedError

    def shear(self, one, two):
        """Tangential over normal stiffness of a face of one material on a face of another."""
        return SHEAR


def compliance(one, two):
    """1/E* of two materials, 1/Pa: (1 - nu_k^2)/E_k + (1 - nu_l^2)/E_l (Hertz; Mellado 2021, eq. 4.20)."""
    return sum((1.0 - m.poisson * m.poisson) / m.young for m in (one, two))


def restitution_of(damping):
    """Restitution of a linear spring and dashpot of damping ratio `damping` > 0 that ends where its force would pull.

    Schwager & Poeschel 2007, doi 10.1007/s10035-007-0065-z, eq. 21.
    """
    if damping < 1.0:
        root = math.sqrt(1.0 - damping * damping)
        return math.exp(-damping / root * math.atan2(2.0 * damping * root, 2.0 * damping * damping - 1.0))
    root = math.sqrt(max(damping * damping - 1.0, 1e-12))
    return math.exp(-damping / root * math.log((damping + root) / (damping - root)))


def damping_of(restitution):
    """Damping ratio that gives `restitution` (0 < e <= 1) with a force that never pulls."""
    low, high = 0.0, 1e3
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if middle == 0.0 or restitution_of(middle) > restitution else (low, middle)
    return low
