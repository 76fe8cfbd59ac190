"""Numbers as people read them."""

from __future__ import annotations

import math

import pytest

from volviz.model.ticks import NARROW, number_text


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.0, "0"),
        (12, "12"),
        (1234567, f"1{NARROW}234{NARROW}567"),
        (246243.123, f"246{NARROW}243"),
        (1.23456, "1.2346"),
        (-0.5, "−0.5"),
        (2.46243e9, f"2.4624{NARROW}×{NARROW}10⁹"),
        (3.2e-9, f"3.2{NARROW}×{NARROW}10⁻⁹"),
        (math.inf, "∞"),
        (math.nan, "–"),
    ],
)
def test_numbers_have_thousands_apart_and_powers_where_they_are_far_from_one(
    value: float, words: str
) -> None:
    assert number_text(value) == words
