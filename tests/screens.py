"""Whether windows can be shown, and what is said where they cannot."""

from __future__ import annotations

import sys

from volviz.environment import display_answers

NO_DISPLAY = (
    "The tests of the window need a display, and there is neither Xvfb nor a DISPLAY that answers. "
    "Install Xvfb (Debian: apt-get install xvfb) or leave them out with: pytest -m 'not ui'"
)


def window_can_open() -> bool:
    """Whether there is a display, or this is a system that always has one."""
    return not sys.platform.startswith("linux") or display_answers()
