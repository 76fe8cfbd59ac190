"""A transparent sheet over a viewport, on which shapes are painted; the mouse does not notice it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPainterPath, QPaintEvent, QPen, QPolygonF, QRegion
from PySide6.QtWidgets import QWidget

from volviz.annotations.figure import RIM
from volviz.annotations.shapes import Area, Color, Line, Ramp, Shape, Text


class Overlay(QWidget):
    """Paints what a function gives, and only where that has changed.

    Parameters
    ----------
    shapes : callable
        The shapes of the moment, in pixels of the widget.
    viewport : QWidget
        Over which the sheet lies.
    """

    def __init__(self, shapes: Callable[[], Sequence[Shape]], viewport: QWidget) -> None:
        super().__init__(viewport)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._wanted = shapes
        self.shapes: tuple[Shape, ...] = ()
        viewport.installEventFilter(self)
        self.resize(viewport.size())

    def refresh(self) -> None:
        """Look at what is to be seen now."""
        shapes = tuple(self._wanted())
        if shapes == self.shapes:
            return
        region = QRegion()
        for changed in set(shapes).symmetric_difference(self.shapes):
            region += _place_of(changed).toAlignedRect()
        self.shapes = shapes
        self.update(region)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """As large as the viewport."""
        if event.type() == QEvent.Type.Resize and isinstance(watched, QWidget):
            self.resize(watched.size())
            self.refresh()
        return super().eventFilter(watched, event)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the shapes, the first one below the others."""
        if not self.shapes:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setClipRegion(event.region())
        for shape in self.shapes:
            paint(painter, shape)
        painter.end()


def paint(painter: QPainter, shape: Shape) -> None:
    """Paint a shape in its pixels."""
    if isinstance(shape, Line):
        pen = QPen(_color(shape.color), shape.width)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        painter.drawPolyline(_polygon(shape.points))
    elif isinstance(shape, Area):
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(_color(shape.color))
        painter.drawPolygon(_polygon(shape.points))
        painter.setBrush(Qt.BrushStyle.NoBrush)
    elif isinstance(shape, Ramp):
        count = len(shape.colors)
        for number, color in enumerate(shape.colors):
            # each strip reaches to the top, so that no seam is left between two
            height = shape.height * (count - number) / count
            painter.fillRect(QRectF(shape.left, shape.top, shape.width, height), _color(color))
    else:
        path = _letters(shape)
        painter.setPen(QPen(_color(shape.rim), RIM * shape.size, j=Qt.PenJoinStyle.RoundJoin))
        painter.drawPath(path)
        painter.fillPath(path, _color(shape.color))


def _letters(text: Text) -> QPainterPath:
    font = QFont()
    font.setPixelSize(max(1, round(text.size)))
    font.setBold(text.bold)
    path = QPainterPath()
    path.addText(0.0, 0.0, font, text.words)
    box = path.boundingRect()
    # one line stands like another, whatever its letters: the height of capitals counts
    capital = QPainterPath()
    capital.addText(0.0, 0.0, font, "0")
    height = capital.boundingRect().height()
    x, y = text.place
    left = {"left": 0.0, "middle": 0.5, "right": 1.0}[text.across] * box.width() + box.left()
    up = {"top": 1.0, "middle": 0.5, "bottom": 0.0}[text.upright] * height
    path.translate(x - left, y + up)
    return path


def _place_of(shape: Shape) -> QRectF:
    """A rectangle that holds all of a shape."""
    if isinstance(shape, Ramp):
        return QRectF(shape.left, shape.top, shape.width, shape.height).adjusted(-1, -1, 1, 1)
    if isinstance(shape, Text):
        reach = RIM * shape.size + 1
        return _letters(shape).boundingRect().adjusted(-reach, -reach, reach, reach)
    reach = shape.width + 1 if isinstance(shape, Line) else 1
    return _polygon(shape.points).boundingRect().adjusted(-reach, -reach, reach, reach)


def _polygon(points: Sequence[tuple[float, float]]) -> QPolygonF:
    return QPolygonF([QPointF(x, y) for x, y in points])


def _color(color: Color) -> QColor:
    r, g, b = color
    return QColor.fromRgbF(min(max(r, 0.0), 1.0), min(max(g, 0.0), 1.0), min(max(b, 0.0), 1.0))
