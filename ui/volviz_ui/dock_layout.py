"""The docks of the window, and the places where they belong."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, Qt
from PySide6.QtWidgets import QMainWindow, QWidget

from volviz_ui.dock import Dock

VERSION = 2
"""Of the places that Qt remembers."""
SIDE_WIDTHS = [264, 340]
FOOT_HEIGHT = 236


class DockLayout:
    """Makes the docks and puts them into their places.

    Attributes
    ----------
    data, technique, transfer : Dock
        There from the beginning: left, right, and at the foot over the whole width.
    ray, compare, crosscheck : Dock
        Hidden until somebody asks for them: beside the transfer function, in tabs with the data, in tabs with the
        transfer function.
    """

    def __init__(
        self,
        window: QMainWindow,
        *,
        data: QWidget,
        technique: QWidget,
        transfer: QWidget,
        ray: QWidget,
        compare: QWidget,
        crosscheck: QWidget,
    ) -> None:
        self._window = window
        self.data = Dock("data_dock", _tr("Data"), data, window)
        self.technique = Dock("technique_dock", _tr("Technique"), technique, window)
        self.transfer = Dock("transfer_dock", _tr("Transfer function"), transfer, window)
        self.ray = Dock("ray_dock", _tr("Ray inspector"), ray, window)
        self.compare = Dock("compare_dock", _tr("Compare"), compare, window)
        self.crosscheck = Dock("crosscheck_dock", _tr("Cross-check"), crosscheck, window)
        window.setCorner(Qt.Corner.BottomLeftCorner, Qt.DockWidgetArea.BottomDockWidgetArea)
        window.setCorner(Qt.Corner.BottomRightCorner, Qt.DockWidgetArea.BottomDockWidgetArea)
        self.ray.toggleViewAction().setShortcut("Ctrl+I")
        self.ray.toggleViewAction().setToolTip(
            _tr("Follow the ray behind a pixel, sample by sample: click in the picture")
        )
        self.compare.toggleViewAction().setShortcut("Ctrl+M")
        self.compare.toggleViewAction().setToolTip(
            _tr("How two views are compared, and what is measured of them")
        )
        self.crosscheck.toggleViewAction().setToolTip(
            _tr("Compare our mesh with those of VTK, difference by difference")
        )
        window.tabifyDockWidget(self.transfer, self.crosscheck)
        self.crosscheck.hide()

    @property
    def all(self) -> list[Dock]:
        """All docks, in the order of the menu."""
        return [self.data, self.technique, self.transfer, self.ray, self.compare, self.crosscheck]

    def reset(self) -> None:
        """All panels docked, where they belong."""
        window = self._window
        for dock, area in (
            (self.data, Qt.DockWidgetArea.LeftDockWidgetArea),
            (self.technique, Qt.DockWidgetArea.RightDockWidgetArea),
            (self.transfer, Qt.DockWidgetArea.BottomDockWidgetArea),
        ):
            dock.setFloating(False)
            window.addDockWidget(area, dock)
            dock.show()
        # one after the other: all at once would need more room than the window has
        self.ray.setFloating(False)
        window.splitDockWidget(self.transfer, self.ray, Qt.Orientation.Horizontal)
        self.ray.hide()
        for dock, place in ((self.crosscheck, self.transfer), (self.compare, self.data)):
            dock.setFloating(False)
            window.tabifyDockWidget(place, dock)
            dock.hide()
        window.resizeDocks([self.data, self.technique], SIDE_WIDTHS, Qt.Orientation.Horizontal)
        window.resizeDocks([self.transfer], [FOOT_HEIGHT], Qt.Orientation.Vertical)


def _tr(text: str) -> str:
    return QCoreApplication.translate("MainWindow", text)
