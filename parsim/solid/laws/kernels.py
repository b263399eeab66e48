"""What kernels ask of a law of contact, chosen by its number."""

from parsim.machine.jit import kernel
from parsim.solid.laws import foundation, hertz, spring
from parsim.solid.search import WALL_MATERIAL
from parsim.solid.table import MATERIAL

_foundation, _hertz, _spring = kernel(foundation.stiffness), kernel(hertz.stiffness), kernel(spring.stiffness)
_HERTZ, _SPRING = hertz.HertzLaw.NUMBER, spring.SpringLaw.NUMBER


@kernel
def stiffness(law, own, area, bend, radius, depth):
    """(force over touching area and depth, Pa/m; energy held over force times depth; tangential stiffness over
    `LawTable.shear` and the normal one, as secants) of a pair.

    `own`: see `LawTable.of_pair`; area that touches, m2; how what touches is curved, `law.FLAT`, LINE or SPOT; radius
    of what is round there, m, and how deep that is, m.
    """
    if law == _HERTZ:
        return _hertz(own, area, bend, radius, depth)
    if law == _SPRING:
        return _spring(own, area, bend, radius, depth)
    return _foundation(own, area, bend, radius, depth)


@kernel
def coefficients(m, touch, a, b):
    """The column of `pair_law` of bodies a and b, or a and wall -1 - b."""
    law, walls = touch.pair_law, touch.walls
    one, two = int(m[a, MATERIAL]), int(m[b, MATERIAL] if b >= 0 else walls[-1 - b, WALL_MATERIAL])
    return law[0, one, two], law[1, one, two], law[2, one, two], law[3, one, two], law[4, one, two], law[5, one, two]
