"""Round numbers for axes, colour bars and scale bars, and how numbers are written for people."""

from __future__ import annotations

import math

#: Between groups of three digits, and between a number and its unit.
NARROW = "\N{NARROW NO-BREAK SPACE}"
#: Numbers from here on are written with a power of ten, and those below.
LARGE, SMALL = 1e8, 1e-3
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def round_values(low: float, high: float, most: int) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten between two values, at most about `most`."""
    if not low < high or most < 1:
        return []
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(s * power for s in (1.0, 2.0, 5.0, 10.0) if s * power >= rough * 0.999)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def value_text(value: float, span: float) -> str:
    """A value with as many digits as a window of that width needs."""
    if value == 0.0:
        return "0"
    if not math.isfinite(value):
        return str(value)
    digits = max(0, 3 - math.floor(math.log10(span))) if span > 0 else 3
    if digits > 7 or abs(value) >= 1e7:
        return f"{value:.4g}"
    return f"{value:.{min(digits, 6)}f}".rstrip("0").rstrip(".") if digits else f"{value:.0f}"


def number_text(value: float, digits: int = 5) -> str:
    """A number for people: thousands apart, at most so many digits that count, very large and small ones by powers.

    Whole numbers keep all of their digits up to `LARGE`.
    """
    if not math.isfinite(value):
        return "∞" if value > 0 else "−∞" if value < 0 else "–"
    size = abs(value)
    if size >= LARGE or 0.0 < size < SMALL:
        mantissa, power = f"{value:.{digits - 1}e}".split("e")
        mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
        return f"{mantissa}{NARROW}×{NARROW}10{str(int(power)).translate(_SUPERSCRIPTS)}".replace("-", "−")
    decimals = max(0, digits - 1 - math.floor(math.log10(size))) if size else 0
    text = f"{value:,.{decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return text.replace(",", NARROW).replace("-", "−")
