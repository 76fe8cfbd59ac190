"""The tool that is held: clicks in the views become points of a measurement."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QObject, QPointF, Qt, Signal

from volviz.annotations.projection import Projection
from volviz.errors import InputError
from volviz.measure.readings import known_readings
from volviz.model.measurement_edits import with_measurement, with_measurement_changed
from volviz.model.measurements import COUNTS, Kind, Measurement, Point
from volviz.model.store import Store
from volviz_ui.measuring.picked_points import point_at
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene
from volviz_ui.views.view_grid import ViewGrid

#: A point is taken up by a press no farther away, in pixels of the screen.
GRIP = 8.0


class MeasureTool(QObject):
    """Collects the points of what is being measured; what is complete goes into the scene.

    Parameters
    ----------
    store : Store
    documents : Documents
    views : ViewGrid
        Where one clicks.
    """

    changed = Signal()
    """Another tool, or none."""
    hinted = Signal(str)
    """What to do next, in a sentence."""
    finished = Signal(int)
    """Number of a new measurement."""

    def __init__(
        self, store: Store, documents: Documents, views: ViewGrid, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._store, self._documents, self._views = store, documents, views
        self.kind: Kind | None = None
        self.points: list[Point] = []
        self._held: tuple[int, int] | None = None
        """Number of the measurement whose point is dragged, and of the point."""
        views.point_clicked.connect(self._on_clicked)
        views.point_finished.connect(self.finish)
        views.point_key_pressed.connect(self._on_key)
        views.pointer_moved.connect(self._on_moved)
        views.point_dragged.connect(self._on_dragged)
        views.grab_point = self._grab
        documents.changed.connect(self._on_changed)

    # ------------------------------------------------------------------ the tool

    def hold(self, kind: Kind | None) -> None:
        """Take up a tool, or put it away; points that are not yet a measurement are forgotten."""
        self.kind, self.points = kind, []
        self._views.places_points = kind is not None
        self._show(None)
        self.changed.emit()
        self._hint()

    def finish(self) -> None:
        """Let the points so far be the measurement, where they are enough."""
        if self.kind is None:
            return
        points = tuple(self.points)
        if len(points) < COUNTS[self.kind][0]:
            self._hint()
            return
        self.points = []
        self._show(None)
        measurement = Measurement(self.kind, points)
        volume = self._documents.volume
        try:
            if volume is not None:
                known_readings(measurement, volume)
        except InputError as error:
            self.hinted.emit(str(error)[:1].upper() + str(error)[1:])
            return
        self._store.update(partial(with_measurement, measurement=measurement), label=self.tr("Measure"))
        self.finished.emit(len(self._store.scene.measurements) - 1)

    def _on_clicked(self, view: int, position: QPointF) -> None:
        if self.kind is None:
            return
        point = self._point(view, position)
        if point is None:
            self.hinted.emit(self.tr("There is nothing to be hit; click on something that is seen"))
            return
        self.points.append(point)
        most = COUNTS[self.kind][1]
        if most is not None and len(self.points) >= most:
            self.finish()
        else:
            self._show(None)
            self._hint()

    def _point(self, view: int, position: QPointF) -> Point | None:
        volume, widgets = self._documents.volume, self._views.view_widgets
        if volume is None or not self._documents.is_current or view >= len(widgets):
            return None
        return point_at(widgets[view], self._store.scene, volume, position)

    def _on_moved(self, view: int, position: QPointF) -> None:
        # on slices a line follows the pointer; in three dimensions that would be a search for each move
        if self.points and self._views.view_widgets[view].viewport.shows_slice:
            self._show(self._point(view, position))

    def _on_key(self, key: int) -> None:
        if key == Qt.Key.Key_Escape:
            self.hold(self.kind if self.points else None)
        elif key == Qt.Key.Key_Backspace:
            self.points = self.points[:-1]
            self._show(None)
        else:
            self.finish()

    def _show(self, pointer: Point | None) -> None:
        """Draw what there is so far."""
        points = (*self.points, *((pointer,) if pointer is not None else ()))
        pending = None
        if points and self.kind is not None:
            least = COUNTS[self.kind][0]
            kind: Kind = self.kind if len(points) >= least else "polyline" if len(points) > 1 else "point"
            # what is not yet what it will be says nothing
            pending = Measurement(kind, points, f"{kind.capitalize()} 1" if kind == self.kind else "")
        self._views.show_pending(pending)

    def _hint(self) -> None:
        if self.kind is None:
            self.hinted.emit("")
            return
        least, most = COUNTS[self.kind]
        count = len(self.points)
        if self.kind == "ellipse":
            words = [
                self.tr("Click in the middle of the ellipse"),
                self.tr("Click where its first axis ends"),
                self.tr("Click where its second axis ends"),
            ][min(count, 2)]
        elif self.kind == "angle":
            words = [
                self.tr("Click on the first leg of the angle"),
                self.tr("Click on its vertex"),
                self.tr("Click on the second leg"),
            ][min(count, 2)]
        elif self.kind == "arrow":
            words = [self.tr("Click where the text is to stand"), self.tr("Click on what the arrow shows")][
                min(count, 1)
            ]
        elif most is None and count >= least:
            words = self.tr("Click further points; double-click or Enter ends, Backspace takes one back")
        else:
            words = self.tr("Click on a point; Escape puts the tool away")
        self.hinted.emit(words)

    # ------------------------------------------------------------------ points that are there

    def _grab(self, view: int, position: QPointF) -> bool:
        """Take up a point of a measurement on a slice; whether there is one."""
        self._held = None
        widget = self._views.view_widgets[view]
        viewport, shown = widget.viewport, widget.annotations
        if not viewport.shows_slice or not shown.is_shown("measurements"):
            return False
        subject = shown.subject()
        if subject is None or subject.plane is None:
            return False
        through, normal, reach = subject.plane
        projection = Projection(viewport.view_camera, (viewport.width(), viewport.height()))
        nearest = GRIP
        for number, each in enumerate(self._store.scene.measurements):
            if each.locked or not each.visible:
                continue
            for at, point in enumerate(each.points):
                away = sum((p - q) * n for p, q, n in zip(point.position, through, normal, strict=True))
                x, y = projection.pixels([point.position])[0]
                distance = float(((x - position.x()) ** 2 + (y - position.y()) ** 2) ** 0.5)
                if abs(away) <= reach and distance <= nearest:
                    nearest, self._held = distance, (number, at)
        return self._held is not None

    def _on_dragged(self, view: int, position: QPointF) -> None:
        point = self._point(view, position)
        if self._held is None or point is None:
            return
        number, at = self._held
        found = self._store.scene.measurements
        if number < len(found):
            points = tuple(point if n == at else old for n, old in enumerate(found[number].points))
            self._store.update(
                lambda scene: with_measurement_changed(scene, number, points=points),
                label=self.tr("Move a point"),
                gesture=self._views.view_widgets[view].viewport.drag_key,
            )

    def _on_changed(self, old: LoadedScene, new: LoadedScene) -> None:
        if new.volume is None and self.kind is not None:
            self.hold(None)
        elif new.volume is not old.volume and self.points:
            self.hold(self.kind)
