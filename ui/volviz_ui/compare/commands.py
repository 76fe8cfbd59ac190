"""What the Compare menu does: more views and fewer, and how they are looked at together."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject

from volviz.model.comparison import Mode
from volviz.model.scene import Scene

if TYPE_CHECKING:
    from volviz_ui.main_window import MainWindow


class CompareCommands(QObject):
    """Changes the views of the scene for the window."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._store = window.store

    def set_view_count(self, count: int) -> None:
        """Show one, two or four views; new ones begin as the active one is."""
        if count != len(self._store.scene.views):
            self._store.update(
                lambda scene: scene.with_view_count(count),
                label=self.tr("One view") if count == 1 else self.tr("%1 views").replace("%1", str(count)),
            )

    def split(self, on: bool) -> None:
        """Two views, or the first one alone again."""
        self.set_view_count(2 if on else 1)

    def activate_next(self) -> None:
        """Let panels and keys act on the next view."""
        self._look(lambda scene: replace(scene, active=(scene.active_index + 1) % len(scene.views)))

    def close_active(self) -> None:
        """Close the active view; the others stay."""
        self._store.update(
            lambda scene: scene.without_view(scene.active_index), label=self.tr("Close a view")
        )

    def swap(self) -> None:
        """Exchange the first view and its counterpart."""

        def swapped(scene: Scene) -> Scene:
            if len(scene.views) < 2:
                return scene
            first, second, *others = scene.views
            return replace(scene, views=(second, first, *others))

        self._store.update(swapped, label=self.tr("Exchange the views"))

    def set_mode(self, mode: Mode) -> None:
        """Look at the views side by side, as a wipe, blinking, or at their difference."""
        if len(self._store.scene.views) == 1 and mode != "side_by_side":
            self.set_view_count(2)
        self.change(mode=mode)

    def change(self, **changes: Any) -> None:
        """Look at the views in another way; like the camera no step of the history."""
        self._look(lambda scene: replace(scene, comparison=replace(scene.comparison, **changes)))

    def _look(self, change: Any) -> None:
        self._store.update(change, label=self.tr("Comparison"), record=False)
