"""Reading volumes: `open` and `load`, one table of readers, the bundled samples."""

from volviz.io.loading import file_dialog_filters, info, load, open, suffixes  # noqa: A004 - as `volviz.open`
from volviz.io.reader import LoadOptions, LoadRequest

__all__ = ["LoadOptions", "LoadRequest", "file_dialog_filters", "info", "load", "open", "suffixes"]
