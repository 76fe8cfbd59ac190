"""Isovalues as markers in the transfer-function plot, for techniques that draw surfaces."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject

from volviz.custom_gl.scene_techniques import change_setting, current_settings, current_technique
from volviz.model.parameters import setting_values
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.volume import Volume
from volviz_ui.binding import show_value
from volviz_ui.transfer_editor import TransferEditor
from volviz_ui.transfer_editor.model import GESTURE


class IsovalueMarkers(QObject):
    """Shows the isovalues of the technique in the editor's plot, and takes them from there when dragged."""

    def __init__(self, store: Store, editor: TransferEditor, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._editor = editor
        self._volume: Volume | None = None
        editor.isovalue_moved.connect(self._on_moved)
        show_value(store, _technique_and_settings, self._show)

    def set_volume(self, volume: Volume | None) -> None:
        """Take the automatic isovalue from another volume."""
        self._volume = volume
        self._show(None)

    def _show(self, _changed: Any) -> None:
        values = self._values()
        settings = current_settings(self._store.scene)
        self._editor.set_isovalues(values, tuple(setting_values(settings).get("colors", ())))

    def _values(self) -> tuple[float, ...]:
        scene = self._store.scene
        if self._volume is None:
            return ()
        return current_technique(scene).isovalues(current_settings(scene), self._volume)

    def _on_moved(self, index: int, value: float) -> None:
        info = current_technique(self._store.scene)
        values = list(self._values())
        if info.isovalue_parameter is None or not 0 <= index < len(values):
            return
        values[index] = value
        new = info.isovalue_values(values)[info.isovalue_setting]
        change_setting(self._store, info.isovalue_parameter, new, gesture=GESTURE)


def _technique_and_settings(scene: Scene) -> Any:
    return scene.view.technique, current_settings(scene)
