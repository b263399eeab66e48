"""Marks for functions that are compiled elsewhere, in files that must not import numba."""

from collections.abc import Callable
from typing import TypeVar

Function = TypeVar("Function", bound=Callable)


def compiled(function: Function) -> Function:
    """Marks a function that a kernel module compiles with `jit.kernel`; the rules for kernels hold for it."""
    return function
