"""Two surfaces in the colours of their distance: measured on a worker, shown on both, taken away when out of date."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from volviz.compare.distance_colors import DistanceColors, distance_colors
from volviz.compare.distance_map import DistanceMap, distance_maps
from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.errors import InputError
from volviz.model.comparison import Comparison
from volviz.volume_data.volume import Volume
from volviz_ui.compare.metrics import MeshCache, mesh_key
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.workers import Task, Workers
from volviz_ui.views.view_grid import ViewGrid
from volviz_ui.views.view_widget import ViewWidget

DELAY_MS = 150
"""The surfaces must have rested for so long before anything is measured."""

KEPT = 2
"""Pairs of surfaces whose distances are kept, so that a step back costs nothing."""

KEY = "distances"
EXTRACTION_SHARE = 0.2

Maps = tuple[DistanceMap, DistanceMap]
ByKind = dict[str, Maps]
"""Distances as the scene calls them: "signed" and "absolute"."""


@dataclass(frozen=True)
class _Pair:
    """Two surfaces; equal pairs have equal distances."""

    volume: Volume
    sides: tuple[tuple[str, Any], tuple[str, Any]]

    @property
    def key(self) -> tuple[Any, ...]:
        return tuple(mesh_key(self.volume, *side) for side in self.sides)


class SurfaceDistances(QObject):
    """Colours the compared pair of surfaces as the scene's comparison says."""

    shown = Signal()
    """Other colours are shown, or none."""
    available_changed = Signal(bool)
    """Whether the compared views draw two surfaces."""
    progressed = Signal(float)
    """How far the distance is, 0..1."""
    state_changed = Signal(str)
    """Nothing is being measured; why there is nothing to show, or empty."""
    found = Signal(object, str, bool)
    """`DistanceColors` that are shown now, the unit of their lengths, and whether a sign was asked for."""

    def __init__(
        self,
        documents: Documents,
        views: ViewGrid,
        workers: Workers,
        meshes: MeshCache,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._documents = documents
        self._views = views
        self._workers = workers
        self._meshes = meshes
        self._pair: _Pair | None = None
        self._kept: dict[Any, ByKind] = {}
        self._made: tuple[Any, DistanceColors] | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(DELAY_MS)
        self._timer.timeout.connect(self._measure)
        documents.changed.connect(self._on_shown_changed)

    @property
    def colors(self) -> DistanceColors | None:
        """What is shown now, None while there is nothing to show."""
        return None if self._made is None else self._made[1]

    # ------------------------------------------------------------------ what is wanted

    def _on_shown_changed(self, before: LoadedScene, after: LoadedScene) -> None:
        old, new = before.scene, after.scene
        if before.volume is not after.volume:
            self._kept.clear()
            self.sync()
        elif (old.views, old.active_index, old.comparison, old.layers) != (
            new.views, new.active_index, new.comparison, new.layers
        ):  # fmt: skip
            self.sync()

    def _both(self) -> _Pair | None:
        """The two surfaces that are compared, None where there are not two."""
        view_widgets, shown = self._views.arrangement.pair, self._documents.shown
        volume, scene = shown.volume, shown.scene
        if view_widgets is None or volume is None:
            return None
        infos = [current_technique(scene, view_widget.view) for view_widget in view_widgets]
        if not all(info.colors_surface for info in infos):
            return None
        first, second = (
            (info.id, current_settings(scene, view_widget.view))
            for info, view_widget in zip(infos, view_widgets, strict=True)
        )
        return _Pair(volume, (first, second))

    def sync(self) -> None:
        """Show what there is for the present pair, and measure what there is not."""
        comparison = self._documents.shown.scene.comparison
        both = self._both()
        self.available_changed.emit(both is not None)
        wanted = both if comparison.distances != "off" else None
        if (None if wanted is None else wanted.key) != (None if self._pair is None else self._pair.key):
            self._workers.cancel(KEY)
            self._timer.stop()
            self.state_changed.emit("")
            self._pair = wanted
            if wanted is not None and wanted.key not in self._kept:
                self.progressed.emit(0.0)
                self._timer.start()
        self._show(comparison)

    # ------------------------------------------------------------------ measuring

    def _measure(self) -> None:
        pair, meshes = self._pair, self._meshes
        if pair is None:
            return

        def work(task: Task) -> ByKind:
            both = []
            for number, (technique, settings) in enumerate(pair.sides):
                task.report(EXTRACTION_SHARE * number / 2)
                mesh = meshes.drawn(pair.volume, technique, settings, lambda: task.is_cancelled)
                if mesh is None:
                    raise InputError(f"{technique} draws no mesh.")
                both.append(mesh)
            rest = 1.0 - EXTRACTION_SHARE
            maps = distance_maps(
                both[0],
                both[1],
                progress=lambda part: task.report(EXTRACTION_SHARE + rest * part),
                cancel=lambda: task.is_cancelled,
            )
            found = {"signed": maps, "absolute": (maps[0].without_sign(), maps[1].without_sign())}
            for each in (*found["signed"], *found["absolute"]):
                # here, where nobody waits
                each.prepare()
            return found

        task = self._workers.start(work, label=self.tr("Distance of the surfaces"), key=KEY)
        task.progressed.connect(lambda fraction, _words: self.progressed.emit(fraction))
        task.succeeded.connect(lambda found: self._on_measured(pair, found))
        task.failed.connect(self._on_failed)

    def _on_measured(self, pair: _Pair, found: ByKind) -> None:
        if self._pair is None or pair.key != self._pair.key:
            return
        self._kept[pair.key] = found
        for old in list(self._kept)[:-KEPT]:
            del self._kept[old]
        self._show(self._documents.shown.scene.comparison)

    def _on_failed(self, error: BaseException) -> None:
        self.state_changed.emit(str(error))

    # ------------------------------------------------------------------ showing

    def _show(self, comparison: Comparison) -> None:
        """Give the two views their colours, and all others none."""
        before = self.colors
        self._make(comparison)
        colors, view_widgets = self.colors, self._views.arrangement.pair
        given: dict[ViewWidget, Any] = {}
        if colors is not None and view_widgets is not None:
            given = dict(zip(view_widgets, (colors.first, colors.second), strict=True))
        for view_widget in self._views.view_widgets:
            self._color(view_widget, given.get(view_widget), colors)
        if colors is not None and colors is not before:
            self.found.emit(colors, self._unit(), comparison.distances == "signed")
        if colors is not before:
            self.shown.emit()

    def _make(self, comparison: Comparison) -> None:
        """Colours of what is known of the pair."""
        pair = self._pair
        found = None if pair is None else self._kept.get(pair.key)
        if pair is None or found is None:
            self._made = None
            return
        key = (found[comparison.distances], comparison.distance_limit)
        if self._made is None or self._made[0] != key:
            self._made = (key, distance_colors(key[0], pair.volume.spacing, comparison.distance_limit))

    def _color(self, view_widget: ViewWidget, wanted: Any, colors: DistanceColors | None) -> None:
        handle = view_widget.controller.handle
        if wanted is None or colors is None:
            view_widget.annotations.show_values(None)
        elif colors.are_same:
            view_widget.annotations.show_values(None, note=self.tr("No distance: the surfaces are the same"))
        else:
            view_widget.annotations.show_values(wanted, self._unit())
        if handle is None or handle.surface_colors is wanted:
            return
        if wanted is None or handle.technique.colors_surface:
            handle.color_surface(wanted)
            view_widget.viewport.render()

    def _unit(self) -> str:
        volume = self._documents.volume
        unit = "" if volume is None else str(volume.metadata.get("length_unit", "mm"))
        return unit or self.tr("units")

    def close(self) -> None:
        """Stop measuring: the window closes."""
        self._documents.changed.disconnect(self._on_shown_changed, missing_ok=True)
        self._timer.stop()
        self._workers.cancel(KEY)
