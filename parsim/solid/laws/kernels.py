"""What kernels ask of a law of contact, chosen by its number."""

from parsim.machine.jit import kernel
from parsim.solid.laws import foundation, hertz, spring

_foundation, _hertz, _spring = kernel(foundation.stiffness), kernel(hertz.stiffness), kernel(spring.stiffness)
_HERTZ, _SPRING = hertz.HertzLaw.NUMBER, spring.SpringLaw.NUMBER


@kernel
def stiffness(law, own, area, radius, depth):
    """(force over touching area and depth, Pa/m; energy held over force times depth) of a pair.

    `own`: see `LawTable.of_pair`; area that touches, m2; radius of what is round there, m, 0 for faces and edges, and
    how deep that is, m.
    """
    if law == _HERTZ:
        return _hertz(own, area, radius, depth)
    if law == _SPRING:
        return _spring(own, area, radius, depth)
    return _foundation(own, area, radius, depth)
