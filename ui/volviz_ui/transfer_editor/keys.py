"""Keys of the plot: everything that the mouse can do."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget

    from volviz_ui.transfer_editor.editable_plot import EditablePlot

Key = Qt.Key
_SHIFT, _CTRL, _ALT = (
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.AltModifier,
)
_ARROWS = {Key.Key_Left: (-1, 0), Key.Key_Right: (1, 0), Key.Key_Up: (0, 1), Key.Key_Down: (0, -1)}


#: Keys that go on acting while they are held down.
HELD = frozenset({*_ARROWS, Key.Key_BracketLeft, Key.Key_BracketRight, Key.Key_BraceLeft, Key.Key_BraceRight})


def shortcuts(widget: QWidget) -> list[tuple[str, str]]:
    """What can be done in the plot and how, as rows for a page of shortcuts."""
    tr = widget.tr
    return [
        (tr("Add a point"), tr("Double-click, Insert")),
        (tr("Choose the next, the previous point"), tr("Page Down, Page Up (Ctrl: in addition)")),
        (tr("Choose several points"), tr("Drag over empty plot, Ctrl+click")),
        (tr("Choose all, choose none"), tr("Ctrl+A, Escape")),
        (tr("Move what is chosen"), tr("Drag (Shift: along one axis), arrow keys (Shift: far, Ctrl: fine)")),
        (tr("Take a drag back"), tr("Escape")),
        (tr("Remove, duplicate"), tr("Delete, Ctrl+D")),
        (tr("Choose a colour"), tr("Double-click on the point, C")),
        (tr("Type value and opacity"), tr("Enter")),
        (tr("Choose the next, the previous colour of the ramp"), tr("Full stop, comma")),
        (tr("Add a colour to the ramp"), tr("Double-click on the ramp, Shift+Insert")),
        (tr("Choose an isovalue"), tr("I; arrow keys move it")),
        (tr("Shift and stretch everything"), tr("Drag the ramp, Alt+drag, [ ] and { }")),
        (tr("Zoom the value axis"), tr("Wheel, + and -")),
        (tr("Pan the value axis"), tr("Middle drag, Shift+wheel, Alt+Left and Alt+Right")),
        (tr("Show all data, all points"), tr("Home, End")),
    ]


def is_ours(plot: EditablePlot, event: QKeyEvent) -> bool:
    """Whether the plot has a use for the key, so that a shortcut of the window must wait."""
    if event.key() == Key.Key_Escape:
        chosen = bool(plot.model.selection) or plot.model.color_point is not None or plot.marker >= 0
        return plot.model.in_gesture or chosen
    return _action(plot, event) is not None


def press_key(plot: EditablePlot, event: QKeyEvent) -> bool:
    """Do what the key stands for; False when it stands for nothing here."""
    action = _action(plot, event)
    if action is None:
        return False
    if event.key() in HELD and not plot.model.in_gesture:
        # until the key is let go: holding it down is one step of the history
        plot.model.begin()
        plot.key_is_held = True
    action()
    event.accept()
    return True


def _action(plot: EditablePlot, event: QKeyEvent) -> Callable[[], object] | None:
    model, key, modifiers = plot.model, event.key(), event.modifiers()
    if model.function is None:
        return None
    shift, ctrl, alt = (bool(modifiers & m) for m in (_SHIFT, _CTRL, _ALT))
    if key in _ARROWS:
        across, up = _ARROWS[Key(key)]
        if alt:
            return (lambda: plot.set_axis(plot.axis.panned(0.08 * across))) if across else None
        return lambda: _nudge(plot, across, up, 10.0 if shift else 0.1 if ctrl else 1.0)
    if ctrl:
        last = len(model.function.points)
        with_control: dict[int, Callable[[], object]] = {
            Key.Key_A: lambda: model.select(() if shift else range(last)),
            Key.Key_D: plot.duplicate,
            Key.Key_PageDown: lambda: plot.select_neighbour(1, adding=True),
            Key.Key_PageUp: lambda: plot.select_neighbour(-1, adding=True),
        }
        return with_control.get(key)
    if alt:
        return None
    plain: dict[int, Callable[[], object]] = {
        Key.Key_PageDown: lambda: plot.select_neighbour(1),
        Key.Key_PageUp: lambda: plot.select_neighbour(-1),
        Key.Key_Delete: plot.delete,
        Key.Key_Backspace: plot.delete,
        Key.Key_Insert: lambda: (
            _insert_colour(plot) if shift or model.color_point is not None else _insert(plot)
        ),
        Key.Key_Period: lambda: _choose_color_point(plot, 1),
        Key.Key_Comma: lambda: _choose_color_point(plot, -1),
        Key.Key_I: plot.choose_next_marker,
        Key.Key_C: plot.color_requested.emit,
        Key.Key_Home: plot.fit_data,
        Key.Key_End: plot.fit_function,
        Key.Key_Plus: lambda: plot.zoom(1.25),
        Key.Key_Equal: lambda: plot.zoom(1.25),
        Key.Key_Minus: lambda: plot.zoom(0.8),
        Key.Key_BracketLeft: lambda: plot.shift_stretch(-0.005),
        Key.Key_BracketRight: lambda: plot.shift_stretch(0.005),
        Key.Key_BraceLeft: lambda: plot.shift_stretch(0.0, 1 / 1.05),
        Key.Key_BraceRight: lambda: plot.shift_stretch(0.0, 1.05),
        Key.Key_Return: plot.fields_requested.emit,
        Key.Key_Enter: plot.fields_requested.emit,
    }
    if key in (Key.Key_Return, Key.Key_Enter, Key.Key_C) and not (
        model.selection or model.color_point is not None
    ):
        return None
    return plain.get(key)


def _nudge(plot: EditablePlot, across: int, up: int, factor: float) -> None:
    """Two pixels a press, whatever the zoom; the first press without a choice chooses a point."""
    model = plot.model
    if plot.marker >= 0:
        plot.nudge_marker(across * 2.0 * factor)
        return
    if model.color_point is not None:
        _nudge_color_point(plot, across * 2.0 * factor)
        return
    if not model.selection:
        plot.select_neighbour(1 if across > 0 or up > 0 else -1)
        return
    function = model.function
    if function is None:
        return
    places = plot.places
    point = function.points[min(model.selection)]
    value = places.value(places.x(point.value) + 2.0 * factor * across) - point.value if across else 0.0
    opacity = places.opacity(places.y(point.opacity) - 2.0 * factor * up) - point.opacity if up else 0.0
    model.nudge(value, opacity)
    plot.reveal(point.value + value)


def _nudge_color_point(plot: EditablePlot, pixels: float) -> None:
    from volviz.model.transfer.channels import with_moved_point

    color_point = plot.model.color_point
    if pixels and color_point is not None:
        colors, opacities = plot.model.channels
        value = plot.places.value(plot.places.x(colors[color_point].value) + pixels)
        plot.model.apply_channels(
            with_moved_point(colors, color_point, value), opacities, plot.tr("Move colour")
        )


def _choose_color_point(plot: EditablePlot, step: int) -> None:
    """The next or previous colour of the ramp, brought into view."""
    colors, color_point = plot.model.channels[0], plot.model.color_point
    if colors:
        index = (
            (0 if step > 0 else len(colors) - 1)
            if color_point is None
            else min(max(color_point + step, 0), len(colors) - 1)
        )
        plot.model.select_color_point(index)
        plot.reveal(colors[index].value)


def _insert_colour(plot: EditablePlot) -> None:
    """Half way from the chosen colour to the next one, or in the middle of the window."""
    colors, color_point = plot.model.channels[0], plot.model.color_point
    if color_point is None:
        plot.add_color_point(plot.axis.value(0.5))
        return
    following = colors[color_point + 1].value if color_point + 1 < len(colors) else plot.axis.high
    plot.add_color_point((colors[color_point].value + following) / 2)


def _insert(plot: EditablePlot) -> None:
    """Half way to the next point, or in the middle of the window when nothing is chosen."""
    model = plot.model
    function = model.function
    if function is None:
        return
    if model.selection:
        index = max(model.selection)
        here = function.points[index].value
        following = function.points[index + 1].value if index + 1 < len(function.points) else plot.axis.high
        value = (here + following) / 2
    else:
        value = plot.axis.value(0.5)
    function, index = function.with_point(value)
    model.apply(function, plot.tr("Add point"), {index})
