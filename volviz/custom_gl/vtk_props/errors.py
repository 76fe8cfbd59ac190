"""Complaints of VTK's objects as errors of ours."""

from __future__ import annotations

from typing import Any

from volviz.errors import RenderError


class ErrorWords:
    """Keeps what a VTK object complains about, which VTK would only print."""

    def __init__(self, *objects: Any) -> None:
        self._words: list[str] = []
        for item in objects:
            item.AddObserver("ErrorEvent", self._note)

    def _note(self, _caller: Any, _event: str, words: str = "") -> None:
        self._words.append(words.strip().splitlines()[-1] if words else "no words")

    _note.CallDataType = "string0"  # type: ignore[attr-defined]

    def raise_any(self, what: str) -> None:
        """Raise the first complaint.

        Raises
        ------
        RenderError
            There was one.
        """
        if self._words:
            words = self._words[0]
            self._words.clear()
            raise RenderError(f"{what} could not draw this volume: {words}")
