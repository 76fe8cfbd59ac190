"""The Compare menu: more views and fewer, and how they are looked at together."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, Signal

from volviz.compare.settings_match import match_second
from volviz.custom_gl.framing import visible_points
from volviz.custom_gl.scene_techniques import counterparts, current_technique, with_various_views
from volviz.model.comparison import Mode
from volviz.model.scene import Scene
from volviz.model.view_edits import (
    with_comparison,
    with_counterpart,
    with_mode,
    with_next_active,
    with_pair_swapped,
)
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu, State
from volviz_ui.commands.view import panel_command
from volviz_ui.library_words import translated
from volviz_ui.views.fitting import fitted


class CompareCommands(QObject):
    """Changes the views of the scene for the window."""

    report_requested = Signal()

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._context = context
        self._store = context.store

    def menu(self) -> Menu:
        """The table of its commands."""
        tr, docks = self.tr, self._context.docks
        return Menu(
            tr("&Compare"),
            [
                Command(
                    "compare.one_view", tr("&One view"), tr("The first view alone"), partial(self.set_view_count, 1),
                    keys=("Ctrl+1",),
                ),
                Command(
                    "compare.split", tr("&Two views"), tr("Compare two techniques or settings, with one camera"),
                    self.split, keys=("Ctrl+2",), icon="square-half",
                    checked=lambda state: len(state.scene.views) == 2,
                ),
                Command(
                    "compare.four_views", tr("&Four views"), tr("Compare four of them"),
                    partial(self.set_view_count, 4), keys=("Ctrl+4",),
                ),
                Command(
                    "compare.with_vtk", tr("Compare with &VTK"),
                    tr("What VTK's own mapper draws, with the same settings, beside the active view"),
                    self.compare_with_vtk, keys=("Ctrl+K",),
                ),
                panel_command(docks, "compare"),
                panel_command(docks, "crosscheck"),
                None,
                self._mode("side_by_side", tr("&Side by side"), tr("All views beside one another"), "F6"),
                self._mode("wipe", tr("&Wipe"), tr("View B over view A, up to a line that can be dragged"), "F7"),
                self._mode("blink", tr("&Blink"), tr("Views A and B in turn"), "F8"),
                self._mode("difference", tr("&Difference"), tr("What view B has that view A has not"), "F9"),
                Command(
                    "compare.distances", tr("Distance of the s&urfaces"),
                    tr("Colour two surfaces of triangles by the distance of their points to each other"),
                    self.color_distances, keys=("Shift+F9",),
                    checked=lambda state: state.scene.comparison.distances != "off",
                ),
                None,
                Command(
                    "compare.next_view", tr("&Next view"),
                    tr("Let the Technique panel and the keys act on the next view"), self.activate_next, keys=("N",),
                    enabled=_several,
                ),
                Command(
                    "compare.swap", tr("E&xchange A and B"), tr("Let the compared views, A and B, change places"),
                    self.swap, enabled=_several,
                ),
                Command(
                    "compare.close_view", tr("&Close the view"), tr("Close the active view; the others stay"),
                    self.close_active, keys=("Ctrl+W",), enabled=_several,
                ),
                None,
                Command(
                    "compare.report", tr("Write &report…"),
                    tr("All views with pictures, differences, figures and settings in one file"),
                    self.report_requested.emit, enabled=_several,
                ),
            ],
        )  # fmt: skip

    def _mode(self, mode: Mode, words: str, tip: str, key: str) -> Command:
        return Command(
            f"compare.mode.{mode}", words, tip, partial(self.set_mode, mode), keys=(key,), group="mode",
            checked=lambda state: state.scene.comparison.mode == mode,
        )  # fmt: skip

    # ------------------------------------------------------------------ how many

    def set_view_count(self, count: int) -> None:
        """Show one, two or four views: a second one begins as the active one is, further ones by other techniques."""
        if count != len(self._store.scene.views):
            self._change_views(
                partial(with_various_views, count=count),
                self.tr("One view") if count == 1 else self.tr("%1 views").replace("%1", str(count)),
            )

    def _change_views(self, change: Callable[[Scene], Scene], label: str) -> None:
        """Have other views; what was seen whole is not cut off by narrower ones."""
        views = self._context.views
        before = views.first.viewport.aspect
        self._store.update(change, label=label)
        volume, layer = self._context.documents.volume, self._store.scene.layer
        camera = self._store.scene.view.camera
        if volume is None or layer is None or camera is None:
            return
        points = visible_points(volume, layer.transfer_function)
        farther = fitted(camera, points, before, views.first.viewport.aspect)
        if farther != camera:
            views.first.controller.show_camera(farther)

    def split(self, on: bool) -> None:
        """Two views and the panel that compares them, or the first view alone again."""
        if on:
            self._context.docks.show("compare")
        self.set_view_count(2 if on else 1)

    def compare_with_vtk(self) -> None:
        """Put VTK's counterpart with the same settings beside the active view."""
        info = current_technique(self._store.scene)
        other = next((c for c in counterparts() if info.id in c.counterpart_of), None)
        if other is None:
            self._context.messages.show_status(
                self.tr("VTK has nothing like %1").replace("%1", translated(info.label))
            )
            return
        self._context.docks.show("compare")
        self._change_views(
            lambda scene: match_second(with_counterpart(scene, other.id), 0, 1, keeps_first=True),
            self.tr("Compare with VTK"),
        )

    def activate_next(self) -> None:
        """Let panels and keys act on the next view of those that are seen."""
        self._look(with_next_active)

    def close_active(self) -> None:
        """Close the active view; the others stay."""
        self._store.update(
            lambda scene: scene.without_view(scene.active_index), label=self.tr("Close a view")
        )

    # ------------------------------------------------------------------ how they are looked at

    def swap(self) -> None:
        """Let A and B change places."""
        self._store.update(with_pair_swapped, label=self.tr("Exchange A and B"))

    def set_mode(self, mode: Mode) -> None:
        """Look at the views side by side, or at A and B as a wipe, blinking, or at their difference."""
        if len(self._store.scene.views) == 1 and mode != "side_by_side":
            self.set_view_count(2)
        self._look(partial(with_mode, mode=mode))

    def color_distances(self, on: bool) -> None:
        """Colour two surfaces by their distance, or not any more; say where there are not two surfaces."""
        scene = self._store.scene
        self.change(distances="signed" if on else "off")
        if not on:
            return
        self._context.docks.show("compare")
        if scene.pair is None or not all(current_technique(scene, v).colors_surface for v in scene.pair):
            self._context.messages.show_status(
                self.tr(
                    "Distances are shown where two views draw surfaces of triangles, as Marching cubes does"
                ),
                8000,
            )

    def change(self, **changes: Any) -> None:
        """Give fields of the `Comparison` other values."""
        self._look(partial(with_comparison, **changes))

    def _look(self, change: Callable[[Scene], Scene]) -> None:
        """Look at the views in another way; like the camera no step of the history."""
        self._store.update(change, label=self.tr("Comparison"), record=False)


def _several(state: State) -> bool:
    """Whether there is more than one view."""
    return len(state.scene.views) > 1
