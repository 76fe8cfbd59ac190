"""Isovalues as markers in the transfer-function plot, for techniques that draw surfaces."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject

from volviz.custom_gl.scene_techniques import change_setting, current_settings, current_technique
from volviz.model.parameters import setting_values
from volviz.model.store import Store
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.transfer_editor import TransferEditor
from volviz_ui.transfer_editor.model import GESTURE
from volviz_ui.widgets.binding import show_value


class IsovalueMarkers(QObject):
    """Shows the isovalues of the technique in the editor's plot, and takes them from there when dragged."""

    def __init__(
        self, store: Store, documents: Documents, editor: TransferEditor, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self._editor = editor
        editor.isovalue_moved.connect(self._on_moved)
        show_value(documents, _markers, self._show)

    def _show(self, markers: tuple[Any, Any]) -> None:
        self._editor.set_isovalues(*markers)

    def _on_moved(self, index: int, value: float) -> None:
        info = current_technique(self._documents.shown.scene)
        values = list(_markers(self._documents.shown)[0])
        if info.isovalue_parameter is None or not 0 <= index < len(values):
            return
        values[index] = value
        new = info.isovalue_values(values)[info.isovalue_setting]
        change_setting(self._store, info.isovalue_parameter, new, gesture=GESTURE)


def _markers(shown: LoadedScene) -> tuple[Any, Any]:
    """Isovalues of the technique of the active view, and their colours as far as there are any."""
    if shown.volume is None:
        return (), ()
    settings = current_settings(shown.scene)
    values = current_technique(shown.scene).isovalues(settings, shown.volume)
    return values, tuple(setting_values(settings).get("colors", ()))
