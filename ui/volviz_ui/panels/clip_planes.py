"""Clip planes: a slider moves each along its normal, two buttons turn it round and take it away."""

from __future__ import annotations

import dataclasses
from functools import partial

import numpy as np
from PySide6.QtCore import QPoint, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu, QPushButton, QVBoxLayout, QWidget

from volviz.model.clipping import MAX_PLANES, Plane
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.volume_data.volume import Volume
from volviz_ui.editors.number import Scale, SliderField
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import volume_of
from volviz_ui.style.icons import set_icon
from volviz_ui.widgets.binding import send_gesture, send_value, show_value
from volviz_ui.widgets.small import small_button

Planes = tuple[Plane, ...]
GESTURE = "clip planes"


class ClipPlanes(QWidget):
    """The list of clip planes and a button that adds one."""

    planes_changed = Signal(object)

    def __init__(self, store: Store, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self._volume: Volume | None = None
        self.rows: list[_PlaneRow] = []
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(4)
        self.add = QPushButton(self.tr("Add plane"), self)
        self.add.setToolTip(self.tr("Cut away what lies on one side of a plane; up to six planes"))
        set_icon(self.add, "plus")
        self.add.clicked.connect(self._show_menu)
        self._column.addWidget(self.add)
        send_value(self.planes_changed, store, _with_planes, label=self.tr("Clip planes"), gesture=GESTURE)
        show_value(documents, volume_of, self._show_volume)
        show_value(documents, lambda shown: shown.scene.clipping.planes, self.show_planes)

    def _show_volume(self, volume: Volume | None) -> None:
        self._volume = volume
        self.setEnabled(volume is not None)
        # the range of the sliders is that of the volume
        self._clear()
        self.show_planes(self._planes())

    def show_planes(self, planes: Planes) -> None:
        """Show all planes; rows stay when only their places have changed."""
        if self._volume is None:
            return
        normals = [row.normal for row in self.rows]
        if normals != [normal for _origin, normal in planes]:
            self._clear()
            for number, plane in enumerate(planes):
                row = _PlaneRow(number, plane, self._volume, self)
                row.moved.connect(partial(self._on_moved, number))
                row.turned.connect(partial(self._on_turned, number))
                row.removed.connect(partial(self._on_removed, number))
                send_gesture(
                    row.position.gesture_started, row.position.gesture_finished, self._store, GESTURE
                )
                self._column.insertWidget(number, row)
                self.rows.append(row)
        for row, plane in zip(self.rows, planes, strict=True):
            row.show_plane(plane)
        self.add.setEnabled(len(planes) < MAX_PLANES)
        self.updateGeometry()

    def add_plane(self, normal: tuple[float, float, float]) -> None:
        """One more plane through the middle of the volume."""
        if self._volume is not None:
            self._send((*self._planes(), (self._volume.center, normal)))

    def _planes(self) -> Planes:
        return self._documents.shown.scene.clipping.planes

    def _send(self, planes: Planes) -> None:
        # while another volume is awaited, its scene has planes of its own
        if self._documents.is_current:
            self.planes_changed.emit(planes)

    def _clear(self) -> None:
        for row in self.rows:
            self._column.removeWidget(row)
            row.hide()
            row.deleteLater()
        self.rows = []

    def _show_menu(self) -> None:
        menu = QMenu(self)
        for words, normal in (
            (self.tr("Sagittal (left–right)"), (1.0, 0.0, 0.0)),
            (self.tr("Coronal (front–back)"), (0.0, 1.0, 0.0)),
            (self.tr("Axial (head–feet)"), (0.0, 0.0, -1.0)),
        ):
            menu.addAction(words).triggered.connect(partial(self.add_plane, normal))
        camera = self._documents.shown.scene.view.camera
        if camera is not None:
            menu.addAction(self.tr("Facing the view")).triggered.connect(
                partial(self.add_plane, camera.direction)
            )
        menu.exec(self.add.mapToGlobal(QPoint(0, self.add.height())))
        menu.deleteLater()

    def _on_moved(self, number: int, origin: tuple[float, float, float]) -> None:
        planes = list(self._planes())
        planes[number] = (origin, planes[number][1])
        self._send(tuple(planes))

    def _on_turned(self, number: int) -> None:
        planes = list(self._planes())
        origin, (x, y, z) = planes[number]
        planes[number] = (origin, (-x, -y, -z))
        self._send(tuple(planes))

    def _on_removed(self, number: int) -> None:
        planes = self._planes()
        self._send(planes[:number] + planes[number + 1 :])


class _PlaneRow(QWidget):
    moved = Signal(object)
    turned = Signal()
    removed = Signal()

    def __init__(self, number: int, plane: Plane, volume: Volume, parent: QWidget) -> None:
        super().__init__(parent)
        self.normal = plane[1]
        self._center = np.asarray(volume.center)
        along = (volume.corners - self._center) @ np.asarray(self.normal)
        low, high = float(along.min()), float(along.max())
        self.position = SliderField(Scale(low, high), minimum=low, maximum=high, parent=self)
        words = self.tr("Place of the plane along its normal, from the middle of the volume")
        for part in (self.position.slider, self.position.field):
            part.setToolTip(words)
            part.setAccessibleName(words)
        turn = small_button("arrows-left-right", self.tr("Keep the other side"), self)
        remove = small_button("trash", self.tr("Remove this plane"), self)
        turn.clicked.connect(self.turned)
        remove.clicked.connect(self.removed)
        self.position.value_changed.connect(self._on_value)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(QLabel(str(number + 1), self))
        layout.addWidget(self.position, 1)
        layout.addWidget(turn)
        layout.addWidget(remove)

    def show_plane(self, plane: Plane) -> None:
        self.position.set_value(float((np.asarray(plane[0]) - self._center) @ np.asarray(self.normal)))

    def _on_value(self, value: float) -> None:
        x, y, z = self._center + value * np.asarray(self.normal)
        self.moved.emit((float(x), float(y), float(z)))


def _with_planes(scene: Scene, planes: Planes) -> Scene:
    return dataclasses.replace(scene, clipping=dataclasses.replace(scene.clipping, planes=planes))
