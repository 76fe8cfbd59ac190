"""Copying what the views show: waits, turn by turn of the event loop, until it is complete."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QApplication

from volviz_ui.views.view_controller import ViewController
from volviz_ui.views.view_grid import ViewGrid


class ImageCopy(QObject):
    """One image on its way to the clipboard: the view as it is seen, or all of them with what lies between.

    The views complete themselves, as ever; what is copied is what they show when they have. A view whose drawing
    failed is copied as it is.

    Parameters
    ----------
    views : ViewGrid
        What is copied.
    """

    progressed = Signal(float)
    """How much of the images is ready, 0..1."""
    copied = Signal()
    ended = Signal()
    """Copied or cancelled."""

    def __init__(self, views: ViewGrid, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._views = views
        self.is_over = False
        self._ready = 0.0
        self._look_again = QTimer(self)
        self._look_again.setSingleShot(True)
        # never while a view is being drawn
        self._look_again.setInterval(0)
        self._look_again.timeout.connect(self._look)

    def start(self) -> None:
        """Begin; everything else is told by the signals."""
        self._views.drawn.connect(self._look_again.start)
        self._views.status_changed.connect(self._look_again.start)
        self._look()

    def cancel(self) -> None:
        """Give up; the clipboard keeps what it has."""
        if not self.is_over:
            self._end()

    def _look(self) -> None:
        shares = [_share_ready(view_widget.controller) for view_widget in self._views.shown_view_widgets]
        if all(share is None for share in shares):
            self._copy()
            self.copied.emit()
            self._end()
            return
        # never less than before, though a quick image on the way begins anew
        self._ready = max(self._ready, sum(1.0 if share is None else share for share in shares) / len(shares))
        self.progressed.emit(self._ready)

    def _copy(self) -> None:
        views = self._views
        # handles belong to the window, not to the image
        shown, views.shows_manipulators = views.shows_manipulators, False
        for view_widget in views.shown_view_widgets:
            view_widget.viewport.repaint()
        several = len(views.view_widgets) > 1
        image = (views if several else views.first.viewport).grab().toImage()
        QApplication.clipboard().setImage(image)
        views.shows_manipulators = shown

    def _end(self) -> None:
        self.is_over = True
        self._look_again.stop()
        self._views.drawn.disconnect(self._look_again.start)
        self._views.status_changed.disconnect(self._look_again.start)
        self.ended.emit()


def _share_ready(controller: ViewController) -> float | None:
    """How much of a complete image there is, 0..1; None when it is there, or none will come."""
    handle = controller.handle
    if handle is None or handle.error is not None or controller.is_complete:
        return None
    return 0.0 if handle.status.complete else float(handle.status.progress)
