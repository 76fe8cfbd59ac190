"""Where the views lie: side by side, or two over each other as a wipe, blinking, or as their difference."""

from __future__ import annotations

from itertools import pairwise

from PySide6.QtCore import QEvent, QObject, QRect, QTimer, Signal
from PySide6.QtWidgets import QWidget

from volviz.model.comparison import Comparison
from volviz.model.scene import Layout
from volviz_ui.views.difference_view import DifferenceView
from volviz_ui.views.divider import Divider
from volviz_ui.views.header import HEIGHT as HEADER
from volviz_ui.views.view_widget import BORDER, ViewWidget

GAP = 4


class ViewLayout(QObject):
    """Places view widgets, and what lies over them, in an area.

    Parameters
    ----------
    area : QWidget
        The parent of all frames and headers.
    """

    divider_moved = Signal(float)

    def __init__(self, area: QWidget) -> None:
        super().__init__(area)
        self._area = area
        self._view_widgets: list[ViewWidget] = []
        self._comparison = Comparison()
        self._second_shown = False
        self.divider = Divider(area)
        self.divider.moved.connect(self.divider_moved)
        self.divider.hide()
        self.difference = DifferenceView(area)
        self._blink = QTimer(self)
        self._blink.timeout.connect(self._on_blink)
        area.installEventFilter(self)

    # ------------------------------------------------------------------ what is seen

    @property
    def overlaid(self) -> bool:
        """Whether two views lie over each other."""
        return len(self._view_widgets) > 1 and self._comparison.mode != "side_by_side"

    @property
    def wiped(self) -> bool:
        """Whether one of the two is seen at the left of a divider, the other one at its right."""
        return self.overlaid and self._comparison.mode == "wipe"

    @property
    def pair(self) -> tuple[ViewWidget, ViewWidget] | None:
        """The compared views, A and B; None when there is one view only."""
        if len(self._view_widgets) < 2:
            return None
        first, second = self._comparison.pair_of(len(self._view_widgets))
        return self._view_widgets[first], self._view_widgets[second]

    @property
    def shown(self) -> list[ViewWidget]:
        """The view widgets that are to be seen, or whose difference is."""
        pair = self.pair
        return list(pair) if pair is not None and self.overlaid else list(self._view_widgets)

    @property
    def blinks(self) -> bool:
        """Whether images are being exchanged."""
        return self._blink.isActive()

    def arrange(
        self, view_widgets: list[ViewWidget], active: int, comparison: Comparison, layout: Layout = "grid"
    ) -> None:
        """Lay out view widgets; `active` is the number of the active one."""
        former = (self.pair, self._comparison.mode)
        self._view_widgets, self._comparison = view_widgets, comparison
        if (self.pair, comparison.mode) != former:
            self._second_shown = False
            self.difference.clear()
        shown = self.shown
        for view_widget in view_widgets:
            view_widget.frame.setVisible(view_widget in shown)
            view_widget.header.setVisible(view_widget in shown and len(view_widgets) > 1)
            view_widget.header.set_dimmed(False)
            view_widget.controller.share = 1.0 / len(shown)
        mode = comparison.mode if self.overlaid else ""
        self.divider.setVisible(mode == "wipe")
        self.difference.setVisible(mode == "difference")
        for view_widget in view_widgets:
            if mode not in ("blink", "difference"):
                view_widget.viewport.is_covered = False
        if len(view_widgets) == 1:
            view_widgets[0].place(self._area.rect())
        elif mode:
            self._place_overlaid(mode, active)
        elif layout == "large":
            self._place_beside_large()
        else:
            self._place_side_by_side()
        self._update_blink()

    # ------------------------------------------------------------------ places

    def _place_side_by_side(self) -> None:
        area, view_widgets = self._area, self._view_widgets
        rows = (len(view_widgets) + 1) // 2
        # all cells are equally large, so that images can be compared pixel by pixel
        width = (area.width() - GAP) // 2
        height = (area.height() - GAP * (rows - 1)) // rows
        for number, view_widget in enumerate(view_widgets):
            left = number % 2 * (area.width() - width)
            top = number // 2 * (area.height() - height)
            view_widget.header.setGeometry(left, top, width, HEADER)
            view_widget.place(QRect(left, top + HEADER, width, height - HEADER), border=BORDER)

    def _place_beside_large(self) -> None:
        """The first view large, the others one below the other at its right."""
        area, (large, *others) = self._area, self._view_widgets
        width = max(area.width() // 3, 120)
        left = area.width() - width
        cells = [QRect(0, 0, left - GAP, area.height())]
        edges = [round(n * (area.height() + GAP) / len(others)) for n in range(len(others) + 1)]
        cells += [QRect(left, top, width, bottom - GAP - top) for top, bottom in pairwise(edges)]
        for view_widget, cell in zip((large, *others), cells, strict=True):
            view_widget.header.setGeometry(cell.left(), cell.top(), cell.width(), HEADER)
            view_widget.place(cell.adjusted(0, HEADER, 0, 0), border=BORDER)

    def _place_overlaid(self, mode: str, active: int) -> None:
        pair = self.pair
        if pair is None:
            return
        first, second = pair
        area = self._area
        half = (area.width() - GAP) // 2
        first.header.setGeometry(0, 0, half, HEADER)
        second.header.setGeometry(area.width() - half, 0, half, HEADER)
        body = QRect(0, HEADER, area.width(), area.height() - HEADER)
        first.place(body)
        if mode == "wipe":
            share = self._comparison.divider
            second.place(body, visible=body.adjusted(round(share * body.width()), 0, 0, 0))
            second.frame.raise_()
            self.divider.place(body.left(), body.top(), body.width(), body.height(), share)
            return
        second.place(body)
        if mode == "blink":
            self._show_side()
            return
        # drags below the difference begin in the view that is active already
        (second if active == second.view else first).frame.raise_()
        first.viewport.is_covered = second.viewport.is_covered = True
        self.difference.setGeometry(body)
        self.difference.raise_()
        self.difference.set_comparison(self._comparison)

    # ------------------------------------------------------------------ blinking

    def _show_side(self) -> None:
        if self.pair is None:
            return
        first, second = self.pair
        shown, hidden = (second, first) if self._second_shown else (first, second)
        shown.frame.raise_()
        shown.viewport.is_covered = False
        hidden.viewport.is_covered = True
        shown.header.set_dimmed(False)
        hidden.header.set_dimmed(True)

    def _on_blink(self) -> None:
        handle = self._area.window().windowHandle()
        if handle is None or not handle.isExposed() or self._area.window().isMinimized():
            # nobody sees it; drawing or showing the window again starts it anew
            self._blink.stop()
            return
        self._second_shown = not self._second_shown
        self._show_side()

    def _update_blink(self) -> None:
        wanted = self.overlaid and self._comparison.mode == "blink" and self._area.isVisible()
        period = round(1000 * self._comparison.period)
        if not wanted:
            self._blink.stop()
        elif not self._blink.isActive() or self._blink.interval() != period:
            self._blink.start(period)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Nothing blinks while the window is hidden."""
        if event.type() == QEvent.Type.Hide:
            self._blink.stop()
        elif event.type() in (QEvent.Type.Show, QEvent.Type.Paint):
            self._update_blink()
        return super().eventFilter(watched, event)

    def close(self) -> None:
        """Stop the clock."""
        self._blink.stop()
        self.difference.clear()
