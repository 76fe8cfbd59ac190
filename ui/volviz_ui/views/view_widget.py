"""One view with everything that belongs to it: frame, header, viewport, what is drawn and what stands around."""

from __future__ import annotations

from PySide6.QtCore import QObject, QPoint, QRect
from PySide6.QtGui import QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QWidget

from volviz.custom_gl.resolve import ResolvedSpec
from volviz.model.store import Store
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.views.annotations import Annotations
from volviz_ui.views.header import ViewHeader
from volviz_ui.views.ray_mark import RayMark
from volviz_ui.views.view_controller import ViewController
from volviz_ui.views.viewport import Viewport

BORDER = 2


class ViewFrame(QWidget):
    """Cuts a viewport off at its edges, and shows which view is active by its colour."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._active = False

    def set_active(self, active: bool) -> None:
        """Show that panels and keys act on this view."""
        if active != self._active:
            self._active = active
            self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Only the border is seen: the viewport covers the rest."""
        role = QPalette.ColorRole.Highlight if self._active else QPalette.ColorRole.Mid
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().color(role))
        painter.end()


class ViewWidget(QObject):
    """A view of the scene in the window.

    Parameters
    ----------
    parent : QWidget
        In which frame and header lie; both are placed from outside.
    store, documents
        As for `ViewController`.
    view : int
        Number of the view in the scene.
    """

    def __init__(self, parent: QWidget, store: Store, documents: Documents, view: int) -> None:
        super().__init__(parent)
        self.view = view
        self.frame = ViewFrame(parent)
        self.header = ViewHeader(store, view, parent)
        self.viewport = Viewport(store, view, self.frame)
        self.ray_mark = RayMark(self.viewport)
        self.controller = ViewController(store, documents, self.viewport, self, view=view)
        self.annotations = Annotations(self.viewport, view, self._resolved)
        self.viewport.grab_knob = self.annotations.is_on_knob
        self.controller.status_changed.connect(self.header.show_status)

    def place(self, image: QRect, *, visible: QRect | None = None, border: int = 0) -> None:
        """Put the image somewhere.

        Parameters
        ----------
        image : QRect
            Where the image lies, in the coordinates of the parent.
        visible : QRect, optional
            The part of it that is seen; all of it when not given.
        border : int
            Width of the frame around the image, inside of `image`.
        """
        seen = image if visible is None else visible
        self.frame.setGeometry(seen)
        inner = image.adjusted(border, border, -border, -border)
        self.viewport.setGeometry(QRect(inner.topLeft() - seen.topLeft() + QPoint(0, 0), inner.size()))

    def _resolved(self) -> ResolvedSpec | None:
        handle = self.controller.handle
        return None if handle is None else handle.resolved

    def show_change(self, old: LoadedScene, new: LoadedScene) -> None:
        """Show what has changed."""
        self.controller.show_change(old, new)
        self.annotations.show_change(old, new)

    def set_active(self, active: bool) -> None:
        """Show that panels and keys act on this view."""
        self.frame.set_active(active)
        self.header.set_active(active)

    def close(self) -> None:
        """Release the GPU while the context lives, then the widgets."""
        self.viewport.end_moves()
        self.controller.close()
        self.viewport.unlink_camera()
        self.viewport.close()

    def remove(self) -> None:
        """Close, and take the widgets away."""
        self.frame.hide()
        self.header.hide()
        self.close()
        for part in (self.viewport, self.frame, self.header, self):
            part.deleteLater()
