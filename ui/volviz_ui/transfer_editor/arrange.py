"""Menus that arrange points and put shapes on the curve."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QPointF
from PySide6.QtWidgets import QMenu

from volviz.model.transfer import edits
from volviz.model.transfer.function import TransferFunction
from volviz.model.transfer.shapes import Shape, with_shape

if TYPE_CHECKING:
    from volviz_ui.transfer_editor.plot import TransferPlot

Edit = Callable[[TransferFunction, frozenset[int]], Any]


def shapes(plot: TransferPlot) -> list[tuple[Shape, str, str]]:
    """Shape, label and tooltip of each that can be put on the curve."""
    return [
        ("tent", plot.tr("Tent"), plot.tr("Straight up and down again")),
        ("gaussian", plot.tr("Gaussian peak"), plot.tr("A soft peak around one value")),
        ("box", plot.tr("Box"), plot.tr("One opacity between two values")),
        ("ramp", plot.tr("Ramp"), plot.tr("Rising in a straight line")),
    ]


def add_shape(plot: TransferPlot, shape: Shape, center: float | None = None, height: float = 0.3) -> None:
    """Put a shape a tenth of the window wide on the curve and choose its points."""
    model = plot.model
    function = model.function
    if function is None:
        return
    middle = plot.axis.value(0.5) if center is None else center
    width = 0.1 * (plot.axis.high - plot.axis.low)
    result = with_shape(function, shape, middle, width, height)
    low, high = middle - width / 2 * (1 + 1e-9), middle + width / 2 * (1 + 1e-9)
    chosen = {i for i, p in enumerate(result.points) if low <= p.value <= high and p.opacity > 0}
    model.apply(result, plot.tr("Add shape"), chosen)


def arrangements(plot: TransferPlot) -> list[tuple[str, str, Edit] | None]:
    """Label, icon and edit of each arrangement; None is a separator."""
    align = edits.aligned
    return [
        (plot.tr("Align at the left"), "align-left", lambda f, s: align(f, s, "left")),
        (plot.tr("Align at the middle value"), "align-center-horizontal", lambda f, s: align(f, s, "center")),
        (plot.tr("Align at the right"), "align-right", lambda f, s: align(f, s, "right")),
        (plot.tr("Align at the top"), "align-top", lambda f, s: align(f, s, "top")),
        (plot.tr("Align at the mean opacity"), "align-center-vertical", lambda f, s: align(f, s, "middle")),
        (plot.tr("Align at the bottom"), "align-bottom", lambda f, s: align(f, s, "bottom")),
        None,
        (plot.tr("Distribute evenly"), "arrows-out-line-horizontal", edits.distributed),
        (plot.tr("Flip left to right"), "arrows-left-right", edits.flipped),
        (plot.tr("Flip top to bottom"), "arrows-down-up", edits.inverted),
        None,
        (plot.tr("Spread by a tenth"), "arrows-out", lambda f, s: edits.scaled(f, s, value=1.1)),
        (plot.tr("Narrow by a tenth"), "arrows-in", lambda f, s: edits.scaled(f, s, value=1 / 1.1)),
        (plot.tr("Double the opacities"), "plus-circle", lambda f, s: edits.scaled(f, s, opacity=2.0)),
        (plot.tr("Halve the opacities"), "minus-circle", lambda f, s: edits.scaled(f, s, opacity=0.5)),
    ]


def arrange(plot: TransferPlot, label: str, edit: Edit) -> None:
    """Apply an arrangement to the chosen points, or to all when none are chosen."""
    model = plot.model
    function = model.function
    if function is None:
        return
    chosen = model.selection or frozenset(range(len(function.points)))
    result = edit(function, chosen)
    if isinstance(result, tuple):
        function, indices = result
        model.apply(function, label, indices if model.selection else None)
    else:
        model.apply(result, label)


def fill_arrange_menu(menu: QMenu, plot: TransferPlot) -> None:
    """Entries of all arrangements."""
    from volviz_ui.style.icons import set_icon

    for one in arrangements(plot):
        if one is None:
            menu.addSeparator()
            continue
        label, icon, edit = one
        action = menu.addAction(label)
        set_icon(action, icon)
        action.triggered.connect(lambda _checked=False, label=label, edit=edit: arrange(plot, label, edit))


def fill_shape_menu(menu: QMenu, plot: TransferPlot, at: QPointF | None = None) -> None:
    """Entries of all shapes; at a pixel of the plot, or in the middle of the window."""
    for shape, label, tip in shapes(plot):
        action = menu.addAction(label)
        action.setToolTip(tip)
        center = None if at is None else plot.places.value(at.x())
        height = 0.3 if at is None else max(plot.places.opacity(at.y()), 0.001)
        action.triggered.connect(
            lambda _checked=False, shape=shape, center=center, height=height: add_shape(
                plot, shape, center, height
            )
        )


def context_menu(plot: TransferPlot, at: QPointF) -> QMenu:
    """The menu of the plot at a pixel."""
    menu = QMenu(plot)
    menu.setToolTipsVisible(True)
    has_choice = bool(plot.model.selection) or plot.model.color_point is not None
    menu.addAction(plot.tr("Add point here")).triggered.connect(lambda: plot.add_point(at))
    menu.addAction(plot.tr("Add colour here")).triggered.connect(
        lambda: plot.add_color_point(plot.places.value(at.x()))
    )
    fill_shape_menu(menu.addMenu(plot.tr("Add shape here")), plot, at)
    menu.addSeparator()
    for label, slot in (
        (plot.tr("Colour…"), plot.color_requested.emit),
        (plot.tr("Duplicate"), plot.duplicate),
        (plot.tr("Delete"), plot.delete),
    ):
        action = menu.addAction(label)
        action.setEnabled(has_choice)
        action.triggered.connect(lambda _checked=False, slot=slot: slot())
    fill_arrange_menu(menu.addMenu(plot.tr("Arrange")), plot)
    menu.addSeparator()
    menu.addAction(plot.tr("Show all data")).triggered.connect(plot.fit_data)
    menu.addAction(plot.tr("Show all points")).triggered.connect(plot.fit_function)
    menu.addAction(plot.tr("Show the middle 99 % of the voxels")).triggered.connect(
        lambda _checked: plot.fit_percentiles()
    )
    return menu
