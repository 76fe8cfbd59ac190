"""Giving freed memory back to the system."""

from __future__ import annotations

import ctypes
import gc
import sys


def return_freed_memory() -> None:
    """Give back what has been freed but is kept in reserve.

    The C library of Linux keeps the arrays and textures of volumes that are gone in the reserves of the threads
    that worked on them; after a few files these are hundreds of megabytes. Elsewhere this does nothing.
    """
    if not sys.platform.startswith("linux"):
        return
    try:
        ctypes.CDLL("libc.so.6").malloc_trim(0)
    except (OSError, AttributeError):  # another C library than glibc
        return


def spare_lasting_objects() -> None:
    """Let Python's collections pass over what lives now, before the first volume is opened.

    A full collection looks at every object there is. Those of modules and of the window stay until the end, and
    looking at them holds up the event loop for a tenth of a second in the middle of a drag.
    """
    gc.freeze()
