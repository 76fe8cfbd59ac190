"""One result at a time, made on a thread of its own; the newest wish counts."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

Key = TypeVar("Key")
Result = TypeVar("Result")


class Background(Generic[Key, Result]):
    """Makes results of keys; VTK's filters and searches run here without holding the window up.

    A result that nobody wants any more is finished and dropped: VTK's filters cannot be interrupted from another
    thread.
    """

    def __init__(self) -> None:
        self._result: tuple[Key, Result] | None = None
        self._error: Exception | None = None
        self._thread: threading.Thread | None = None

    @property
    def last(self) -> Result | None:
        """What was made last, for whatever key."""
        return self._result[1] if self._result is not None else None

    def get(self, key: Key, make: Callable[[], Result], patience: float) -> Result | None:
        """The result of a key, or None while it is being made.

        Parameters
        ----------
        key : object
            Equal keys have the same result.
        make : callable
            Makes it, on the thread.
        patience : float
            Seconds to wait for it.

        Raises
        ------
        Exception
            What `make` raised.
        """
        if self._thread is not None:
            self._thread.join(patience)
            if self._thread.is_alive():
                return None
            self._thread = None
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        if self._result is not None and self._result[0] == key:
            return self._result[1]
        self._thread = threading.Thread(
            target=self._work, args=(key, make), name="volviz-background", daemon=True
        )
        self._thread.start()
        self._thread.join(patience)
        return self._result[1] if self._result is not None and self._result[0] == key else None

    def _work(self, key: Key, make: Callable[[], Result]) -> None:
        try:
            self._result = (key, make())
        except Exception as error:  # noqa: BLE001 - raised again where the result is asked for
            self._error = error

    def close(self) -> None:
        """Wait for the thread and forget everything."""
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        self._result = self._error = None
