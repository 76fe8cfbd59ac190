"""Where things lie in the plot, and what lies under the pointer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from PySide6.QtCore import QPointF, QRectF

from volviz_ui.transfer_editor.axes import OpacityAxis, ValueAxis

if TYPE_CHECKING:
    from volviz.model.transfer.channels import Channel
    from volviz.model.transfer.function import TransferFunction

#: Radius of a control point, and within which distance a press takes hold of it.
RADIUS, REACH = 5.5, 14.0
#: Height of the colour ramp, and of the stops below it.
RAMP, COLOR_POINTS = 16.0, 14.0
#: Room left of the plot for the opacities and below it for the values.
LEFT, RIGHT, TOP, BOTTOM = 40.0, 12.0, 10.0, 18.0

Part = Literal["point", "stop", "marker", "edge", "ramp", "plot", "none"]


@dataclass(frozen=True)
class Hit:
    """What lies under the pointer: a part, and which one of its kind."""

    part: Part
    index: int = -1


@dataclass(frozen=True)
class PlotLayout:
    """Rectangles of the plot's parts and the mapping between pixels and values.

    Attributes
    ----------
    width, height : float
        Size of the widget, device-independent pixels.
    axis : ValueAxis
        Horizontal.
    opacities : OpacityAxis
        Vertical.
    """

    width: float
    height: float
    axis: ValueAxis
    opacities: OpacityAxis

    @property
    def plot(self) -> QRectF:
        """Where curve and histogram are drawn."""
        return QRectF(LEFT, TOP, max(self.width - LEFT - RIGHT, 10.0), max(self.ramp.top() - 6.0 - TOP, 10.0))

    @property
    def ramp(self) -> QRectF:
        """The strip of colours."""
        top = self.height - BOTTOM - COLOR_POINTS - RAMP
        return QRectF(LEFT, top, max(self.width - LEFT - RIGHT, 10.0), RAMP)

    @property
    def color_points(self) -> QRectF:
        """Where the handles of the colours lie."""
        return QRectF(LEFT, self.ramp.bottom(), self.ramp.width(), COLOR_POINTS)

    def x(self, value: float) -> float:
        """Pixel of a value."""
        return self.plot.left() + self.axis.fraction(value) * self.plot.width()

    def y(self, opacity: float) -> float:
        """Pixel of an opacity."""
        return self.plot.bottom() - self.opacities.fraction(opacity) * self.plot.height()

    def value(self, x: float) -> float:
        """Value at a pixel."""
        return self.axis.value((x - self.plot.left()) / self.plot.width())

    def opacity(self, y: float) -> float:
        """Opacity at a pixel, within 0..1."""
        return self.opacities.opacity((self.plot.bottom() - y) / self.plot.height())

    def point(self, value: float, opacity: float) -> QPointF:
        """Pixel of a control point."""
        return QPointF(self.x(value), self.y(opacity))

    def is_visible(self, value: float) -> bool:
        """Whether a value lies within the window."""
        return self.axis.low <= value <= self.axis.high

    def outside(self, function: TransferFunction) -> tuple[list[int], list[int]]:
        """Indices of the points left and right of the window."""
        left = [i for i, p in enumerate(function.points) if p.value < self.axis.low]
        right = [i for i, p in enumerate(function.points) if p.value > self.axis.high]
        return left, right

    def edge_marker(self, right: bool) -> QRectF:
        """Where the marker for points outside the window lies."""
        plot = self.plot
        return QRectF(plot.right() - 40 if right else plot.left() + 2, plot.center().y() - 13, 38, 26)

    def hit(
        self,
        at: QPointF,
        function: TransferFunction | None,
        colors: Channel,
        markers: tuple[float, ...],
        selection: frozenset[int] = frozenset(),
    ) -> Hit:
        """What a press at a pixel takes hold of: the nearest point within reach, a chosen one first."""
        if function is None:
            return Hit("none")
        if self.ramp.bottom() <= at.y() <= self.color_points.bottom() + 4:
            near = [
                (abs(self.x(s.value) - at.x()), i) for i, s in enumerate(colors) if self.is_visible(s.value)
            ]
            if near and min(near)[0] <= REACH * 0.8:
                return Hit("stop", min(near)[1])
            return Hit("ramp")
        if self.ramp.top() <= at.y() <= self.ramp.bottom():
            return Hit("ramp")
        found: list[tuple[float, int]] = []
        for i, p in enumerate(function.points):
            if not self.is_visible(p.value):
                continue
            place = self.point(p.value, p.opacity)
            distance = ((place.x() - at.x()) ** 2 + (place.y() - at.y()) ** 2) ** 0.5
            if distance <= REACH:
                # at one place, the chosen one, else the last drawn
                found.append((distance - (4.0 if i in selection else 0.0) - 1e-6 * i, i))
        if found:
            return Hit("point", min(found)[1])
        left, right = self.outside(function)
        for side, there in ((False, left), (True, right)):
            if there and self.edge_marker(side).contains(at):
                return Hit("edge", int(side))
        for i, value in enumerate(markers):
            grip = self.plot.top() - 8 <= at.y() <= self.plot.top() + 18
            if self.is_visible(value) and abs(self.x(value) - at.x()) <= (REACH if grip else 5.0):
                return Hit("marker", i)
        if self.plot.adjusted(-8, -8, 8, 8).contains(at):
            return Hit("plot")
        return Hit("none")

    def within(self, box: QRectF, function: TransferFunction) -> frozenset[int]:
        """Indices of the points in a rectangle."""
        return frozenset(
            i
            for i, p in enumerate(function.points)
            if self.is_visible(p.value) and box.contains(self.point(p.value, p.opacity))
        )
