"""The list of planes that a view of a slice can face."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPixmap
from PySide6.QtWidgets import QWidget

from volviz.annotations.planes import PLANE_COLORS
from volviz.custom_gl.scene_techniques import change_setting, current_settings, faced, slice_technique
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.library_words import translated_parameter
from volviz_ui.widgets.binding import show_value

DOT = 12


class PlaneBox(NoWheelComboBox):
    """Chooses the plane of a view that faces one.

    Parameters
    ----------
    store : Store
        The scene.
    view : int
        Number of the view.
    """

    def __init__(self, store: Store, view: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._view = view
        self._parameter = next(p for p in slice_technique().parameters if p.name == "plane")
        for plane, words in translated_parameter(self._parameter).choices:
            if plane in PLANE_COLORS:
                self.addItem(_dot(PLANE_COLORS[plane]), words, plane)
        self.setAccessibleName(self.tr("Plane of view %1").replace("%1", str(view + 1)))
        self.setToolTip(
            self.tr("Which plane is seen here; its colour is that of its lines in the other views")
        )
        show_value(store, lambda scene: plane_of(scene, view), self._show)
        self.activated.connect(self._on_activated)

    def _show(self, plane: str) -> None:
        self.setCurrentIndex(self.findData(plane))

    def _on_activated(self, index: int) -> None:
        change_setting(self._store, self._parameter, self.itemData(index), view=self._view)


def plane_of(scene: Scene, view: int) -> str:
    """The plane that a view faces, empty for none."""
    return "" if faced(scene, view) is None else str(current_settings(scene, view).plane)


def _dot(color: tuple[float, float, float]) -> QIcon:
    """A disc of a colour."""
    pixmap = QPixmap(2 * DOT, 2 * DOT)
    pixmap.setDevicePixelRatio(2.0)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor.fromRgbF(*color))
    painter.drawEllipse(1, 1, DOT - 2, DOT - 2)
    painter.end()
    return QIcon(pixmap)
