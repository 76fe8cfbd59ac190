"""What is under the pointer: voxel and value in the status line and in the curve, and the place to turn about."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from PySide6.QtCore import QObject, QPointF, QTimer, Signal

from volviz.custom_gl.picking import Picked
from volviz.measure.results import length_unit
from volviz.model.layers import LabelLayer
from volviz.model.manipulators import as_vector
from volviz.model.store import Store
from volviz_ui.session.documents import Documents
from volviz_ui.transfer_editor import TransferEditor
from volviz_ui.views.camera_moves import flown
from volviz_ui.views.view_grid import ViewGrid
from volviz_ui.widgets.status_line import StatusLine

DELAY_MS = 25


class Pointer(QObject):
    """Follows the pointer over the views; nothing is looked up while something is dragged.

    Attributes
    ----------
    label_clicked, label_double_clicked : signals (int, int)
        A label was clicked on: the number of its layer, and its own.
    """

    label_clicked = Signal(int, int)
    label_double_clicked = Signal(int, int)

    def __init__(
        self,
        store: Store,
        documents: Documents,
        views: ViewGrid,
        status_line: StatusLine,
        editor: TransferEditor,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self._views = views
        self._status_line = status_line
        self._editor = editor
        self._place: tuple[int, QPointF] | None = None
        """Number of the view under the pointer, and where the pointer is in it."""
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(DELAY_MS)
        self._timer.timeout.connect(self._look)
        views.pointer_moved.connect(self._on_moved)
        views.pointer_left.connect(self._on_left)
        views.clicked.connect(self._on_clicked)
        views.double_clicked.connect(self._turn_about)

    def stop(self) -> None:
        """Look up nothing any more: the window closes."""
        self._timer.stop()

    def _on_moved(self, view: int, position: QPointF) -> None:
        self._place = (view, position)
        if not self._timer.isActive():
            self._timer.start()

    def _on_left(self) -> None:
        self._place = None
        self._show(None)

    def _look(self) -> None:
        if self._place is None or self._documents.volume is None:
            return
        view, position = self._place
        if view >= len(self._views.view_widgets):
            return
        if self._store.is_interacting:
            # afterwards: while something moves, every repaint of a panel costs frames
            self._timer.start()
            return
        self._show(self._picked_in(view, position))

    def _picked_in(self, view: int, position: QPointF) -> Picked | None:
        """What is seen in a view at a place, None for nothing."""
        view_widget = self._views.view_widgets[view]
        handle = view_widget.controller.handle
        if handle is None or not self._documents.is_current:
            return None
        ratio = view_widget.viewport.devicePixelRatioF()
        picked: Picked | None = handle.pick(position.x() * ratio, position.y() * ratio)
        return picked

    def _turn_about(self, view: int, position: QPointF) -> None:
        """Look at what is seen at a place, so that the camera turns about it from now on."""
        picked = self._picked_in(view, position)
        if picked is None:
            return
        if picked.label is not None:
            number = self._layer_of(picked)
            if number is not None:
                self.label_double_clicked.emit(number, picked.label)
                return
        first = self._views.first
        camera = first.viewport.view_camera
        way = np.subtract(picked.position, camera.focal_point)
        first.controller.show_camera(
            replace(
                camera,
                position=as_vector(np.add(camera.position, way)),
                focal_point=picked.position,
                parallel_scale=camera.parallel_scale,
            )
        )

    def _others(self, picked: Picked) -> list[str]:
        """Names and values of the other visible layers at a place."""
        shown, own = self._documents.shown, self._layer_of(picked)
        words = []
        for number, layer in enumerate(shown.scene.layers):
            volume = shown.volumes.get(layer.key)
            if volume is None or number == own or not layer.visible:
                continue
            placed = volume if layer.transform is None else volume.moved(layer.transform)
            found = placed.value_at(picked.position)
            if found is None:
                continue
            if isinstance(layer, LabelLayer):
                told = dict(layer.names).get(int(found)) or f"{found:.0f}"
            else:
                told = f"{found:.6g} {volume.unit}".rstrip()
            words.append(f"{layer.name or volume.name} {told}")
        return words

    def _on_clicked(self, view: int, position: QPointF) -> None:
        if not any(isinstance(layer, LabelLayer) for layer in self._documents.shown.scene.layers):
            return
        picked = self._picked_in(view, position)
        if picked is not None and picked.label is not None:
            number = self._layer_of(picked)
            if number is not None:
                self.label_clicked.emit(number, picked.label)

    def _layer_of(self, picked: Picked) -> int | None:
        """Number of the layer that was picked."""
        shown = self._documents.shown
        for number, layer in enumerate(shown.scene.layers):
            volume = shown.volumes.get(layer.key)
            if picked.volume is None or volume is None:
                continue
            # what a transform has moved is another volume of the same values
            if volume.array is picked.volume.array and isinstance(layer, LabelLayer) == (
                picked.label is not None
            ):
                return number
        return None

    def fly_to(self, bounds: tuple[float, float, float, float, float, float]) -> None:
        """Look at a world box."""
        first = self._views.first
        first.controller.show_camera(flown(first.viewport.view_camera, bounds))

    def _words(self, picked: Picked) -> str:
        """Which layer is picked where there are several, and which label."""
        layers = self._documents.shown.scene.layers
        number = self._layer_of(picked) if len(layers) > 1 else None
        if number is None:
            return ""
        layer = layers[number]
        if isinstance(layer, LabelLayer) and picked.label is not None:
            return dict(layer.names).get(picked.label) or f"{layer.name} {picked.label}".strip()
        return layer.name

    def _show(self, picked: Picked | None) -> None:
        active = self._documents.volume
        volume = active if picked is None or picked.volume is None else picked.volume
        value = None
        if picked is not None and volume is not None:
            i, j, k = picked.voxel
            # a surface has a value of its own; elsewhere the number that stands in the file is looked for
            value = picked.isovalue if picked.isovalue is not None else float(volume.array[k, j, i])
        if picked is None or volume is None:
            self._status_line.show_picked(None)
        else:
            unit = length_unit(volume)
            place = ", ".join(f"{v:.1f}" for v in picked.position) + f" {unit}"
            words = [f"{value:.6g} {volume.unit}".rstrip(), self._words(picked)]
            if len(self._documents.shown.scene.layers) > 1:
                words += self._others(picked)
            self._status_line.show_picked(picked.voxel, place, "   ".join(each for each in words if each))
        self._editor.highlight_value(value if volume is active else None)
