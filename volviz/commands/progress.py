"""A line on the terminal that tells how far something is, and a Ctrl+C that waits for the frame at hand."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Generator
from types import FrameType, TracebackType
from typing import Any, Self

BAR = 24
#: Seconds, and share of the work, after which an estimate of the rest means something.
ESTIMATE_AFTER, ESTIMATE_SHARE = 5.0, 0.02
#: Environment variable for programs that read the progress: "lines" writes one line a step instead of a bar.
PROGRESS, LINES = "VOLVIZ_PROGRESS", "lines"


class ProgressLine:
    """A bar with words on standard error, rewritten in place; silent when that is no terminal.

    After some seconds it also tells about how long the rest will take, as if it took its time like what is done.

    With `VOLVIZ_PROGRESS=lines` every step is a line of its own, for programs that read them.

    A context manager: the line is cleared at the end. Within it the first Ctrl+C is answered between two steps of
    `follow`: in the middle of a frame VTK would print the exception and swallow it. A second one acts at once.
    """

    def __init__(self) -> None:
        self._lines = os.environ.get(PROGRESS) == LINES
        self._shown = sys.stderr.isatty() and not self._lines
        self._stopping = False
        self._handler: Any = None
        self._begun = time.monotonic()

    @property
    def is_stopping(self) -> bool:
        """Whether Ctrl+C was pressed, for work that asks."""
        return self._stopping

    def show(self, fraction: float, words: str = "") -> None:
        """Show a fraction, 0..1, and what is being done."""
        if self._lines:
            print(f"{fraction:.4f} {words}", file=sys.stderr, flush=True)
        if not self._shown:
            return
        full = round(BAR * min(max(fraction, 0.0), 1.0))
        left = time_left(fraction, time.monotonic() - self._begun)
        bar = f"[{'#' * full}{'.' * (BAR - full)}] {100 * fraction:3.0f} %{left} {words}"
        print(f"\r\x1b[K{bar[:100]}", end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Take the bar away, so that something can be printed; the next step shows it again."""
        if self._shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    def follow(self, steps: Generator[tuple[float, str], None, None]) -> None:
        """Run something that gives fraction and words, to its end.

        Raises
        ------
        KeyboardInterrupt
            Ctrl+C was pressed; the work is closed before.
        """
        try:
            for fraction, words in steps:
                if self._stopping:
                    raise KeyboardInterrupt
                self.show(fraction, words)
        finally:
            steps.close()

    def __enter__(self) -> Self:
        # only the main thread may, and only there does Ctrl+C arrive
        if threading.current_thread() is threading.main_thread():
            self._handler = signal.signal(signal.SIGINT, self._stop)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._handler is not None:
            signal.signal(signal.SIGINT, self._handler)
        self.clear()

    def _stop(self, _number: int, _frame: FrameType | None) -> None:
        self._stopping = True
        signal.signal(signal.SIGINT, signal.default_int_handler)


def time_left(fraction: float, elapsed: float) -> str:
    """Words on how long the rest of some work will take, as in ", 3 min left"; empty as long as nobody can tell.

    Parameters
    ----------
    fraction : float
        What is done, 0..1.
    elapsed : float
        Seconds that it took.
    """
    if elapsed < ESTIMATE_AFTER or not ESTIMATE_SHARE <= fraction < 1.0:
        return ""
    seconds = elapsed * (1.0 - fraction) / fraction
    if seconds < 60:
        return f", {max(round(seconds / 5), 1) * 5} s left"
    minutes = round(seconds / 60)
    return f", {minutes} min left" if minutes < 100 else f", {minutes / 60:.1f} h left"
