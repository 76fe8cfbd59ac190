"""Between the views and the Compare panel: measures the compared pair whenever it is complete."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from volviz.compare.settings_match import match_second, setting_differences
from volviz.custom_gl.scene_techniques import current_technique
from volviz.errors import Cancelled
from volviz.model.render_spec import View
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz_ui.compare.frame_timing import FrameTiming
from volviz_ui.compare.metrics import MeasuredView, MeshCache, PairMetrics, pair_metrics
from volviz_ui.library_words import translated
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.workers import Task, Workers
from volviz_ui.views.view_grid import ViewGrid

DELAY_MS = 150
"""The pair must have rested for so long before anything is measured."""


class Measurements(QObject):
    """Measures on a worker while somebody looks at the metrics, and takes times when asked."""

    figures_found = Signal(object)
    """`PairMetrics` of the complete images."""
    times_found = Signal(object)
    """Two `FrameTimes`, A and B, or None when those that were shown no longer hold."""
    timing_progressed = Signal(object)
    """How far the frame times are, 0..1; None when none are being taken."""
    gpu_clock_found = Signal(str)
    """Name of a renderer whose GPU clock says nothing, empty where there is a clock."""
    state_changed = Signal(str)
    """What is being done, or what the metrics are of."""
    emptied = Signal(str)
    """There are no metrics any more, and why."""
    convergence_outdated = Signal()
    several_changed = Signal(bool)
    """Whether there is a pair to compare."""
    names_changed = Signal(str, str)
    """Techniques of A and B."""
    differences_found = Signal(list)
    """What the settings of A and B do differently, a sentence each."""

    def __init__(
        self,
        store: Store,
        documents: Documents,
        views: ViewGrid,
        workers: Workers,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._store = store
        self._documents = documents
        self._views = views
        self._workers = workers
        self._watched = False
        self.meshes = MeshCache()
        self._task: Task | None = None
        self.metrics: PairMetrics | None = None
        self.timing = FrameTiming(self)
        self.timing.progressed.connect(self.timing_progressed.emit)
        self.timing.finished.connect(self._on_timed)
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(DELAY_MS)
        self._timer.timeout.connect(self._measure)
        views.pair_completed.connect(self._on_pair_completed)
        documents.changed.connect(self._on_shown_changed)

    @property
    def _wanted(self) -> bool:
        """Whether anybody looks at metrics, or at the map of similarity."""
        scene = self._documents.shown.scene
        similarity = scene.comparison.mode == "difference" and scene.comparison.map == "ssim"
        return len(scene.views) > 1 and (self._watched or similarity)

    # ------------------------------------------------------------------ images and meshes

    def _on_pair_completed(self) -> None:
        self.metrics = None
        limits = self._views.first.controller.handle.gpu.limits
        self.gpu_clock_found.emit(limits.renderer.split("(")[0].strip() if limits.software else "")
        if self._wanted:
            self._timer.start()

    def watch(self, on: bool) -> None:
        """Whether anybody looks at the metrics; if nobody does, nothing is measured."""
        self._watched = on
        if self._wanted and self.metrics is None:
            self._timer.start()

    def _measure(self) -> None:
        pair = self._views.arrangement.pair
        shown = self._documents.shown
        volume, scene = shown.volume, shown.scene
        images = self._views.pair_images()
        if pair is None or volume is None or images is None or scene.view.camera is None:
            return
        if images[0].shape != images[1].shape:
            return
        sides = [
            MeasuredView(shown.whole_spec(view_widget.view), image)
            for view_widget, image in zip(pair, images, strict=True)
        ]
        height, width = images[0].shape[:2]
        view, meshes = View(scene.view.camera, (width, height)), self.meshes

        def work(task: Task) -> PairMetrics:
            def check() -> None:
                if task.is_cancelled:
                    raise Cancelled("The measurement was cancelled.")

            return pair_metrics((sides[0], sides[1]), view, meshes, check)

        self.state_changed.emit(self.tr("Measuring…"))
        task = self._workers.start(work, label=self.tr("Measure"), key="compare")
        task.succeeded.connect(self._on_measured)
        task.failed.connect(self._on_failed)

    def _on_measured(self, metrics: PairMetrics) -> None:
        self.metrics = metrics
        self.figures_found.emit(metrics)
        handles = [view_widget.controller.handle for view_widget in self._views.arrangement.pair or ()]
        if any(handle is not None and handle.surface_colors is not None for handle in handles):
            self.state_changed.emit(self.tr("Of the pictures in the colours of the distance."))

    def _on_failed(self, error: BaseException) -> None:
        self.emptied.emit(str(error))

    # ------------------------------------------------------------------ frame times

    def time(self) -> None:
        """Take frame times of the compared pair, or stop taking them."""
        if self.timing.is_running:
            self.timing.cancel()
            return
        pair = self._views.arrangement.pair
        if pair is not None and self._views.is_complete:
            self.timing_progressed.emit(0.0)
            self.timing.start(pair[0].controller, pair[1].controller)

    def _on_timed(self, times: Any) -> None:
        self.timing_progressed.emit(None)
        if times is not None:
            self.times_found.emit(times)

    # ------------------------------------------------------------------ settings

    def match(self) -> None:
        """Give B the settings of A."""
        pair = self._views.arrangement.pair
        if pair is not None:
            first, second = pair[0].view, pair[1].view
            self._store.update(
                lambda scene: match_second(scene, first, second), label=self.tr("Match settings")
            )

    # ------------------------------------------------------------------ what changes

    def _on_shown_changed(self, before: LoadedScene, after: LoadedScene) -> None:
        old, new = before.scene, after.scene
        if before.volume is not after.volume:
            self.meshes.clear()
            self._forget()
        elif _drawn(old) != _drawn(new):
            self._forget()
        if _converging(old) != _converging(new):
            self.convergence_outdated.emit()
        if old.pair != new.pair:
            # metrics of others must not stand below the new names
            self.emptied.emit("")
        if (old.views, old.pair) != (new.views, new.pair):
            self.tell_pair()
        if old.comparison != new.comparison and self._wanted and self.metrics is None:
            self._timer.start()

    def _forget(self) -> None:
        """What was measured no longer holds."""
        self.timing.cancel()
        self._workers.cancel("compare")
        self._timer.stop()
        self.metrics = None
        self.times_found.emit(None)

    def tell_pair(self) -> None:
        """Emit what is known of the present pair without measuring."""
        scene = self._documents.shown.scene
        pair = self._views.arrangement.pair
        several = len(scene.views) > 1 and pair is not None
        self.several_changed.emit(several)
        if pair is None or not several:
            self.emptied.emit(self.tr("Split the view to compare: Compare, Two views (Ctrl+2)."))
            self.differences_found.emit([])
            return
        if self.metrics is None:
            self.state_changed.emit("")
        first, second = (current_technique(scene, view_widget.view) for view_widget in pair)
        self.names_changed.emit(translated(first.label), translated(second.label))
        self.differences_found.emit(setting_differences(scene, pair[0].view, pair[1].view))

    def close(self) -> None:
        """Stop measuring: the window closes."""
        self._documents.changed.disconnect(self._on_shown_changed, missing_ok=True)
        self._timer.stop()
        self.timing.cancel()
        self._workers.cancel("compare")


def _drawn(scene: Scene) -> Any:
    """What decides the images."""
    views = [(v.technique, v.settings, v.camera) for v in scene.views]
    return views, scene.pair, scene.layers, scene.light, scene.clipping, scene.background


def _converging(scene: Scene) -> Any:
    """What an order of convergence was measured of; another camera leaves it standing."""
    return [(v.technique, v.settings) for v in scene.views], scene.layers
