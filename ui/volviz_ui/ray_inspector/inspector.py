"""Between the window and the panel: which ray is looked at, and when it is followed again."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from PySide6.QtCore import QObject, QPointF, QTimer, Signal

from volviz.custom_gl.settings import common_settings
from volviz.errors import VolvizError
from volviz.model.render_spec import RenderSpec, View
from volviz.ray_inspection import RayInspection, inspect_ray
from volviz.volume_data.volume import Volume
from volviz_ui.ray_inspector.panel import RayPanel
from volviz_ui.session.documents import Documents
from volviz_ui.session.workers import Workers

if TYPE_CHECKING:
    from volviz_ui.views.view_grid import ViewGrid

FOLLOW_MS = 15
"""After a change the ray is followed again this much later; further changes until then cost nothing."""
SHORT_RAY = 4000
"""Up to so many samples are computed at once, longer rays on a worker."""


class _Request(NamedTuple):
    """Everything that decides what the ray gathers; compared before anything is computed."""

    spec: RenderSpec
    volume: Volume
    view: View
    pixel: tuple[int, int]
    depth: float | None

    def inspected(self) -> RayInspection:
        """Follow the ray; from any thread."""
        return inspect_ray(self.spec, self.view, self.pixel, depth=self.depth)

    @property
    def is_short(self) -> bool:
        """Whether the ray takes a few milliseconds only, less than a worker may keep one waiting."""
        common = common_settings(self.spec.settings)
        step = common.step * min(self.volume.spacing)
        return not common.preintegrated and float(np.linalg.norm(self.volume.extent)) / step < SHORT_RAY


class RayInspector(QObject):
    """Follows the ray behind a pixel while its panel is open, and again whenever something changes.

    The pixel is kept as a fraction of the viewport: turning the view or editing the transfer function shows
    what happens to the ray behind the same spot of the screen.

    Parameters
    ----------
    documents, workers
        Those of the window.
    views : ViewGrid
        Where a click chooses the pixel; the ray is that of the active view, its mark is shown in all of them.
    panel : RayPanel
        Shows the ray.
    """

    value_pointed = Signal(object)
    """Value of the chosen sample, None without one."""

    def __init__(
        self,
        documents: Documents,
        workers: Workers,
        views: ViewGrid,
        panel: RayPanel,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._documents, self._workers = documents, workers
        self._views, self.panel = views, panel
        self.place: tuple[float, float] | None = None
        self.is_active = False
        self._shown: _Request | None = None
        self._working: _Request | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(FOLLOW_MS)
        self._timer.timeout.connect(self._follow)
        views.clicked.connect(self._on_clicked)
        views.drawn.connect(self._ask)
        documents.changed.connect(self._ask)
        panel.pixel_entered.connect(self._on_pixel_entered)
        panel.cleared.connect(self.clear)
        panel.plot.sample_chosen.connect(self._show_sample)

    @property
    def is_settled(self) -> bool:
        """Whether the panel shows the present state."""
        return not self._timer.isActive() and self._working is None

    # ------------------------------------------------------------------ what is inspected

    def set_active(self, active: bool) -> None:
        """The panel is opened or closed; opened for the first time it follows the middle of the image."""
        if active == self.is_active:
            return
        self.is_active = active
        if active:
            self.place = self.place or (0.5, 0.5)
            self._ask()
        else:
            self._timer.stop()
            self._shown = None
            self._views.show_ray_mark(None)
            self.value_pointed.emit(None)

    def inspect(self, place: tuple[float, float]) -> None:
        """Follow the ray at fractions of the viewport's width and height, from the upper left."""
        self.place = (min(max(place[0], 0.0), 1.0), min(max(place[1], 0.0), 1.0))
        self._ask()

    def clear(self) -> None:
        """Forget the ray."""
        self.place = None
        self._shown = None
        self.panel.show_ray(None, "", "", (0.0, 1.0))
        self._views.show_ray_mark(None)
        self.value_pointed.emit(None)

    def close(self) -> None:
        """The window ends."""
        self._timer.stop()
        self._documents.changed.disconnect(self._ask, missing_ok=True)

    # ------------------------------------------------------------------ following

    def _on_clicked(self, view: int, position: QPointF) -> None:
        if self.is_active:
            viewport = self._views.view_widgets[view].viewport
            self.inspect((position.x() / viewport.width(), position.y() / viewport.height()))

    def _on_pixel_entered(self, column: int, row: int) -> None:
        width, height = self._views.active.viewport.pixel_size
        self.inspect(((column + 0.5) / width, (row + 0.5) / height))

    def _ask(self, *_ignored: object) -> None:
        if self.is_active and self.place is not None and not self._timer.isActive():
            self._timer.start()

    def _request(self) -> _Request | None:
        scene, volume = self._documents.shown.scene, self._documents.volume
        if self.place is None or volume is None or scene.layer is None:
            return None
        view_widget = self._views.active
        width, height = size = view_widget.viewport.pixel_size
        pixel = (min(int(self.place[0] * width), width - 1), min(int(self.place[1] * height), height - 1))
        camera = view_widget.viewport.renderer.GetActiveCamera()
        return _Request(
            self._documents.shown.active_spec(view_widget.view),
            volume,
            View(view_widget.viewport.view_camera, size, clipping_range=camera.GetClippingRange()),
            pixel,
            view_widget.controller.opaque_depth(*pixel),
        )

    def _follow(self) -> None:
        if not self.is_active or self._working is not None:
            return
        request = self._request()
        if request is None:
            self._shown = None
            self.panel.show_ray(None, "", "", (0.0, 1.0))
            self._views.show_ray_mark(None)
            return
        if request == self._shown:
            return
        if request.is_short:
            self._show(request, request.inspected)
            return
        self._working = request
        task = self._workers.start(lambda _task: request.inspected())
        task.succeeded.connect(self._on_inspected)
        task.failed.connect(self._on_failed)
        task.ended.connect(self._on_ended)

    def _on_inspected(self, found: RayInspection) -> None:
        request = self._working
        if request is not None and self.is_active and self.place is not None:
            self._show(request, lambda: found)

    def _show(self, request: _Request, inspect: Callable[[], RayInspection]) -> None:
        self._shown = request
        try:
            found = inspect()
        except VolvizError as error:
            self._say(error)
            return
        volume = request.volume
        length_unit = str(volume.metadata.get("length_unit", "mm"))
        self.panel.show_pixel(found.pixel)
        self.panel.show_ray(found, volume.unit, length_unit, volume.range)
        self._views.show_ray_mark(
            (
                (found.pixel[0] + 0.5) / request.view.size[0],
                1.0 - (found.pixel[1] + 0.5) / request.view.size[1],
            )
        )
        self._show_sample(self.panel.plot.chosen)

    def _on_failed(self, error: object) -> None:
        self._shown = self._working
        self._say(error)

    def _say(self, error: object) -> None:
        """There is no ray, and why."""
        self.panel.show_ray(None, "", "", (0.0, 1.0))
        self.panel.sentence.setText(str(error))

    def _on_ended(self) -> None:
        self._working = None
        # what has changed meanwhile; nothing is computed when it is the same
        self._ask()

    def _show_sample(self, index: int) -> None:
        """Tell the value of the chosen sample."""
        found = self.panel.plot.found
        if not self.is_active or found is None:
            return
        is_there = 0 <= index < len(found.profile.values)
        self.value_pointed.emit(float(found.profile.values[index]) if is_there else None)
