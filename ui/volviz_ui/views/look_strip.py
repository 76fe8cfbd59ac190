"""A strip over the views with an image of each look: the present one is marked, a click takes another."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QEnterEvent, QIcon, QImage, QPixmap, QResizeEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QToolButton, QWidget

from volviz.model.looks.look import Look
from volviz_ui.library_words import translated

MARGIN = 12
#: Width and height of an image, the largest that fits into one row; the smallest has no room for a name.
LARGE, SMALL, SMALLEST = QSize(104, 72), QSize(72, 50), QSize(32, 24)
#: What a button needs beside its image.
EDGE = 12
STAYS_MS = 6000
"""How long the strip stays when nobody points at it."""


class LookStrip(QFrame):
    """Buttons with images and names at the bottom of what it covers; goes away by itself.

    Attributes
    ----------
    chosen : signal (Look)
        Another look was clicked.
    """

    chosen = Signal(object)

    def __init__(self, over: QWidget) -> None:
        super().__init__(over)
        self.setObjectName("look_strip")
        self.setAutoFillBackground(True)
        self.setAccessibleName(self.tr("Looks"))
        self.looks: tuple[Look, ...] = ()
        self.buttons: list[QToolButton] = []
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(6, 6, 6, 6)
        self._row.setSpacing(2)
        self._away = QTimer(self)
        self._away.setSingleShot(True)
        self._away.setInterval(STAYS_MS)
        self._away.timeout.connect(self._on_time_over)
        over.installEventFilter(self)
        self.hide()

    def show_looks(self, looks: Sequence[Look]) -> None:
        """Show these looks, or show them again."""
        if self.looks != tuple(looks):
            self.clear()
            self.looks = tuple(looks)
            self.buttons = [self._button(look) for look in self.looks]
        self.show()
        self._place()
        self.raise_()
        self._away.start()

    def clear(self) -> None:
        """Show nothing any more."""
        self.hide()
        self._away.stop()
        for button in self.buttons:
            self._row.removeWidget(button)
            button.deleteLater()
        self.looks, self.buttons = (), []

    def mark(self, number: int | None) -> None:
        """Mark the look that is shown, or none."""
        for each, button in enumerate(self.buttons):
            button.setChecked(each == number)

    def show_image(self, number: int, image: QImage) -> None:
        """Show how a look looks."""
        self.buttons[number].setIcon(QIcon(QPixmap.fromImage(image)))

    def _button(self, look: Look) -> QToolButton:
        button = QToolButton(self)
        button.setCheckable(True)
        button.setAutoRaise(True)
        button.setText(translated(look.label))
        button.setToolTip(f"{translated(look.label)}: {translated(look.description)}")
        button.clicked.connect(lambda: self.chosen.emit(look))
        empty = QPixmap(LARGE)
        empty.fill(Qt.GlobalColor.transparent)
        button.setIcon(QIcon(empty))
        return button

    def _place(self) -> None:
        over = self.parentWidget()
        room, count = over.width() - 2 * MARGIN, len(self.buttons)
        fitting = (size for size in (LARGE, SMALL) if count * (size.width() + EDGE + 2) <= room)
        size = next(fitting, SMALLEST)
        styles = Qt.ToolButtonStyle
        for button in self.buttons:
            button.setToolButtonStyle(
                styles.ToolButtonIconOnly if size == SMALLEST else styles.ToolButtonTextUnderIcon
            )
            button.setIconSize(size)
            button.setFixedWidth(size.width() + EDGE)
            self._row.addWidget(button)
        self.adjustSize()
        self.move((over.width() - self.width()) // 2, over.height() - self.height() - MARGIN)

    def _on_time_over(self) -> None:
        if not self.underMouse():
            self.hide()

    def enterEvent(self, event: QEnterEvent) -> None:
        """Somebody is choosing."""
        self._away.stop()
        super().enterEvent(event)

    def leaveEvent(self, event: QEvent) -> None:
        """Nobody is choosing any more."""
        self._away.start()
        super().leaveEvent(event)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Stay at the bottom in the middle when the widget below changes its size."""
        if isinstance(event, QResizeEvent) and not self.isHidden():
            self._place()
        return super().eventFilter(watched, event)
