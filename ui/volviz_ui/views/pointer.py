"""What is under the pointer: voxel and value in the status line and in the curve, and the place to turn about."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from PySide6.QtCore import QObject, QPointF, QTimer

from volviz.custom_gl.picking import Picked
from volviz.measure.results import length_unit
from volviz.model.layers import LabelLayer
from volviz.model.manipulators import as_vector
from volviz.model.store import Store
from volviz_ui.session.documents import Documents
from volviz_ui.transfer_editor import TransferEditor
from volviz_ui.views.view_grid import ViewGrid
from volviz_ui.widgets.status_line import StatusLine

DELAY_MS = 25


class Pointer(QObject):
    """Follows the pointer over the views; nothing is looked up while something is dragged."""

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

    def _values(self, picked: Picked) -> str:
        """The values of all visible layers at a place, with their names; empty where there is one layer only."""
        shown = self._documents.shown
        seen = [layer for layer in shown.scene.layers if layer.visible and layer.key in shown.volumes]
        if len(seen) < 2:
            return ""
        words = []
        for layer in seen:
            volume = shown.volumes[layer.key]
            placed = volume if layer.transform is None else volume.moved(layer.transform)
            found = placed.value_at(picked.position)
            if found is None:
                continue
            if isinstance(layer, LabelLayer):
                told = dict(layer.names).get(int(found)) or f"{found:.0f}"
            else:
                told = f"{found:.6g} {volume.unit}".rstrip()
            words.append(f"{layer.name or volume.name} {told}")
        return "   ".join(words)

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
            values = self._values(picked) or f"{value:.6g} {volume.unit}".rstrip()
            self._status_line.show_picked(picked.voxel, place, values)
        self._editor.highlight_value(value if volume is active else None)
