"""Telling the user: status line, the strip over the views, dialogs of errors."""

from __future__ import annotations

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QMainWindow

from volviz_ui.dialogs.error import sentence_of, show_error
from volviz_ui.session.documents import Documents
from volviz_ui.views.view_grid import ViewGrid
from volviz_ui.widgets.banner import Banner
from volviz_ui.widgets.status_line import StatusLine


class WindowMessages(QObject):
    """The `Messages` of a window; loading, and what goes wrong while drawing, it shows by itself."""

    def __init__(self, window: QMainWindow, documents: Documents, views: ViewGrid) -> None:
        super().__init__(window)
        self._window = window
        self.banner = Banner(views)
        self.status_line = StatusLine(window)
        window.setStatusBar(self.status_line)
        self._last_error: BaseException | None = None
        self._loading = ""
        documents.failed.connect(self._on_failed_to_open)
        documents.loading_started.connect(self._on_loading_started)
        documents.loading_progressed.connect(self._on_loading_progressed)
        documents.loading_ended.connect(self.banner.hide_progress)
        self.banner.cancelled.connect(documents.cancel)
        self.banner.details_requested.connect(self._show_details)
        views.failed.connect(self._on_drawing_failed)
        views.recovered.connect(self._on_drawing_recovered)

    def show_status(self, words: str, milliseconds: int = 5000) -> None:
        """A sentence in the status line that goes away by itself."""
        self.status_line.showMessage(words, milliseconds)

    def show_error(self, title: str, error: BaseException) -> object:
        """A dialog with one sentence on what went wrong, and details for those who ask."""
        return show_error(self._window, title, error)

    def _on_loading_started(self, name: str) -> None:
        self._loading = name
        self.banner.show_progress(self.tr("Loading %1…").replace("%1", name))

    def _on_loading_progressed(self, fraction: float, words: str) -> None:
        self.banner.set_progress(fraction)
        if words:
            text = self.tr("Loading %1: %2…").replace("%1", self._loading).replace("%2", words)
            self.banner.words.setText(text)

    def _on_failed_to_open(self, name: str, error: BaseException) -> None:
        self.show_error(self.tr("%1 was not opened").replace("%1", name), error)

    def _on_drawing_failed(self, error: BaseException) -> None:
        self._last_error = error
        self.banner.show_error(sentence_of(error))

    def _on_drawing_recovered(self) -> None:
        if not self.banner.shows_progress:
            self.banner.hide()

    def _show_details(self) -> None:
        if self._last_error is not None:
            self.show_error(self.tr("The picture could not be drawn"), self._last_error)
