"""Reading volumes: one function, one table of readers, the bundled samples."""

from volviz.io.loading import file_dialog_filters, info, load, suffixes
from volviz.io.reader import Hints, Job, Reader

__all__ = ["Hints", "Job", "Reader", "file_dialog_filters", "info", "load", "suffixes"]
