"""The weight that a kernel works with, chosen by the type of its parameters when the kernel is compiled.

A weight is one file: a named tuple of its parameters, a function marked with `implements`, and `OWN`, its measure at
no distance. It is zero at and beyond the radius; what divides is done once, in the parameters.
"""

from parsim.machine.jit import FAST

from numba import types  # isort: skip (the settings of numba must come first)
from numba.extending import overload

_FORMS = {}


def weight_at(weight, r2, inverse):
    """W, W / r2, and the measure of concentration, at the squared distance r2, m2; inverse = 1 / r, 1/m."""
    return _FORMS[type(weight)](weight, r2, inverse)


def implements(kind):
    """Marks the function that gives what `weight_at` does for parameters of the type `kind`."""

    def note(function):
        _FORMS[kind] = function
        return function

    return note


@overload(weight_at, inline="never", jit_options={"error_model": "numpy", "fastmath": FAST})
def _chosen(weight, r2, inverse):
    if isinstance(weight, types.NamedTuple | types.NamedUniTuple):
        return _FORMS.get(weight.instance_class)
    return None
