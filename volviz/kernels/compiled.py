"""How kernels are compiled: one decorator, so that all release the lock and keep their code on disk.

numba itself is imported with the first call of a kernel. It takes longer to import than most kernels take to run, and
the first image of a volume needs none of them.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from typing import Any, TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., Any])

_lock = threading.RLock()


def compiled(function: Function) -> Function:
    """Compile `function` with numba on its first call for each combination of argument types.

    The interpreter lock is released inside, the machine code is cached on disk, and division by zero gives
    inf or NaN as in NumPy instead of a branch that keeps loops from being vectorised. Loops are never
    parallel: see `volviz.kernels.threads`.
    """
    return cast(Function, Kernel(function))


class Kernel:
    """A function that becomes one of numba's dispatchers when it is first called.

    The name in its module then stands for the dispatcher, and so do the names of all kernels beside it: compiled
    code that calls another kernel finds it as a global of its module.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self._function = function
        self._dispatcher: Any = None

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled function."""
        return self.dispatcher(*arguments)

    def __repr__(self) -> str:
        return f"<kernel {self._function.__module__}.{self._function.__qualname__}>"

    @property
    def dispatcher(self) -> Any:
        """What numba makes of the function; imports numba."""
        if self._dispatcher is None:
            with _lock:
                self._make()
        return self._dispatcher

    @property
    def signatures(self) -> list[Any]:
        """Argument types for which there is machine code in this process."""
        return [] if self._dispatcher is None else list(self._dispatcher.signatures)

    def _make(self) -> None:
        """Make the dispatcher, and those of all kernels that the module knows; the lock is held."""
        if self._dispatcher is not None:
            return
        self._dispatcher = _njit()(self._function)
        names = self._function.__globals__
        for name, value in list(names.items()):
            if isinstance(value, Kernel):
                names[name] = value.dispatcher


@functools.cache
def _njit() -> Any:
    from numba import njit, types
    from numba.extending import typeof_impl

    # for kernels that compiled code meets under a name that was not replaced
    @typeof_impl.register(Kernel)
    def _type_of_kernel(kernel: Kernel, _context: Any) -> Any:
        return types.Dispatcher(kernel.dispatcher)

    return njit(cache=True, nogil=True, error_model="numpy")
