"""The technique dock: what draws, what that means, and its settings."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QCoreApplication, QEvent, QTimer
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from volviz.custom_gl.scene_techniques import (
    change_setting,
    current_settings,
    current_technique,
    reset_settings,
)
from volviz.custom_gl.technique import TechniqueInfo
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.store import Store
from volviz.volume_data.volume import Volume
from volviz_ui.editors.technique_box import TechniqueBox
from volviz_ui.library_words import translated
from volviz_ui.panels.form_cache import FormCache
from volviz_ui.panels.light import LightSection
from volviz_ui.panels.mesh_section import MeshSection
from volviz_ui.panels.panel import Panel
from volviz_ui.panels.settings_form import SettingsForm
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import volume_of
from volviz_ui.session.mesh_summary import shows_mesh
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.focus_order import set_focus_order
from volviz_ui.widgets.small import quiet_label, small_button


class TechniquePanel(Panel):
    """Shows and changes the technique of the active view and its settings."""

    def __init__(self, store: Store, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self._volume = documents.volume
        self._folded: set[str] = set()
        self.form: SettingsForm | None = None
        self.forms = FormCache(self._made_form, store, self)
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._take_volume)
        self.box = TechniqueBox(store, self)
        self.summary: QLabel = quiet_label()
        self.summary.setWordWrap(True)
        self.summary.setToolTip(self.tr("What this technique does"))
        # two lines always, so that the settings do not jump when the words change
        self.summary.setMinimumHeight(2 * self.fontMetrics().lineSpacing())
        self.light = LightSection(store, documents, self)
        self.reset_all = small_button(
            "arrow-counter-clockwise", self.tr("All settings of this technique back to their defaults"), self
        )
        self.reset_all.clicked.connect(self._on_reset_all)
        head = QWidget(self.body)
        line = QHBoxLayout(head)
        line.setContentsMargins(0, 0, 0, 0)
        line.setSpacing(4)
        line.addWidget(self.box, 1)
        line.addWidget(self.reset_all)
        self.surface = MeshSection(self)
        for widget in (head, self.summary, self.surface, self.light):
            self.add(widget)
        show_value(documents, lambda shown: shown.scene.view.technique, self.show_technique)
        show_value(documents, lambda shown: current_settings(shown.scene), self.show_settings)
        show_value(documents, lambda shown: shows_mesh(shown.scene), self._show_surface)
        show_value(documents, volume_of, self._on_volume, now=False)

    def _show_surface(self, on: bool) -> None:
        self.surface.setVisible(on)

    def _on_volume(self, _volume: Volume | None) -> None:
        # widgets are made anew, which has time until the next turn of the event loop
        self._timer.start()

    def _take_volume(self) -> None:
        volume = self._volume = self._documents.volume
        if self.form is not None and not self.form.fits(volume):
            self.column.removeWidget(self.form)
            self.form = None
        self.forms.make_for(volume)
        self._show_form()

    def forget_forms(self) -> None:
        """Keep the form that is shown and no other."""
        self.forms.keep_only(self.form)
        if self.isVisible():
            self.forms.make_more()

    def show_technique(self, _technique: str) -> None:
        """Show the settings of another technique."""
        self._show_form()

    def show_settings(self, settings: Any) -> None:
        """Show the values of the settings."""
        info = current_technique(self._documents.shown.scene)
        if self.form is not None and self.form.info is info:
            self.form.show_settings(settings)

    def _made_form(self, info: TechniqueInfo, volume: Volume | None) -> SettingsForm:
        form = SettingsForm(info, self._is_open, volume, self.body)
        form.hide()
        form.setting_changed.connect(self._on_setting_changed)
        form.gesture_started.connect(lambda name: self._store.begin_gesture(("setting", info.id, name)))
        form.gesture_finished.connect(lambda name: self._store.end_gesture(("setting", info.id, name)))
        form.section_folded.connect(self._on_folded)
        return form

    def _is_open(self, group: str) -> bool:
        return group not in self._folded

    def _show_form(self) -> None:
        info = current_technique(self._documents.shown.scene)
        self.summary.setText(translated(info.summary))
        old, form = self.form, self.forms.form(info)
        form.fold(self._is_open)
        form.show_settings(current_settings(self._documents.shown.scene))
        if self._volume is not None:
            form.show_automatic(automatic_values(self._volume))
        if form is not old:
            if old is not None:
                self.column.removeWidget(old)
                old.hide()
            self.column.insertWidget(2, form)
            form.show()
            self.form = form
            set_focus_order(self.body)
        # at once: painted before the layout has settled, the new form would be seen squeezed for a moment
        QCoreApplication.sendPostedEvents(self.body, QEvent.Type.LayoutRequest.value)
        self.updateGeometry()
        if self.isVisible():
            self.forms.make_more()

    def showEvent(self, event: QShowEvent) -> None:
        """Somebody looks: further forms are made in quiet times."""
        super().showEvent(event)
        self.forms.make_more()

    def hideEvent(self, event: QHideEvent) -> None:
        """Nobody looks."""
        super().hideEvent(event)
        self.forms.stop()

    def _on_setting_changed(self, name: str, value: Any) -> None:
        if not self._documents.is_current:
            self.show_settings(current_settings(self._documents.shown.scene))
            return  # a volume is awaited, with settings of its own
        info = current_technique(self._documents.shown.scene)
        parameter = next(p for p in info.parameters if p.name == name)
        change_setting(self._store, parameter, value, gesture=("setting", info.id, name))

    def _on_folded(self, title: str, open_: bool) -> None:
        if open_:
            self._folded.discard(title)
        else:
            self._folded.add(title)

    def _on_reset_all(self) -> None:
        reset_settings(self._store, self.tr("Reset settings"))


def automatic_values(volume: Volume) -> dict[str, Any]:
    """What settings that are left to the program stand for, by name."""
    isovalue = auto_isovalue(volume)
    return {
        "opacity_unit_distance": volume.mean_spacing,
        "isovalue": isovalue,
        "isovalues": (isovalue,),
    }
