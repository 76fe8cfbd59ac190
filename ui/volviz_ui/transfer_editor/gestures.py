"""What a press and drag does; each gesture turns pixels into edits of the function it started from."""

from __future__ import annotations

import math

from PySide6.QtCore import QPointF, QRectF

from volviz.model.transfer import edits
from volviz.model.transfer.channels import with_moved_point
from volviz_ui.transfer_editor.editable_plot import EditablePlot

#: Pixels that a press may wander before it is a drag.
SLACK = 3.0


class Gesture:
    """A press, some moves, and a release or Escape.

    Parameters
    ----------
    plot : EditablePlot
        Where it happens.
    at : QPointF
        Where the press was.
    """

    #: Words for the undo menu; empty for gestures that change nothing in the scene.
    label = ""

    def __init__(self, plot: EditablePlot, at: QPointF) -> None:
        self.plot = plot
        self.start = QPointF(at)
        self.begun = False

    def move(self, at: QPointF, *, restricted: bool) -> None:
        """The pointer has moved; restricted to one axis while Shift is held."""
        if not self.begun:
            if (at - self.start).manhattanLength() < SLACK:
                return
            self.begun = True
            if self.label:
                self.plot.model.begin()
        self.drag(at, restricted=restricted)

    def finish(self) -> None:
        """The button was released."""
        if self.begun and self.label:
            self.plot.model.finish()

    def cancel(self) -> None:
        """Escape was pressed."""
        if self.begun and self.label:
            self.plot.model.cancel()

    def drag(self, at: QPointF, *, restricted: bool) -> None:
        """Act on the pointer's new place."""
        raise NotImplementedError

    def _straight(self, at: QPointF, *, restricted: bool) -> QPointF:
        """The pointer's place, on the nearer axis through the start when restricted."""
        if not restricted:
            return at
        offset = at - self.start
        if abs(offset.x()) >= abs(offset.y()):
            return QPointF(at.x(), self.start.y())
        return QPointF(self.start.x(), at.y())


class MovePoints(Gesture):
    """Drag the chosen points; the one under the pointer follows it exactly."""

    def __init__(self, plot: EditablePlot, at: QPointF, index: int) -> None:
        super().__init__(plot, at)
        self.label = plot.tr("Move points")
        self.index = index
        self.function = plot.model.function
        point = self.function.points[index]  # type: ignore[union-attr]
        self.grip = plot.places.point(point.value, point.opacity) - at

    def drag(self, at: QPointF, *, restricted: bool) -> None:
        """Act on the pointer's new place."""
        if self.function is None:
            return
        model, places = self.plot.model, self.plot.places
        point = self.function.points[self.index]
        target = self._straight(at, restricted=restricted) + self.grip
        # the pixel of the press stands for the exact value, or a restricted drag would round it
        value = places.value(target.x()) - places.value(self.start.x() + self.grip.x())
        opacity = places.opacity(target.y()) - point.opacity
        if restricted and target.y() == self.start.y() + self.grip.y():
            opacity = 0.0
        model.apply(edits.moved(self.function, model.selection, value, opacity), self.label)


class RubberBand(Gesture):
    """Choose the points in a rectangle."""

    def __init__(self, plot: EditablePlot, at: QPointF, *, adding: bool) -> None:
        super().__init__(plot, at)
        self.before = plot.model.selection if adding else frozenset()

    def drag(self, at: QPointF, *, restricted: bool) -> None:
        """Act on the pointer's new place."""
        box = QRectF(self.start, at).normalized()
        self.plot.band = box
        function = self.plot.model.function
        if function is not None:
            self.plot.model.select(self.before | self.plot.places.within(box, function))
        self.plot.update()

    def finish(self) -> None:
        """The button was released."""
        if not self.begun:
            self.plot.model.select(self.before)
        self._end()

    def cancel(self) -> None:
        """Escape was pressed."""
        self.plot.model.select(self.before)
        self._end()

    def _end(self) -> None:
        self.plot.band = None
        self.plot.update()


class Pan(Gesture):
    """Move the window of values."""

    def __init__(self, plot: EditablePlot, at: QPointF) -> None:
        super().__init__(plot, at)
        self.axis = plot.axis

    def drag(self, at: QPointF, *, restricted: bool) -> None:
        """Act on the pointer's new place."""
        self.plot.set_axis(self.axis.panned((self.start.x() - at.x()) / self.plot.places.plot.width()))

    def cancel(self) -> None:
        """Escape was pressed."""
        self.plot.set_axis(self.axis)


class ShiftStretch(Gesture):
    """Sideways: the whole function moves. Up and down: it spreads about the value of the press."""

    def __init__(self, plot: EditablePlot, at: QPointF) -> None:
        super().__init__(plot, at)
        self.label = plot.tr("Shift and stretch")
        self.function = plot.model.function
        self.center = plot.places.value(at.x())

    def drag(self, at: QPointF, *, restricted: bool) -> None:
        """Act on the pointer's new place."""
        if self.function is None:
            return
        at = self._straight(at, restricted=restricted)
        places = self.plot.places
        offset = places.value(at.x()) - places.value(self.start.x())
        factor = stretch_factor(self.start.y() - at.y())
        function = self.function.stretched(factor, self.center).shifted(offset)
        self.plot.model.apply(function, self.label)


class MoveColorPoint(Gesture):
    """Move a stop of the colour ramp; the opacities stay."""

    def __init__(self, plot: EditablePlot, at: QPointF, index: int) -> None:
        super().__init__(plot, at)
        self.label = plot.tr("Move colour")
        self.index = index
        self.channels = plot.model.channels
        self.grip = plot.places.x(self.channels[0][index].value) - at.x()

    def drag(self, at: QPointF, *, restricted: bool) -> None:
        """Act on the pointer's new place."""
        colors, opacities = self.channels
        value = self.plot.places.value(at.x() + self.grip)
        self.plot.model.apply_channels(with_moved_point(colors, self.index, value), opacities, self.label)


class MoveMarker(Gesture):
    """Move an isovalue; what follows from it is the business of whoever listens."""

    def __init__(self, plot: EditablePlot, at: QPointF, index: int) -> None:
        super().__init__(plot, at)
        self.label = plot.tr("Move isovalue")
        self.index = index
        self.before = plot.markers
        self.grip = plot.places.x(self.before[index]) - at.x()

    def drag(self, at: QPointF, *, restricted: bool) -> None:
        """Act on the pointer's new place."""
        self.plot.move_marker(self.index, self.plot.places.value(at.x() + self.grip))

    def cancel(self) -> None:
        """Escape was pressed."""
        if self.begun:
            self.plot.set_markers(self.before, self.plot.marker_colors)
        super().cancel()


def stretch_factor(pixels_up: float) -> float:
    """Factor of a vertical drag: 120 pixels up double the width, 120 down halve it."""
    return math.exp2(min(max(pixels_up / 120.0, -6.0), 6.0))
