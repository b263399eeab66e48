"""The kinds of Numba kernel.

`kernel` is strict IEEE arithmetic, for sorting and for few elements; `inlined` is a part of one.
`each` is the same, threaded over `prange`, for element-wise work on many particles.
`rows` runs a `prange` over particles; inside one particle's neighbour loop the sum may be reordered for SIMD,
which depends on nothing but that particle's own list.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from parsim.machine import variant

if TYPE_CHECKING:
    from collections.abc import Callable

    from numba.core.dispatcher import Dispatcher

variant.apply()

from numba import njit, prange  # noqa: E402, F401  (must follow the settings above)

FAST = {"reassoc", "nsz", "contract"}


def kernel(function: Callable[..., Any]) -> Dispatcher:
    """Compile strict and cached, without threads."""
    return njit(function, cache=True, error_model="numpy", nogil=True)


def inlined(function: Callable[..., Any]) -> Dispatcher:
    """The same as `kernel`, made part of what calls it: a loop becomes vector code only where it calls nothing."""
    return njit(function, cache=True, error_model="numpy", nogil=True, forceinline=True)


def each(function: Callable[..., Any]) -> Dispatcher:
    """Compile strict and cached, threaded over `prange`."""
    return njit(function, cache=True, error_model="numpy", nogil=True, parallel=True)


def rows(function: Callable[..., Any]) -> Dispatcher:
    """Compile cached, threaded over `prange`, neighbour sums reordered for SIMD."""
    return njit(function, cache=True, error_model="numpy", nogil=True, parallel=True, fastmath=FAST)
