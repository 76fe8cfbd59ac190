"""What can be done with the function in the plot, whoever asks for it: mouse, keys or menus."""

from __future__ import annotations

from PySide6.QtCore import QPointF, Signal

from volviz.model.transfer.channels import with_point, without_point
from volviz_ui.transfer_editor.plot_view import PlotView

#: A double click this near to the curve adds a point on it, pixels.
ON_CURVE = 6.0


class EditablePlot(PlotView):
    """A plot with the edits of what it shows."""

    color_requested = Signal()
    fields_requested = Signal()
    marker_moved = Signal(int, float)

    key_is_held = False
    """Whether a key that is held down has begun a gesture."""

    # ------------------------------------------------------------------ isovalues

    def choose_next_marker(self) -> None:
        """Choose the next isovalue, and none after the last one."""
        chosen = self.marker + 1 if self.marker + 1 < len(self.markers) else -1
        self.model.select(())
        self.marker = chosen
        if chosen >= 0:
            self.reveal(self.markers[chosen])
        self.describe_marker()
        self.update()

    def nudge_marker(self, pixels: float) -> None:
        """Move the chosen isovalue."""
        if pixels and 0 <= self.marker < len(self.markers):
            self.move_marker(
                self.marker, self.places.value(self.places.x(self.markers[self.marker]) + pixels)
            )
            self.describe_marker()

    def move_marker(self, index: int, value: float) -> None:
        """Give an isovalue another value, within the range of the data."""
        value = min(max(value, self.axis.data_low), self.axis.data_high)
        self.set_markers((*self.markers[:index], value, *self.markers[index + 1 :]), self.marker_colors)
        self.marker_moved.emit(index, value)

    # ------------------------------------------------------------------ edits

    def add_point(self, at: QPointF) -> None:
        """Add a point at a pixel; on the curve when it is near."""
        function = self.model.function
        if function is None:
            return
        places = self.places
        value = places.value(at.x())
        red, green, blue, alpha = function.with_opacity(1.0).evaluate([value])[0].tolist()
        if abs(places.y(alpha) - at.y()) > ON_CURVE:
            alpha = places.opacity(at.y())
        function, index = function.with_point(value, (red, green, blue, alpha))
        self.model.apply(function, self.tr("Add point"), {index})

    def add_color_point(self, value: float) -> None:
        """Add a stop to the colour ramp that leaves it as it looks."""
        colors, opacities = self.model.channels
        colors, index = with_point(colors, value)
        self.model.apply_channels(colors, opacities, self.tr("Add colour"), index)

    def delete(self) -> None:
        """Remove the chosen points or the chosen stop."""
        color_point = self.model.color_point
        if color_point is None:
            self.model.delete_selected()
            return
        colors, opacities = self.model.channels
        self.model.select_color_point(None)
        self.model.apply_channels(without_point(colors, color_point), opacities, self.tr("Delete colour"))

    def duplicate(self) -> None:
        """Copy the chosen points a little to the right."""
        self.model.duplicate_selected(0.02 * (self.axis.high - self.axis.low))

    def select_neighbour(self, step: int, *, adding: bool = False) -> None:
        """Choose the next or previous point and bring it into view."""
        function = self.model.function
        if function is None:
            return
        chosen = sorted(self.model.selection)
        last = len(function.points) - 1
        if not chosen:
            index = 0 if step > 0 else last
        else:
            index = min(max((chosen[-1] if step > 0 else chosen[0]) + step, 0), last)
        self.model.select({*self.model.selection, index} if adding else {index})
        self.reveal(function.points[index].value)

    def reveal(self, value: float) -> None:
        """Pan so far that a value is visible."""
        if not self.places.is_visible(value):
            fraction = self.axis.fraction(value)
            self.set_axis(self.axis.panned(fraction - (0.1 if fraction < 0 else 0.9)))

    def shift_stretch(self, fraction: float, factor: float = 1.0, center: float | None = None) -> None:
        """Move all values by a fraction of the window and spread them; for keys and for other widgets."""
        function = self.model.function
        if function is None:
            return
        middle = (function.points[0].value + function.points[-1].value) / 2 if center is None else center
        offset = fraction * (self.axis.high - self.axis.low)
        self.model.apply(function.stretched(factor, middle).shifted(offset), self.tr("Shift and stretch"))
