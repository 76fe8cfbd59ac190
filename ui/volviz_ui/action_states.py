"""Which commands are possible and which are switched on, as the scene says."""

from __future__ import annotations

from PySide6.QtCore import QObject

from volviz.model.store import Store
from volviz_ui.actions import Actions
from volviz_ui.binding import show_value
from volviz_ui.surface import Surface, shows_mesh


class ActionStates(QObject):
    """Keeps menus and tool bar true."""

    def __init__(
        self, store: Store, actions: Actions, surface: Surface, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._store = store
        self._actions = actions
        self._surface = surface
        surface.facts_changed.connect(lambda _facts: self._show_mesh(shows_mesh(store.scene)))
        store.history_changed.connect(self._show_history)
        show_value(store, lambda scene: scene.view.technique, self._show_technique)
        show_value(store, shows_mesh, self._show_mesh)
        show_value(
            store, lambda scene: bool(scene.view.camera and scene.view.camera.parallel), self._show_parallel
        )
        show_value(store, lambda scene: len(scene.views), self._show_view_count)
        show_value(store, lambda scene: scene.comparison.mode, self._show_mode)
        show_value(store, lambda scene: scene.comparison.distances, self._show_distances)
        self._show_history()

    def _show_technique(self, technique: str) -> None:
        for action in self._actions.techniques:
            action.setChecked(action.data() == technique)

    def _show_mesh(self, shown: bool) -> None:
        facts = self._surface.facts
        self._actions.export_mesh.setEnabled(shown and facts is not None and facts.metrics.faces > 0)

    def _show_parallel(self, parallel: bool) -> None:
        self._actions.parallel.setChecked(parallel)

    def _show_view_count(self, count: int) -> None:
        actions = self._actions
        actions.split.setChecked(count > 1)
        for action in (actions.next_view, actions.close_view, actions.swap_views, actions.report):
            action.setEnabled(count > 1)

    def _show_mode(self, mode: str) -> None:
        for action in self._actions.modes:
            action.setChecked(action.data() == mode)

    def _show_distances(self, distances: str) -> None:
        self._actions.distances.setChecked(distances != "off")

    def _show_history(self) -> None:
        for action, label, words in (
            (self._actions.undo, self._store.undo_label, self.tr("&Undo")),
            (self._actions.redo, self._store.redo_label, self.tr("&Redo")),
        ):
            action.setEnabled(label is not None)
            action.setText(words if label is None else f"{words} “{label}”")
            key = action.shortcut().toString(action.shortcut().SequenceFormat.NativeText)
            action.setToolTip(f"{action.text().replace('&', '')} ({key})")
