"""Icons of one family (Phosphor, by way of qtawesome) in the colours of the theme."""

from __future__ import annotations

import weakref
from functools import lru_cache
from typing import Any

from PySide6.QtGui import QIcon, QPalette
from PySide6.QtWidgets import QApplication

_FAMILY = ("ph", "phosphor-1.3.0.ttf", "phosphor-charmap-1.3.0.json")


@lru_cache(maxsize=1)
def _font() -> Any:
    # qtawesome's own singleton reads nine fonts when the first icon is asked for; one is enough here and the
    # window opens a third of a second sooner
    from qtawesome.iconic_font import IconicFont

    return IconicFont(_FAMILY)


_shown: weakref.WeakKeyDictionary[Any, tuple[str, str]] = weakref.WeakKeyDictionary()


def icon(name: str, role: str = "normal") -> QIcon:
    """The icon of that name; role is "normal", "accent", "quiet" or "warning"."""
    palette = QApplication.palette()
    colors = {
        "normal": palette.color(QPalette.ColorRole.WindowText),
        "accent": palette.color(QPalette.ColorRole.Highlight),
        "quiet": palette.color(QPalette.ColorRole.PlaceholderText),
        "warning": "#d9822b",
    }
    disabled = palette.color(QPalette.ColorGroup.Disabled, QPalette.ColorRole.WindowText)
    return QIcon(_font().icon(f"ph.{name}", color=colors[role], color_disabled=disabled))


def set_icon(target: Any, name: str, role: str = "normal") -> None:
    """Give an action or a button an icon that follows the theme."""
    _shown[target] = (name, role)
    target.setIcon(icon(name, role))


def refresh() -> None:
    """Draw all icons again after the palette has changed."""
    from shiboken6 import isValid

    for target, (name, role) in list(_shown.items()):
        if isValid(target):
            target.setIcon(icon(name, role))
