"""The middle of the window: as many views as the scene has, one camera, one drag at a time."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from PySide6.QtCore import QPointF, QTimer, Signal
from PySide6.QtGui import QImage, QPainter, QPaintEvent, QPalette, QResizeEvent
from PySide6.QtWidgets import QWidget

from volviz.errors import VolvizError
from volviz.model.camera import Camera
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.view_edits import with_active, with_comparison
from volviz_ui.documents import Documents
from volviz_ui.loaded_scene import LoadedScene
from volviz_ui.views.arrangement import Arrangement
from volviz_ui.views.difference_picture import Bytes, over
from volviz_ui.views.display import AddVolume
from volviz_ui.views.pane import Pane
from volviz_ui.views.scenery import background_picture


class ViewArea(QWidget):
    """Shows all views of the scene; with one view it is that viewport and nothing else.

    Parameters
    ----------
    store : Store
        The scene.
    documents : Documents
        Where its volume is.
    add_volume : callable
        `volviz.add_volume`.
    """

    failed = Signal(object)
    recovered = Signal()
    status_changed = Signal(int, object)
    """Number of the view, and what the host says about its picture."""
    pointer_moved = Signal(int, QPointF)
    pointer_left = Signal()
    clicked = Signal(int, QPointF)
    """Number of the view, and where in it the left button was pressed and let go without a move."""
    drawn = Signal()
    """One of the views has drawn a frame."""
    double_clicked = Signal(int, QPointF)
    function_drag_started = Signal()
    function_dragged = Signal(float, float)
    function_drag_ended = Signal(bool)
    laid_out = Signal()
    pair_completed = Signal()
    """Both pictures of the compared pair are complete, and other ones than the last time."""

    def __init__(
        self, store: Store, documents: Documents, add_volume: AddVolume, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setMinimumSize(240, 150)
        self._store = store
        self._documents = documents
        self._add_volume = add_volume
        self._shown: dict[str, bool] = {}
        self._quality = "balanced"
        self._shows_handles = True
        self._ray_mark: tuple[float, float] | None = None
        self._closed = False
        self.panes: list[Pane] = []
        self._completed: list[Any] = [None, None]
        self.arrangement = Arrangement(self)
        self.arrangement.divider_moved.connect(self._on_divider_moved)
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.setInterval(0)
        self._rest.timeout.connect(self._on_rest)
        self._add_pane()
        documents.changed.connect(self._on_changed)
        store.interaction_changed.connect(self._on_interaction_changed)
        self._sync(documents.shown)

    # ------------------------------------------------------------------ what there is

    @property
    def first(self) -> Pane:
        """The pane that is always there."""
        return self.panes[0]

    @property
    def active(self) -> Pane:
        """The pane that panels and keys act on."""
        return self.panes[min(self._documents.shown.scene.active_index, len(self.panes) - 1)]

    @property
    def shown_panes(self) -> list[Pane]:
        """The panes that are to be seen, or whose difference is."""
        return self.arrangement.shown

    @property
    def is_complete(self) -> bool:
        """Whether every picture that is shown is the complete one of the present scene."""
        return all(pane.display.is_complete for pane in self.shown_panes)

    def _add_pane(self) -> Pane:
        pane = Pane(self, self._store, self._documents, self._add_volume, len(self.panes))
        viewport, display = pane.viewport, pane.display
        if self.panes:
            viewport.link_camera(self.first.viewport)
        self.panes.append(pane)
        display.quality = self._quality
        display.shows_handles = self._shows_handles
        for name, on in self._shown.items():
            pane.scenery.show(name, on)
        pane.ray_mark.show(self._ray_mark)
        viewport.camera_moved.connect(self._on_camera_moved)
        viewport.pressed.connect(lambda: self._on_pressed(pane))
        viewport.pointer_moved.connect(lambda position: self.pointer_moved.emit(pane.view, position))
        viewport.pointer_left.connect(self.pointer_left)
        viewport.clicked.connect(lambda position: self.clicked.emit(pane.view, position))
        viewport.frame_drawn.connect(self.drawn)
        viewport.double_clicked.connect(lambda position: self.double_clicked.emit(pane.view, position))
        viewport.function_drag_started.connect(self.function_drag_started)
        viewport.function_dragged.connect(self.function_dragged)
        viewport.function_drag_ended.connect(self.function_drag_ended)
        display.failed.connect(self.failed)
        display.recovered.connect(self.recovered)
        display.status_changed.connect(lambda status: self.status_changed.emit(pane.view, status))
        pane.header.activated.connect(lambda: self.activate(pane.view))
        pane.header.closed.connect(lambda: self.close_view(pane.view))
        viewport.unseen_drawn.connect(lambda image: self._on_unseen_drawn(pane, image))
        viewport.frame_drawn.connect(self._rest.start)
        return pane

    def _sync(self, shown: LoadedScene) -> list[Pane]:
        """As many panes as the scene has views; the new ones."""
        count = len(shown.scene.views)
        while len(self.panes) > count:
            pane = self.panes.pop()
            # a drag that ends with its view must not leave the scene without its camera
            if pane.viewport.is_moving:
                QTimer.singleShot(0, self, partial(self._commit_camera, pane.viewport.view_camera))
            pane.remove()
        new = [self._add_pane() for _ in range(count - len(self.panes))]
        self.place()
        for pane in new:
            pane.show_change(LoadedScene(), shown)
        self._show_active(shown.scene)
        return new

    def _commit_camera(self, camera: Camera) -> None:
        if not self._closed and self._documents.is_current:
            self._store.update(lambda scene: scene.with_camera(camera), label="Camera", record=False)

    # ------------------------------------------------------------------ where it lies

    def place(self) -> None:
        """Lay the views out."""
        scene = self._documents.shown.scene
        self.arrangement.arrange(self.panes, scene.active_index, scene.comparison)
        self.laid_out.emit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Share the new size out."""
        super().resizeEvent(event)
        self.place()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """What lies between the views."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Window))
        painter.end()

    # ------------------------------------------------------------------ several views

    def activate(self, view: int) -> None:
        """Let panels and keys act on another view."""
        self._store.update(partial(with_active, view=view), record=False)

    def close_view(self, view: int) -> None:
        """Close a view; the others stay."""
        self._store.update(
            lambda scene: scene.without_view(view) if view < len(scene.views) else scene,
            label=self.tr("Close a view"),
        )

    def _on_pressed(self, pane: Pane) -> None:
        # while pictures blink nobody can choose which one to hit
        if self._store.scene.comparison.mode not in ("blink", "difference"):
            self.activate(pane.view)

    def _on_divider_moved(self, share: float) -> None:
        self._store.update(partial(with_comparison, divider=share), record=False)

    def _show_active(self, scene: Scene) -> None:
        for pane in self.panes:
            pane.set_active(pane.view == scene.active_index)

    # ------------------------------------------------------------------ difference

    def _on_unseen_drawn(self, pane: Pane, image: QImage) -> None:
        pair = self.arrangement.pair
        if pair is not None and self.arrangement.difference.isVisible() and pane in pair:
            self.arrangement.difference.set_drawn(pair.index(pane), image)

    def _on_rest(self) -> None:
        """A frame was drawn: perhaps it was the last one before all pictures are complete."""
        pair = self.arrangement.pair
        if self._closed or pair is None or not self.is_complete:
            return
        difference = self.arrangement.difference
        if difference.isVisible() and not difference.is_exact:
            pictures = self.pair_pictures()
            if pictures is not None:
                difference.set_complete(*pictures)
        # the status holds the drawing time, so it differs for every new image; the number of averaged samples is left
        # out, because averaging at rest only smooths an image that is complete already
        drawn = [replace(pane.display.status, samples=1) for pane in pair]
        if drawn != self._completed:
            self._completed = drawn
            self.pair_completed.emit()

    def pair_pictures(self) -> tuple[Bytes, Bytes] | None:
        """The complete pictures of the compared pair, shape (H, W, 3), as they would be exported.

        None while one of them is not complete.
        """
        pair = self.arrangement.pair
        if pair is None or not self.is_complete:
            return None
        seen = []
        for pane in pair:
            try:
                picture = pane.display.handle.read_picture()
            except VolvizError:
                return None  # drawn at a lower resolution: drawing failed
            height, width = picture.shape[:2]
            seen.append(
                over(picture, background_picture(self._documents.shown.scene.background, (width, height)))
            )
        return seen[0], seen[1]

    def show_figures(self, figures: Any) -> None:
        """Show where the compared pictures are alike, as was measured of them (`PairFigures`)."""
        self.arrangement.difference.set_similarity(figures.similarity)

    # ------------------------------------------------------------------ gestures

    def _on_interaction_changed(self, running: bool) -> None:
        # all pictures follow together, whatever is being dragged
        for pane in self.panes:
            pane.display.show_interaction(running)

    def _on_camera_moved(self) -> None:
        # the hidden one of a blinking pair is drawn when it is shown, or when the drag is over
        follows_unseen = self.arrangement.difference.isVisible()
        for pane in self.panes:
            unseen = pane.viewport.is_covered and not follows_unseen
            if pane.viewport is not self.sender() and not unseen:
                pane.viewport.render()

    # ------------------------------------------------------------------ from the scene to the pictures

    def _on_changed(self, before: LoadedScene, after: LoadedScene) -> None:
        old, new = before.scene, after.scene
        made: list[Pane] = []
        if len(new.views) != len(self.panes):
            made = self._sync(after)
        for pane in self.panes:
            if pane not in made:
                pane.show_change(before, after)
        if old.active_index != new.active_index:
            self._show_active(new)
        if (old.active_index, old.comparison) != (new.active_index, new.comparison):
            self.place()
        if old.pair != new.pair:
            # nothing is drawn anew where both pictures are there already
            self._completed = [None, None]
            self._rest.start()

    # ------------------------------------------------------------------ what stands around

    @property
    def quality(self) -> str:
        """How much is given up while something moves: "balanced", "fast" or "full"."""
        return self._quality

    @quality.setter
    def quality(self, quality: str) -> None:
        self._quality = quality
        for pane in self.panes:
            pane.display.quality = quality

    @property
    def shows_handles(self) -> bool:
        """Whether light and cut plane can be dragged in the pictures, where the techniques have them."""
        return self._shows_handles

    @shows_handles.setter
    def shows_handles(self, on: bool) -> None:
        self._shows_handles = on
        for pane in self.panes:
            pane.display.shows_handles = on

    @property
    def shown_names(self) -> frozenset[str]:
        """What is switched on: names as for `show_scenery`, and "handles"."""
        names = {name for name, on in self._shown.items() if on}
        return frozenset(names | {"handles"} if self._shows_handles else names)

    def show_scenery(self, name: str, on: bool) -> None:
        """Switch box, axes, orientation marker or colour bar in all views."""
        self._shown[name] = on
        for pane in self.panes:
            pane.scenery.show(name, on)

    def show_ray_mark(self, place: tuple[float, float] | None) -> None:
        """Mark the pixel of the ray inspector in all views; fractions from the lower left, None for none."""
        self._ray_mark = place
        for pane in self.panes:
            pane.ray_mark.show(place)

    # ------------------------------------------------------------------ end

    def close_views(self) -> None:
        """Release everything on the GPU while the contexts live; the panes stay to be asked."""
        if self._closed:
            return
        self._closed = True
        self._documents.changed.disconnect(self._on_changed, missing_ok=True)
        self._store.interaction_changed.disconnect(self._on_interaction_changed, missing_ok=True)
        self._rest.stop()
        self.arrangement.close()
        for pane in reversed(self.panes):
            pane.close()
