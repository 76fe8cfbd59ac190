"""Volumes in files: `open`, `load` and `save`, a table of readers and one of writers, the bundled samples."""

from volviz.io.loading import file_dialog_filters, info, load, open, suffixes  # noqa: A004 - as `volviz.open`
from volviz.io.reader import LoadOptions, LoadRequest
from volviz.io.writers import save

__all__ = ["LoadOptions", "LoadRequest", "file_dialog_filters", "info", "load", "open", "save", "suffixes"]
