"""A line on the terminal that tells how far something is."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from types import TracebackType
from typing import Self

BAR = 24


class ProgressLine:
    """A bar with words on standard error, rewritten in place; silent when that is no terminal.

    A context manager: the line is cleared at the end.
    """

    def __init__(self) -> None:
        self._shown = sys.stderr.isatty()

    def show(self, fraction: float, words: str = "") -> None:
        """Show a fraction, 0..1, and what is being done."""
        if not self._shown:
            return
        full = round(BAR * min(max(fraction, 0.0), 1.0))
        print(f"\r\x1b[K[{'#' * full}{'.' * (BAR - full)}] {100 * fraction:3.0f} % {words}"[:120],
              end="", file=sys.stderr, flush=True)  # fmt: skip

    def follow(self, steps: Iterable[tuple[float, str]]) -> None:
        """Run something that gives fraction and words, to its end."""
        for fraction, words in steps:
            self.show(fraction, words)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
