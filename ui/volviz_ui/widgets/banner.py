"""A strip over the viewport: what is being loaded, or what went wrong, without taking the image away."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QWidget

from volviz_ui.style.icons import icon
from volviz_ui.widgets.progress_bar import ProgressBar

MARGIN = 12
WIDTH = 460


class Banner(QFrame):
    """One line with an optional progress bar and one or two buttons, at the top of what it covers."""

    cancelled = Signal()
    details_requested = Signal()
    cure_requested = Signal()

    def __init__(self, over: QWidget) -> None:
        super().__init__(over)
        self.setObjectName("banner")
        self.setAutoFillBackground(True)
        self.image = QLabel(self)
        self.words = QLabel(self)
        self.words.setWordWrap(True)
        self.bar = ProgressBar(self)
        self.bar.setFixedWidth(110)
        self.bar.setAccessibleName(self.tr("Progress of loading"))
        self.bar.setToolTip(self.tr("How much of the file has been read"))
        self.details = QPushButton(self.tr("Details"), self)
        self.details.setToolTip(self.tr("Show what exactly went wrong"))
        self.cure = QPushButton(self)
        self.stop = QPushButton(self.tr("Cancel"), self)
        self.details.clicked.connect(self.details_requested)
        self.cure.clicked.connect(self._on_cure)
        self.stop.clicked.connect(self._on_stop)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(12, 6, 8, 6)
        layout.setSpacing(8)
        layout.addWidget(self.image)
        layout.addWidget(self.words, 1)
        layout.addWidget(self.bar)
        layout.addWidget(self.details)
        layout.addWidget(self.cure)
        layout.addWidget(self.stop)
        self._is_progress = False
        self._cure = ""
        over.installEventFilter(self)
        self.hide()

    @property
    def shows_progress(self) -> bool:
        """Whether it is there because something is under way."""
        return self._is_progress and not self.isHidden()

    def show_progress(self, words: str) -> None:
        """Say that something is under way."""
        self._is_progress, self._cure = True, ""
        self._show(words)
        self.set_progress(-1.0)

    def set_progress(self, fraction: float) -> None:
        """Say how far it is; below 0: unknown."""
        if fraction < 0:
            self.bar.setRange(0, 0)
        else:
            self.bar.show_fraction(fraction)

    def show_error(self, words: str) -> None:
        """Say in one sentence what went wrong."""
        self._is_progress, self._cure = False, ""
        self.image.setPixmap(icon("warning", "warning").pixmap(18, 18))
        self._show(words)

    def show_hint(self, words: str, cure: str) -> None:
        """Say in one sentence what is the matter, with a button that mends it."""
        self._is_progress, self._cure = False, cure
        self.image.setPixmap(icon("info", "quiet").pixmap(18, 18))
        self._show(words)

    def hide_hint(self) -> None:
        """What was the matter is mended."""
        if self._cure:
            self._cure = ""
            self.hide()

    def hide_progress(self) -> None:
        """What was under way has ended."""
        if self._is_progress:
            self.hide()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Stay at the top in the middle when the widget below changes its size."""
        if isinstance(event, QResizeEvent) and not self.isHidden():
            self._place()
        return super().eventFilter(watched, event)

    def _show(self, words: str) -> None:
        self.words.setText(words)
        self.image.setVisible(not self._is_progress)
        self.bar.setVisible(self._is_progress)
        self.details.setVisible(not self._is_progress and not self._cure)
        self.cure.setVisible(bool(self._cure))
        self.cure.setText(self._cure)
        self.cure.setToolTip(self._cure)
        self.stop.setText(self.tr("Cancel") if self._is_progress else self.tr("Dismiss"))
        self.stop.setToolTip(
            self.tr("Stop loading; what is shown stays")
            if self._is_progress
            else self.tr("Hide this message")
        )
        self.show()
        self._place()
        self.raise_()

    def _place(self) -> None:
        over = self.parentWidget()
        width = min(WIDTH, over.width() - 2 * MARGIN)
        self.words.setAlignment(Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft)
        height = max(self.layout().heightForWidth(width), self.sizeHint().height())
        self.setGeometry((over.width() - width) // 2, MARGIN, width, height)

    def _on_cure(self) -> None:
        self._cure = ""
        self.hide()
        self.cure_requested.emit()

    def _on_stop(self) -> None:
        if self._is_progress:
            self.cancelled.emit()
        self.hide()
