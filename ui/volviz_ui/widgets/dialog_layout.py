"""How the parts of a dialog stand, the same in all of them."""

from __future__ import annotations

from PySide6.QtWidgets import QDialog, QLayout, QVBoxLayout, QWidget


def lay_out(dialog: QDialog, *parts: QWidget | QLayout, spacing: int = 12) -> QVBoxLayout:
    """Put the parts of a dialog one below the other, with the room around them that all dialogs have.

    Parameters
    ----------
    dialog : QDialog
    *parts : QWidget or QLayout
        From top to bottom.
    spacing : int
        Between them, in pixels.
    """
    layout = QVBoxLayout(dialog)
    layout.setContentsMargins(24, 20, 24, 16)
    layout.setSpacing(spacing)
    for part in parts:
        if isinstance(part, QLayout):
            layout.addLayout(part)
        else:
            layout.addWidget(part)
    return layout
