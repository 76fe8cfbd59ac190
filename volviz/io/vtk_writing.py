"""VTK's writers with progress, cancelling and errors that reach the caller."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any


def write_by_vtk(
    writer: Any,
    path: Path,
    progress: Callable[[float], object] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> None:
    """Have one of VTK's writers write its input.

    Parameters
    ----------
    writer : vtkWriter
        With its input.
    progress : callable, optional
        Called with the written fraction, 0..1, as far as the writer tells it. What it raises stops the writing.
    cancel : callable, optional
        When it returns True the writing stops; what lies in the file then is of no use.
    """
    # as bytes: a name on Linux need not be text
    writer.SetFileName(os.fsencode(path))
    furthest = 0.0
    errors: list[Exception] = []

    def report(_writer: Any, _event: str) -> None:
        nonlocal furthest
        try:
            # some writers tell the end of each part as the end of all
            if progress is not None and furthest < writer.GetProgress() < 1.0:
                furthest = writer.GetProgress()
                progress(furthest)
            if cancel is not None and cancel():
                writer.SetAbortExecute(True)
        except Exception as error:  # noqa: BLE001 - VTK would print and swallow it
            errors.append(error)
            writer.SetAbortExecute(True)

    observer = writer.AddObserver("ProgressEvent", report)
    try:
        writer.Write()
    finally:
        writer.RemoveObserver(observer)
    if errors:
        raise errors[0]
    if progress is not None:
        progress(1.0)
