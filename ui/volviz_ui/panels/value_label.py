"""A value that somebody reads or copies, shortened where there is no room for it."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QSizePolicy, QWidget

LEAST = 48
"""Pixels below which it is not squeezed."""


class ValueLabel(QLabel):
    """One line of text that never makes a panel wider: what does not fit ends in dots and stands in the tooltip.

    Parameters
    ----------
    explanation : str
        What the value is; the tooltip, below the whole text where that is shortened.
    """

    def __init__(self, explanation: str, parent: QWidget | None = None) -> None:
        super().__init__("\N{EN DASH}", parent)
        self._whole = self.text()
        self._explanation = explanation
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.setToolTip(explanation)

    @property
    def whole(self) -> str:
        """The text, whether there is room for it or not."""
        return self._whole

    def show_text(self, text: str) -> None:
        """Show another value."""
        self._whole = text
        self._fit()

    def minimumSizeHint(self) -> QSize:
        """Narrower than the text."""
        return QSize(LEAST, super().minimumSizeHint().height())

    def sizeHint(self) -> QSize:
        """As wide as the whole text, so that it gets the room that there is."""
        width = self.fontMetrics().horizontalAdvance(self._whole) + 2
        return QSize(width, super().sizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """More or less of it."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        shown = self.fontMetrics().elidedText(self._whole, Qt.TextElideMode.ElideRight, self.width())
        if not self.width() or not self.isVisible():
            shown = self._whole
        if shown != self.text():
            self.setText(shown)
        cut = shown != self._whole
        self.setToolTip(f"{self._whole}\n{self._explanation}" if cut else self._explanation)
        self.setAccessibleDescription(self._whole)
