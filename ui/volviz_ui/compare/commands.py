"""What the Compare menu does: more views and fewer, and how they are looked at together."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject

from volviz.custom_gl.scene_techniques import counterparts, current_technique
from volviz.framing import visible_points
from volviz.model.comparison import Mode
from volviz.model.scene import Scene
from volviz_ui.compare.settings_match import match_second
from volviz_ui.views.fitting import fitted

if TYPE_CHECKING:
    from volviz_ui.main_window import MainWindow


class CompareCommands(QObject):
    """Changes the views of the scene for the window."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._store = window.store

    def set_view_count(self, count: int) -> None:
        """Show one, two or four views; new ones begin as the active one is.

        Whoever asks for more than two wants to see them, so they come side by side.
        """

        def counted(scene: Scene) -> Scene:
            comparison = scene.comparison if count <= 2 else replace(scene.comparison, mode="side_by_side")
            return replace(scene, comparison=comparison).with_view_count(count)

        if count != len(self._store.scene.views):
            self._change_views(
                counted,
                self.tr("One view") if count == 1 else self.tr("%1 views").replace("%1", str(count)),
            )

    def _change_views(self, change: Any, label: str) -> None:
        """Have other views; what was seen whole is not cut off by narrower ones."""
        before = self._window.viewport.aspect
        self._store.update(change, label=label)
        volume, layer = self._window.documents.volume, self._store.scene.layer
        camera = self._store.scene.view.camera
        if volume is None or layer is None or camera is None:
            return
        points = visible_points(volume, layer.transfer_function)
        farther = fitted(camera, points, before, self._window.viewport.aspect)
        if farther != camera:
            self._window.display.show_camera(farther)

    def split(self, on: bool) -> None:
        """Two views and the panel that compares them, or the first view alone again."""
        if on:
            self.show_panel()
        self.set_view_count(2 if on else 1)

    def show_panel(self) -> None:
        """Bring the Compare panel to the front."""
        dock, data = self._window.compare_dock, self._window.docks[0]
        if not dock.isVisible() and not dock.isFloating():
            self._window.tabifyDockWidget(data, dock)
        dock.show()
        dock.raise_()
        # at once: what the views have left decides whether the camera must step back
        self._window.layout().activate()

    def compare_with_vtk(self) -> None:
        """Put VTK's counterpart with the same settings beside the active view."""
        scene = self._store.scene
        info = current_technique(scene)
        other = next((c for c in counterparts() if info.id in c.counterpart_of), None)
        if other is None:
            self._window.status_line.showMessage(
                self.tr("VTK has nothing like %1").replace("%1", info.label), 5000
            )
            return

        def beside(scene: Scene) -> Scene:
            view = scene.view
            views = (view, replace(view, technique=other.id))
            changed = replace(scene.with_view_count(2), views=views, active=0)
            return match_second(changed, 0, 1)

        self.show_panel()
        self._change_views(beside, self.tr("Compare with VTK"))

    def activate_next(self) -> None:
        """Let panels and keys act on the next view of those that are seen."""

        def next_one(scene: Scene) -> Scene:
            seen = sorted(scene.seen)
            return replace(scene, active=next((v for v in seen if v > scene.active_index), seen[0]))

        self._look(next_one)

    def close_active(self) -> None:
        """Close the active view; the others stay."""
        self._store.update(
            lambda scene: scene.without_view(scene.active_index), label=self.tr("Close a view")
        )

    def swap(self) -> None:
        """Let A and B change places."""

        def swapped(scene: Scene) -> Scene:
            if scene.pair is None:
                return scene
            first, second = scene.pair
            views = list(scene.views)
            views[first], views[second] = views[second], views[first]
            return replace(scene, views=tuple(views))

        self._store.update(swapped, label=self.tr("Exchange A and B"))

    def set_mode(self, mode: Mode) -> None:
        """Look at the views side by side, or at A and B as a wipe, blinking, or at their difference."""
        if len(self._store.scene.views) == 1 and mode != "side_by_side":
            self.set_view_count(2)

        def looked_at(scene: Scene) -> Scene:
            changed = replace(scene, comparison=replace(scene.comparison, mode=mode))
            # panels and keys act on what is seen
            return (
                changed if changed.active_index in changed.seen else replace(changed, active=changed.seen[0])
            )

        self._look(looked_at)

    def color_distances(self, on: bool) -> None:
        """Colour two surfaces by their distance, or give them their own colours back; say where there are not two."""
        scene = self._store.scene
        self.change(distances="signed" if on else "off")
        if not on:
            return
        self.show_panel()
        pair = self._window.views.arrangement.pair
        if pair is None or not all(current_technique(scene, pane.view).colors_surface for pane in pair):
            self._window.status_line.showMessage(
                self.tr(
                    "Distances are shown where two views draw surfaces of triangles, as Marching cubes does"
                ),
                8000,
            )

    def change(self, **changes: Any) -> None:
        """Look at the views in another way; like the camera no step of the history."""
        self._look(lambda scene: replace(scene, comparison=replace(scene.comparison, **changes)))

    def _look(self, change: Any) -> None:
        self._store.update(change, label=self.tr("Comparison"), record=False)
