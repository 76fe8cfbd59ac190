"""OpenGL's own clock for pieces of work that are drawn one after another."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from volviz.custom_gl.gpu.context import Gpu


class GpuClock:
    """Adds up what `GL_TIME_ELAPSED` says of every `with clock:`; the context is current.

    With software OpenGL the number means little: the query ends before the work does (`Limits.software`).
    """

    def __init__(self, gpu: Gpu) -> None:
        self._query: Any = gpu.gl.query(time=True)
        self._seconds = 0.0
        self._is_open = False

    @property
    def seconds(self) -> float:
        """The sum so far; waits for the last piece to be finished."""
        if self._is_open:
            self._is_open = False
            self._seconds += 1e-9 * float(self._query.elapsed)
        return self._seconds

    def __enter__(self) -> Self:
        # the query is used again: what it holds is taken first
        self._seconds = self.seconds
        self._query.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._query.__exit__(kind, error, trace)
        self._is_open = True
