"""A thin bar that says how far something is."""

from __future__ import annotations

from PySide6.QtWidgets import QProgressBar, QWidget


class ProgressBar(QProgressBar):
    """Shows a fraction; painted with the next turn of the event loop.

    Qt's own bar repaints at once with every new value, and in a window with OpenGL in it that composes the whole
    window: some 40 ms on software OpenGL, several times a second.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTextVisible(False)
        self.setRange(0, 1000)
        self.setFixedHeight(8)

    def show_fraction(self, fraction: float) -> None:
        """Say how far it is, 0..1; below 0: unknown."""
        self.setUpdatesEnabled(False)
        self.setRange(0, 0 if fraction < 0 else 1000)
        if fraction >= 0:
            self.setValue(round(1000 * fraction))
        self.setUpdatesEnabled(True)
