"""The line above a view: A or B and its technique, or its plane; how far its image is, how long that took."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QMouseEvent, QPainter, QPaintEvent, QPalette, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSizePolicy, QWidget

from volviz.model.store import Store
from volviz_ui.editors.plane_box import PlaneBox, plane_of
from volviz_ui.editors.technique_box import TechniqueBox
from volviz_ui.views.sides import SideBadge
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.small import small_button

HEIGHT = 34
ACCENT = 2


class ViewHeader(QWidget):
    """Badge, technique, status and a button to close, for one of several views.

    Parameters
    ----------
    store : Store
        The scene.
    view : int
        Number of the view.
    """

    activated = Signal()
    closed = Signal()

    def __init__(self, store: Store, view: int, parent: QWidget) -> None:
        super().__init__(parent)
        self._active = False
        self._dimmed = False
        self.setAccessibleName(self.tr("View %1").replace("%1", str(view + 1)))
        self.badge = SideBadge(store, view, self)
        self.box = TechniqueBox(store, self, view=view)
        self.box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.box.setMinimumContentsLength(8)
        self.box.setToolTip(self.tr("How view %1 is drawn").replace("%1", str(view + 1)))
        self.box.setAccessibleName(self.tr("Technique of view %1").replace("%1", str(view + 1)))
        self.box.activated.connect(lambda _index: self.activated.emit())
        self.plane_box = PlaneBox(store, view, self)
        self.plane_box.activated.connect(lambda _index: self.activated.emit())
        self.words = QLabel(self)
        self.words.setProperty("quiet", True)
        self.words.setToolTip(self.tr("Resolution now shown, and the time that drawing took"))
        self.words.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        widest = self.fontMetrics().horizontalAdvance(self.tr("full quality  00000 ms"))
        self.words.setMinimumWidth(widest)
        self.words.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
        self.close_button = small_button("x", self.tr("Close this view; the others stay"), self)
        self.close_button.clicked.connect(self.closed)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(4, 2, 4, 2 + ACCENT)
        layout.setSpacing(8)
        layout.addWidget(self.badge)
        layout.addWidget(self.box, 1)
        layout.addWidget(self.plane_box)
        layout.addStretch()
        layout.addWidget(self.words)
        layout.addWidget(self.close_button)

        margins = layout.contentsMargins()
        widths = [part.sizeHint().width() for part in (self.badge, self.close_button)]
        widths += [self.box.minimumSizeHint().width(), widest, margins.left(), margins.right()]
        self._needed = sum(widths) + 3 * layout.spacing()
        show_value(store, lambda scene: plane_of(scene, view), self._show_plane)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """In a view too narrow for all of it, the words give way: they would lie below the button."""
        super().resizeEvent(event)
        self.words.setVisible(self.width() >= self._needed)

    def _show_plane(self, plane: str) -> None:
        """A view of a slice has its plane in the place of the technique, and is not compared."""
        for part in (self.badge, self.box):
            part.setVisible(not plane)
        self.plane_box.setVisible(bool(plane))

    @property
    def is_active(self) -> bool:
        """Whether panels and keys act on this view."""
        return self._active

    def set_active(self, active: bool) -> None:
        """Mark the view that panels and keys act on."""
        if active != self._active:
            self._active = active
            self.update()

    def set_dimmed(self, dimmed: bool) -> None:
        """Step back while the other view of a blinking pair is shown."""
        if dimmed != self._dimmed:
            self._dimmed = dimmed
            self.update()

    def show_status(self, status: Any) -> None:
        """Say how far the image is and how long it took."""
        if status.complete and status.resolution >= 1:
            words = self.tr("full quality")
        elif 0 < status.progress < 1:
            words = self.tr("%1 % done").replace("%1", f"{100 * status.progress:.0f}")
        else:
            words = f"{100 * status.resolution:.0f} %"
        seconds = status.seconds
        duration = f"{1000 * seconds:.0f} ms" if seconds < 10 else f"{seconds:.1f} s"
        self.words.setText(f"{words}  {duration}")
        notice = getattr(status, "notice", "")
        self.words.setToolTip(notice or self.tr("Resolution now shown, and the time that drawing took"))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """A click beside the controls makes the view the active one."""
        self.activated.emit()
        event.accept()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """A line in the accent colour below the header of the active view."""
        painter = QPainter(self)
        ground = QPalette.ColorRole.Window if self._dimmed else QPalette.ColorRole.Button
        painter.fillRect(self.rect(), self.palette().color(ground))
        role = QPalette.ColorRole.Highlight if self._active else QPalette.ColorRole.Mid
        painter.fillRect(0, self.height() - ACCENT, self.width(), ACCENT, self.palette().color(role))
        painter.end()
