"""Words on how long something will still take."""

from __future__ import annotations

import pytest

from volviz.commands.progress import time_left


@pytest.mark.parametrize(
    ("fraction", "elapsed", "words"),
    [
        (0.5, 4.0, ""),
        (0.01, 60.0, ""),
        (1.0, 60.0, ""),
        (0.5, 20.0, ", 20 s left"),
        (0.99, 20.0, ", 5 s left"),
        (0.25, 60.0, ", 3 min left"),
        (0.02, 600.0, ", 8.2 h left"),
    ],
)
def test_the_rest_is_told_once_it_can_be_told(fraction: float, elapsed: float, words: str) -> None:
    assert time_left(fraction, elapsed) == words
