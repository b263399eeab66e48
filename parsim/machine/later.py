"""Marks for functions that are compiled elsewhere, in files that must not import numba."""


def compiled(function):
    """Marks a function that a kernel module compiles with `jit.kernel`; the rules for kernels hold for it."""
    return function
