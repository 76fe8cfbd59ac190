"""How kernels are compiled: one decorator, so that all release the lock and keep their code on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])

_njit = njit(cache=True, nogil=True, error_model="numpy")


def compiled(function: Function) -> Function:
    """Compile `function` with numba on its first call for each combination of argument types.

    The interpreter lock is released inside, the machine code is cached on disk, and division by zero gives
    inf or NaN as in NumPy instead of a branch that keeps loops from being vectorised. Loops are never
    parallel: see `volviz.kernels.threads`.
    """
    result: Function = _njit(function)
    return result
