"""Colours by name or hexadecimal digits, as layers and labels take them."""

from __future__ import annotations

from collections.abc import Iterable

from volviz.errors import InputError
from volviz.volume_data.vectors import finite_vector

Color = tuple[float, float, float]

#: The pure colours of display channels; the green and grey of style sheets are darker.
_PURE: dict[str, Color] = {
    "red": (1.0, 0.0, 0.0), "green": (0.0, 1.0, 0.0), "blue": (0.0, 0.0, 1.0), "cyan": (0.0, 1.0, 1.0),
    "magenta": (1.0, 0.0, 1.0), "yellow": (1.0, 1.0, 0.0), "gray": (1.0, 1.0, 1.0), "grey": (1.0, 1.0, 1.0),
}  # fmt: skip


def checked_color(color: str | Iterable[float], what: str) -> Color:
    """Red, green and blue in 0..1.

    Parameters
    ----------
    color : str or iterable of 3 floats
        Three parts in 0..1; a name; or hexadecimal digits such as ``"#ff8800"``. "red", "green", "blue",
        "cyan", "magenta" and "yellow" are pure, as channels of microscopes are shown, and "gray" is white
        at full strength; other names are those of style sheets ("orange", "lime", "steelblue").
    what : str
        Whose colour it is, for the error.

    Raises
    ------
    InputError
        No such name, or not three parts in 0..1.
    """
    if not isinstance(color, str):
        parts = finite_vector(color, what)
        if not all(0.0 <= part <= 1.0 for part in parts):
            raise InputError(f"{what} needs parts from 0 to 1, got {parts}.")
        return parts
    name = color.strip().lower()
    if name in _PURE:
        return _PURE[name]
    import cmap

    try:
        red, green, blue = cmap.Color(name).rgba[:3]
    except ValueError:
        raise InputError(
            f"{what}: there is no colour {color!r}; use a name such as orange, or #ff8800."
        ) from None
    return float(red), float(green), float(blue)
