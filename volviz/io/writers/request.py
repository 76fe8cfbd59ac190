"""One call of `save`: where to, how far it is, whether it goes on, what must be said."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from volviz.errors import Cancelled, VolvizError

if TYPE_CHECKING:
    import numpy.typing as npt

    from volviz.volume_data.source import Cancel, Progress

#: Bytes written at once: small enough to cancel within some 20 ms.
BLOCK = 4 << 20


@dataclass
class SaveRequest:
    """What a writer is told.

    Attributes
    ----------
    path : Path
        File or folder that is written, beside its place under another name.
    target : Path
        Its place.
    compress : bool
        Pack the values, without loss.
    progress, cancel
        As in `save`.
    notes : list of str
        Sentences for the user: what the format does not hold, what was changed.
    """

    path: Path
    target: Path
    compress: bool = True
    progress: Progress | None = None
    cancel: Cancel | None = None
    notes: list[str] = field(default_factory=list)

    def check(self) -> None:
        """Raise `Cancelled` when the user wants to stop."""
        if self.cancel is not None and self.cancel():
            raise Cancelled(f"Writing {self.target.name} was cancelled.")

    def report(self, fraction: float, text: str = "writing") -> None:
        """Tell the progress, 0..1; raises `Cancelled` when the user wants to stop."""
        self.check()
        if self.progress is not None:
            self.progress(min(max(fraction, 0.0), 1.0), text)

    def note(self, sentence: str) -> None:
        """Add a sentence for the user, once."""
        if sentence not in self.notes:
            self.notes.append(sentence)

    def error(self, what: str) -> VolvizError:
        """Why it cannot be written, with the name of the file."""
        return VolvizError(f"{self.target.name}: {what}")

    def blocks(self, array: npt.NDArray[Any], first: float, last: float) -> Iterator[memoryview]:
        """The bytes of an array piece by piece, the fastest axis first; the progress goes from `first` to `last`."""
        flat = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
        for start in range(0, flat.size, BLOCK):
            self.report(first + (last - first) * start / flat.size)
            yield flat[start : start + BLOCK].data

    def write(self, stream: Any, array: npt.NDArray[Any], first: float, last: float) -> None:
        """Write the bytes of an array to a stream."""
        for block in self.blocks(array, first, last):
            stream.write(block)
