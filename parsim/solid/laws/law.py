"""What every law of contact is: how hard the touching area of a pair presses back."""

from typing import ClassVar

from parsim.case.types import Table


class LawTable(Table):
    """What a case may say of a law. NUMBER tells kernels what it is (`laws.kernels`).

    Restitution and friction are those of the materials, whatever the law.
    """

    NUMBER: ClassVar[int]

    def of_pair(self, one, two, thinnest):
        """What its kernel `stiffness` needs of two materials; `thinnest`: least half edge of any body, m."""
        raise NotImplementedError


def compliance(one, two):
    """1/E* of two materials, 1/Pa: (1 - nu_k^2)/E_k + (1 - nu_l^2)/E_l (Hertz; Mellado 2021, eq. 4.20)."""
    return sum((1.0 - m.poisson * m.poisson) / m.young for m in (one, two))
