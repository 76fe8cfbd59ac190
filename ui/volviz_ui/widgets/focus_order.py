"""The Tab key goes through a panel as one reads it, in whatever order its widgets were made."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLayout, QWidget


def set_focus_order(container: QWidget) -> None:
    """Let Tab follow the layouts of a container: rows from above, in them from the left."""
    found = list(_focusable(container))
    for before, after in itertools.pairwise(found):
        QWidget.setTabOrder(before, after)


def _focusable(widget: QWidget) -> Iterator[QWidget]:
    layout = widget.layout()
    if layout is not None and widget.focusProxy() is not None:
        # Qt would stop at it a second time, wherever it stands in the order that the widgets were made in
        widget.setFocusProxy(None)
    if widget.focusPolicy() & Qt.FocusPolicy.TabFocus == Qt.FocusPolicy.TabFocus:
        yield widget
    if layout is not None:
        yield from _in_layout(layout)


def _in_layout(layout: QLayout) -> Iterator[QWidget]:
    for number in range(layout.count()):
        item = layout.itemAt(number)
        if item is None:
            continue
        widget, inner = item.widget(), item.layout()
        if widget is not None:
            yield from _focusable(widget)
        elif inner is not None:
            yield from _in_layout(inner)
