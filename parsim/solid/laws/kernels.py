"""What kernels ask of a law of contact, chosen by its number."""

from parsim.machine.jit import kernel
from parsim.solid.laws import foundation

_stiffness_foundation = kernel(foundation.stiffness)


@kernel
def stiffness(law, own, area, radius, depth):
    """(force over touching area and depth, Pa/m; energy held over force times depth) of a pair.

    `own`: see `LawTable.of_pair`; area that touches, m2; radius of what is round there, m, 0 for faces and edges, and
    how deep that is, m.
    """
    return _stiffness_foundation(own, area, radius, depth)
