"""The light of the scene: at the eye or in a place, and its colour."""

from __future__ import annotations

import dataclasses
from typing import Any

from PySide6.QtWidgets import QLabel, QWidget

from volviz.custom_gl.settings import SharedSettings
from volviz.model.light import Light, default_position
from volviz.model.parameters import parameters_of
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.volume_data.volume import Volume
from volviz_ui.editors import Editor, editor_for
from volviz_ui.editors.optional import OptionalEditor
from volviz_ui.library_words import translated_parameter
from volviz_ui.panels.panel import Section
from volviz_ui.panels.settings_form import LABEL_WIDTH
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import volume_of
from volviz_ui.widgets.binding import send_gesture, send_value, show_value

_FIELDS = {
    "headlight": "headlight",
    "light_beside_eye": "beside_eye",
    "light_position": "position",
    "light_color": "color",
}
"""Setting of `SharedSettings` and field of `Light`."""


class LightSection(Section):
    """Editors for the fields of `Light`."""

    def __init__(self, store: Store, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(self_title(), parent=parent)
        self.rows.setColumnMinimumWidth(0, LABEL_WIDTH)
        self.editors: dict[str, Editor] = {}
        self._words: dict[str, QLabel] = {}
        described = {p.name: p for p in parameters_of(SharedSettings)}
        for name, field in _FIELDS.items():
            parameter = translated_parameter(described[name])
            editor = editor_for(parameter)
            self._words[field] = self.add_row(
                parameter.label, editor, wide=editor.wide, tooltip=editor.toolTip()
            )
            self.editors[field] = editor
            send_value(editor.value_changed, store, _writer(field), label=parameter.label, gesture=name)
            send_gesture(editor.gesture_started, editor.gesture_finished, store, name)
        show_value(documents, volume_of, self._show_volume)
        show_value(documents, lambda shown: shown.scene.light, self.show_light)

    def show_light(self, light: Light) -> None:
        """Show a light."""
        for field, editor in self.editors.items():
            editor.set_value(getattr(light, field))
        for field, counts in (
            ("beside_eye", not light.headlight),
            ("position", not light.headlight and not light.beside_eye),
        ):
            self.editors[field].setEnabled(counts)
            self._words[field].setEnabled(counts)

    def _show_volume(self, volume: Volume | None) -> None:
        """Show where the automatic place is."""
        editor = self.editors["position"]
        if volume is not None and isinstance(editor, OptionalEditor):
            editor.set_fallback(default_position(volume.bounds))


def self_title() -> str:
    """Heading of the section, translated."""
    from PySide6.QtCore import QCoreApplication

    return QCoreApplication.translate("LightSection", "Light")


def _writer(field: str) -> Any:
    def write(scene: Scene, value: Any) -> Scene:
        return dataclasses.replace(scene, light=dataclasses.replace(scene.light, **{field: value}))

    return write
