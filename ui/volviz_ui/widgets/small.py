"""A quiet label and a small button."""

from __future__ import annotations

from PySide6.QtCore import QSize
from PySide6.QtWidgets import QLabel, QToolButton, QWidget

from volviz_ui.style.icons import set_icon


def quiet_label(text: str = "", parent: QWidget | None = None) -> QLabel:
    """A label in the colour of secondary text."""
    label = QLabel(text, parent)
    label.setProperty("quiet", True)
    return label


def small_button(icon_name: str, tooltip: str, parent: QWidget | None = None) -> QToolButton:
    """A button of one small icon."""
    button = QToolButton(parent)
    button.setObjectName("reset_button")
    button.setIconSize(QSize(14, 14))
    button.setAutoRaise(True)
    button.setToolTip(tooltip)
    button.setAccessibleName(tooltip)
    set_icon(button, icon_name, "quiet")
    return button
