"""Volumes in files: `open`, `load` and `save`, a table of readers and one of writers, the bundled samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from volviz.io.loading import file_dialog_filters, info, load, open, suffixes  # noqa: A004 - as `volviz.open`
from volviz.io.reader import LoadOptions, LoadRequest

if TYPE_CHECKING:
    from volviz.io.writers import save as save

__all__ = ["LoadOptions", "LoadRequest", "file_dialog_filters", "info", "load", "open", "save", "suffixes"]


def __getattr__(name: str) -> Any:
    # whoever reads need not wait for the writers
    if name != "save":
        raise AttributeError(f"module 'volviz.io' has no attribute {name!r}")
    from volviz.io.writers import save

    return save
