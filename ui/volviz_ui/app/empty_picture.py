"""An empty picture says why it is empty, and offers the cure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, QTimer

from volviz.custom_gl.scene_techniques import change_setting, current_settings, current_technique
from volviz.errors import VolvizError
from volviz.model.clipping import Clipping
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.transfer.function import TransferFunction
from volviz_ui.session.documents import Documents
from volviz_ui.views.view_grid import ViewGrid
from volviz_ui.widgets.banner import Banner

VISIBLE = 1.0 / 255.0
"""Opacity from which on a pixel shows anything."""


class EmptyPicture(QObject):
    """Looks at each complete picture of the active view of which something but the camera has changed.

    Parameters
    ----------
    store, documents, views
        What is shown, and where.
    banner : Banner
        Where it is said.
    """

    def __init__(
        self,
        store: Store,
        documents: Documents,
        views: ViewGrid,
        banner: Banner,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self._views = views
        self._banner = banner
        self._looked_at: Any = None
        self._cure: Callable[[], object] | None = None
        # after a frame, never within one
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.setInterval(0)
        self._rest.timeout.connect(self._look)
        views.drawn.connect(self._rest.start)
        banner.cure_requested.connect(self._on_cure_requested)

    def stop(self) -> None:
        """Look at nothing any more: the window closes."""
        self._rest.stop()
        self._views.drawn.disconnect(self._rest.start)

    def _look(self) -> None:
        shown, active = self._documents.shown, self._views.active
        if shown.volume is None or not active.controller.is_complete:
            return
        spec = shown.spec(active.view)
        if spec == self._looked_at:
            return
        try:
            pixels = active.controller.handle.read_image()
        except VolvizError:
            return  # not the picture of what is wanted
        self._looked_at = spec
        if pixels[..., 3].max() >= VISIBLE:
            self._cure = None
            self._banner.hide_hint()
            return
        words, label, self._cure = self._why(shown.scene)
        self._banner.show_hint(words, label)

    def _why(self, scene: Scene) -> tuple[str, str, Callable[[], object]]:
        """Why nothing is visible, and how to mend it: words, what stands on the button, what it does."""
        if scene.clipping.crop is not None or scene.clipping.planes:
            return (
                self.tr("Nothing is visible: crop box and clip planes leave nothing of what has an opacity."),
                self.tr("Show the whole volume"),
                self._show_whole,
            )
        mode = {p.name: p for p in current_technique(scene).parameters}.get("mode")
        if mode is not None and current_settings(scene).mode in ("average", "minimum"):
            return (
                self.tr("Nothing is visible: what the rays find is transparent in the transfer function."),
                self.tr("Use compositing"),
                partial(change_setting, self._store, mode, mode.default),
            )
        return (
            self.tr("Nothing is visible: the transfer function is transparent where the volume has values."),
            self.tr("Fit the function to the data"),
            self._fit_function,
        )

    def _show_whole(self) -> None:
        self._store.update(
            lambda scene: replace(scene, clipping=Clipping()), label=self.tr("Show the whole volume")
        )

    def _fit_function(self) -> None:
        volume = self._documents.volume
        if volume is not None:
            function = TransferFunction.auto(volume)
            self._store.update(
                lambda scene: scene.with_layer(transfer_function=function),
                label=self.tr("Fit the function to the data"),
            )

    def _on_cure_requested(self) -> None:
        if self._cure is not None:
            self._cure()
