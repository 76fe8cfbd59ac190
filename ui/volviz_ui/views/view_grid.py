"""The middle of the window: as many views as the scene has, one camera, one drag at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from PySide6.QtCore import QPointF, QTimer, Signal
from PySide6.QtGui import QImage, QPainter, QPaintEvent, QPalette, QResizeEvent
from PySide6.QtWidgets import QWidget

from volviz.annotations.background import background_image
from volviz.errors import VolvizError
from volviz.model.camera import Camera
from volviz.model.measurements import Measurement
from volviz.model.scene import Scene
from volviz.model.store import Store
from volviz.model.view_edits import with_active, with_comparison
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.session.time_player import Preparation
from volviz_ui.views.difference_image import Bytes, over
from volviz_ui.views.view_layout import ViewLayout
from volviz_ui.views.view_widget import ViewWidget
from volviz_ui.views.viewport import Viewport

#: How much larger letters are in a presentation.
PRESENTED = 1.6


class ViewGrid(QWidget):
    """Shows all views of the scene; with one view it is that viewport and nothing else.

    Parameters
    ----------
    store : Store
        The scene.
    documents : Documents
        Where its volume is.
    """

    failed = Signal(object)
    recovered = Signal()
    status_changed = Signal(int, object)
    """Number of the view, and what the host says about its image."""
    pointer_moved = Signal(int, QPointF)
    pointer_left = Signal()
    clicked = Signal(int, QPointF)
    """Number of the view, and where in it the left button was pressed and let go without a move."""
    point_clicked = Signal(int, QPointF)
    """Number of the view, and where in it a point is to lie (`places_points`)."""
    point_finished = Signal()
    """A double-click has ended what is being placed."""
    point_key_pressed = Signal(int)
    point_dragged = Signal(int, QPointF)
    drawn = Signal()
    """One of the views has drawn a frame."""
    double_clicked = Signal(int, QPointF)
    function_drag_started = Signal()
    function_dragged = Signal(float, float)
    function_drag_ended = Signal(bool)
    laid_out = Signal()
    pair_completed = Signal()
    """Both images of the compared pair are complete, and other ones than the last time."""

    def __init__(self, store: Store, documents: Documents, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMinimumSize(240, 150)
        self._store = store
        self._documents = documents
        self._shown: dict[str, bool] = {}
        self._is_presented = False
        self._quality = "balanced"
        self._shows_manipulators = True
        self._ray_mark: tuple[float, float] | None = None
        self._closed = False
        self.view_widgets: list[ViewWidget] = []
        self._completed: list[Any] = [None, None]
        self._places_points = False
        self.grab_point: Callable[[int, QPointF], bool] = lambda _view, _position: False
        """Takes up a point of a measurement in a view; whether there is one."""
        self.arrangement = ViewLayout(self)
        self.arrangement.divider_moved.connect(self._on_divider_moved)
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.setInterval(0)
        self._rest.timeout.connect(self._on_rest)
        self._add_view_widget()
        documents.changed.connect(self._on_changed)
        store.interaction_changed.connect(self._on_interaction_changed)
        self._sync(documents.shown)

    # ------------------------------------------------------------------ what there is

    @property
    def first(self) -> ViewWidget:
        """The view widget that is always there."""
        return self.view_widgets[0]

    @property
    def active(self) -> ViewWidget:
        """The view widget that panels and keys act on."""
        return self.view_widgets[min(self._documents.shown.scene.active_index, len(self.view_widgets) - 1)]

    @property
    def shown_view_widgets(self) -> list[ViewWidget]:
        """The view widgets that are to be seen, or whose difference is."""
        return self.arrangement.shown

    @property
    def is_complete(self) -> bool:
        """Whether every image that is shown is the complete one of the present scene."""
        return all(view_widget.controller.is_complete for view_widget in self.shown_view_widgets)

    @property
    def show_present(self) -> bool:
        """Whether every view that can be seen shows the present scene, in whatever quality."""
        return all(
            view_widget.controller.shows_present
            for view_widget in self.shown_view_widgets
            if not view_widget.viewport.is_covered
        )

    def preparations(self) -> list[Preparation]:
        """What computes, on any thread, what the views need of other volumes before they can draw them."""
        handles = [view_widget.controller.handle for view_widget in self.view_widgets]
        return [handle.preparation() for handle in handles if handle is not None]

    def _add_view_widget(self) -> ViewWidget:
        view_widget = ViewWidget(self, self._store, self._documents, len(self.view_widgets))
        viewport, controller = view_widget.viewport, view_widget.controller
        self.view_widgets.append(view_widget)
        controller.quality = self._quality
        view_widget.annotations.scale = PRESENTED if self._is_presented else 1.0
        controller.shows_manipulators = self._shows_manipulators
        for name, on in self._shown.items():
            view_widget.annotations.show(name, on)
        view_widget.ray_mark.show(self._ray_mark)
        viewport.camera_moved.connect(self._on_camera_moved)
        viewport.pressed.connect(lambda: self._on_pressed(view_widget))
        viewport.pointer_moved.connect(lambda position: self.pointer_moved.emit(view_widget.view, position))
        viewport.pointer_left.connect(self.pointer_left)
        viewport.clicked.connect(lambda position: self._on_clicked(view_widget, position))
        viewport.frame_drawn.connect(self.drawn)
        viewport.double_clicked.connect(lambda position: self._on_double_clicked(view_widget, position))
        viewport.point_key_pressed.connect(self.point_key_pressed)
        viewport.point_dragged.connect(lambda position: self.point_dragged.emit(view_widget.view, position))
        viewport.grab_point = lambda position: self.grab_point(view_widget.view, position)
        viewport.places_points = self._places_points
        viewport.function_drag_started.connect(self.function_drag_started)
        viewport.function_dragged.connect(self.function_dragged)
        viewport.function_drag_ended.connect(self.function_drag_ended)
        controller.failed.connect(self.failed)
        controller.recovered.connect(self.recovered)
        controller.status_changed.connect(lambda status: self.status_changed.emit(view_widget.view, status))
        view_widget.header.activated.connect(lambda: self.activate(view_widget.view))
        view_widget.header.closed.connect(lambda: self.close_view(view_widget.view))
        viewport.unseen_drawn.connect(lambda image: self._on_unseen_drawn(view_widget, image))
        viewport.frame_drawn.connect(self._rest.start)
        return view_widget

    def _sync(self, shown: LoadedScene) -> list[ViewWidget]:
        """As many view widgets as the scene has views; the new ones."""
        count = len(shown.scene.views)
        while len(self.view_widgets) > count:
            view_widget = self.view_widgets.pop()
            # a drag that ends with its view must not leave the scene without its camera
            if view_widget.viewport.is_moving:
                QTimer.singleShot(0, self, partial(self._commit_camera, view_widget.viewport.view_camera))
            view_widget.remove()
        new = [self._add_view_widget() for _ in range(count - len(self.view_widgets))]
        self._link_cameras(shown.scene)
        self.place()
        for view_widget in new:
            view_widget.show_change(LoadedScene(), shown)
        self._show_active(shown.scene)
        return new

    def _link_cameras(self, scene: Scene) -> None:
        """Let the views look through one camera, but for those that have their own."""
        for view_widget, view in zip(self.view_widgets[1:], scene.views[1:], strict=False):
            viewport, leader = view_widget.viewport, self.first.viewport
            if view.own_camera or scene.views[0].own_camera:
                viewport.unlink_camera()
            elif viewport not in leader.linked:
                viewport.link_camera(leader)

    def _commit_camera(self, camera: Camera) -> None:
        if not self._closed and self._documents.is_current:
            self._store.update(lambda scene: scene.with_camera(camera), label="Camera", record=False)

    # ------------------------------------------------------------------ where it lies

    def place(self) -> None:
        """Lay the views out."""
        scene = self._documents.shown.scene
        self.arrangement.arrange(self.view_widgets, scene.active_index, scene.comparison, scene.layout)
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

    def _on_pressed(self, view_widget: ViewWidget) -> None:
        # while images blink nobody can choose which one to hit
        if self._store.scene.comparison.mode not in ("blink", "difference"):
            self.activate(view_widget.view)

    def _on_clicked(self, view_widget: ViewWidget, position: QPointF) -> None:
        if self._places_points:
            self.point_clicked.emit(view_widget.view, position)
            return
        view_widget.controller.set_cursor_at(position)
        self.clicked.emit(view_widget.view, position)

    def _on_double_clicked(self, view_widget: ViewWidget, position: QPointF) -> None:
        if self._places_points:
            self.point_finished.emit()
        else:
            self.double_clicked.emit(view_widget.view, position)

    # ------------------------------------------------------------------ points

    @property
    def places_points(self) -> bool:
        """Whether clicks place points, instead of moving the cross-hair or showing a ray."""
        return self._places_points

    @places_points.setter
    def places_points(self, on: bool) -> None:
        self._places_points = on
        for view_widget in self.view_widgets:
            view_widget.viewport.places_points = on

    def show_pending(self, pending: Measurement | None) -> None:
        """Draw what is being measured in all views, None for nothing."""
        for view_widget in self.view_widgets:
            view_widget.annotations.show_pending(pending)

    def _on_divider_moved(self, share: float) -> None:
        self._store.update(partial(with_comparison, divider=share), record=False)

    def _show_active(self, scene: Scene) -> None:
        for view_widget in self.view_widgets:
            view_widget.set_active(view_widget.view == scene.active_index)

    # ------------------------------------------------------------------ difference

    def _on_unseen_drawn(self, view_widget: ViewWidget, image: QImage) -> None:
        pair = self.arrangement.pair
        if pair is not None and self.arrangement.difference.isVisible() and view_widget in pair:
            self.arrangement.difference.set_drawn(pair.index(view_widget), image)

    def _on_rest(self) -> None:
        """A frame was drawn: perhaps it was the last one before all images are complete."""
        pair = self.arrangement.pair
        if self._closed or pair is None or not self.is_complete:
            return
        difference = self.arrangement.difference
        if difference.isVisible() and not difference.is_exact:
            images = self.pair_images()
            if images is not None:
                difference.set_complete(*images)
        # the status holds the drawing time, so it differs for every new image; the number of averaged samples is left
        # out, because averaging at rest only smooths an image that is complete already
        drawn = [replace(view_widget.controller.status, samples=1) for view_widget in pair]
        if drawn != self._completed:
            self._completed = drawn
            self.pair_completed.emit()

    def pair_images(self) -> tuple[Bytes, Bytes] | None:
        """The complete images of the compared pair, shape (H, W, 3), as they would be exported.

        None while one of them is not complete.
        """
        pair = self.arrangement.pair
        if pair is None or not self.is_complete:
            return None
        seen = []
        for view_widget in pair:
            try:
                image = view_widget.controller.handle.read_image()
            except VolvizError:
                return None  # drawn at a lower resolution: drawing failed
            height, width = image.shape[:2]
            seen.append(
                over(image, background_image(self._documents.shown.scene.background, (width, height)))
            )
        return seen[0], seen[1]

    def show_metrics(self, metrics: Any) -> None:
        """Show where the compared images are alike, as was measured of them (`PairMetrics`)."""
        self.arrangement.difference.set_similarity(metrics.similarity)

    # ------------------------------------------------------------------ gestures

    def _on_interaction_changed(self, running: bool) -> None:
        # all images follow together, whatever is being dragged
        for view_widget in self.view_widgets:
            view_widget.controller.show_interaction(running)

    def _on_camera_moved(self) -> None:
        # the hidden one of a blinking pair is drawn when it is shown, or when the drag is over
        moved = self.sender()
        if not isinstance(moved, Viewport):
            return
        follows_unseen = self.arrangement.difference.isVisible()
        for view_widget in self.view_widgets:
            unseen = view_widget.viewport.is_covered and not follows_unseen
            follows = view_widget.viewport in moved.linked and view_widget.viewport is not moved
            if follows and not unseen:
                view_widget.viewport.render()

    # ------------------------------------------------------------------ from the scene to the images

    def _on_changed(self, before: LoadedScene, after: LoadedScene) -> None:
        old, new = before.scene, after.scene
        made: list[ViewWidget] = []
        if len(new.views) != len(self.view_widgets):
            made = self._sync(after)
        elif [view.own_camera for view in old.views] != [view.own_camera for view in new.views]:
            self._link_cameras(new)
        for view_widget in self.view_widgets:
            if view_widget not in made:
                view_widget.show_change(before, after)
        if old.active_index != new.active_index:
            self._show_active(new)
        if (old.active_index, old.comparison, old.layout) != (new.active_index, new.comparison, new.layout):
            self.place()
        if old.pair != new.pair:
            # nothing is drawn anew where both images are there already
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
        for view_widget in self.view_widgets:
            view_widget.controller.quality = quality

    @property
    def shows_manipulators(self) -> bool:
        """Whether light and cut plane can be dragged in the images, where the techniques have them."""
        return self._shows_manipulators

    @shows_manipulators.setter
    def shows_manipulators(self, on: bool) -> None:
        self._shows_manipulators = on
        for view_widget in self.view_widgets:
            view_widget.controller.shows_manipulators = on

    @property
    def is_presented(self) -> bool:
        """Whether letters around the volume can be read from afar."""
        return self._is_presented

    @is_presented.setter
    def is_presented(self, on: bool) -> None:
        self._is_presented = on
        for view_widget in self.view_widgets:
            view_widget.annotations.scale = PRESENTED if on else 1.0

    @property
    def shown_names(self) -> frozenset[str]:
        """What is switched on: names as for `show_annotations`, and "handles"."""
        names = {name for name, on in self._shown.items() if on}
        return frozenset(names | {"handles"} if self._shows_manipulators else names)

    def show_annotations(self, name: str, on: bool) -> None:
        """Switch box, axes, orientation marker, colour bar or cross-hair in all views."""
        self._shown[name] = on
        for view_widget in self.view_widgets:
            view_widget.annotations.show(name, on)

    def show_ray_mark(self, place: tuple[float, float] | None) -> None:
        """Mark the pixel of the ray inspector in all views; fractions from the lower left, None for none."""
        self._ray_mark = place
        for view_widget in self.view_widgets:
            view_widget.ray_mark.show(place)

    # ------------------------------------------------------------------ end

    def close_views(self) -> None:
        """Release everything on the GPU while the contexts live; the view widgets stay to be asked."""
        if self._closed:
            return
        self._closed = True
        self._documents.changed.disconnect(self._on_changed, missing_ok=True)
        self._store.interaction_changed.disconnect(self._on_interaction_changed, missing_ok=True)
        self._rest.stop()
        self.arrangement.close()
        for view_widget in reversed(self.view_widgets):
            view_widget.close()
