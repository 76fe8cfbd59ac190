"""The docks of the window, and the places where they belong."""

from __future__ import annotations

from PySide6.QtCore import QByteArray, QObject, Qt
from PySide6.QtWidgets import QMainWindow, QTabBar, QWidget

from volviz_ui.widgets.dock import Dock

VERSION = 3
"""Of the places that Qt remembers."""
SIDE_WIDTHS = [264, 340]
FOOT_HEIGHT = 236
_PLACES = (
    ("crosscheck", "transfer"),
    ("labels", "transfer"),
    ("compare", "data"),
    ("movie", "data"),
    ("measurements", "technique"),
)
"""Panels that share the place of another one."""


class Docks(QObject):
    """The docks by name, and the places where they belong.

    "data", "technique" and "transfer" are there from the beginning: left, right, and at the foot over the whole width.
    The others are hidden until somebody asks for them: "ray" beside the transfer function, the rest in tabs with these.
    """

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._docks: dict[str, Dock] = {}
        self._home: QByteArray | None = None
        window.setCorner(Qt.Corner.BottomLeftCorner, Qt.DockWidgetArea.BottomDockWidgetArea)
        window.setCorner(Qt.Corner.BottomRightCorner, Qt.DockWidgetArea.BottomDockWidgetArea)

    def add(self, name: str, title: str, panel: QWidget, tip: str, keys: tuple[str, ...] = ()) -> Dock:
        """Put a panel into a dock; the tip says what the panel is for, the keys open it."""
        dock = self._docks[name] = Dock(f"{name}_dock", title, panel, self._window, tip=tip, keys=keys)
        # until it has a place: what Qt remembers of a window may be older than the panel
        dock.hide()
        return dock

    def __getitem__(self, name: str) -> Dock:
        return self._docks[name]

    @property
    def names(self) -> list[str]:
        """Their names, in the order of the menu."""
        return list(self._docks)

    @property
    def all(self) -> list[Dock]:
        """All of them, in the order of the menu."""
        return list(self._docks.values())

    def show(self, name: str) -> None:
        """Open a dock and bring it to the front; the layout has settled afterwards."""
        self[name].bring_up()
        # at once: the size that is left to the views may decide what happens next
        self._window.layout().activate()

    def switch(self, name: str, on: bool) -> None:
        """Open or close a dock; one that lies behind another comes to the front instead of being closed."""
        if on or not self[name].is_in_front:
            self.show(name)
        else:
            self[name].close()

    def restore(self, state: QByteArray) -> bool:
        """Put all docks where `QMainWindow.saveState` found them; False when that was another set of docks."""
        direct = Qt.FindChildOption.FindDirectChildrenOnly
        before = self._window.findChildren(QTabBar, options=direct)
        restored = bool(self._window.restoreState(state, VERSION))
        if restored:
            # Qt makes new bars of tabs, and leaves the old ones where they were
            for bar in before:
                bar.hide()
        return restored

    def state(self) -> QByteArray:
        """Where all docks are, to be remembered."""
        return self._window.saveState(VERSION)

    def reset(self) -> None:
        """All panels docked, where they belong."""
        window = self._window
        if self._home is None:
            self._arrange()
            self._home = self.state()
        else:
            # a dock that is put into its tabs twice has a place in both
            self.restore(self._home)
        window.resizeDocks([self["data"], self["technique"]], SIDE_WIDTHS, Qt.Orientation.Horizontal)
        window.resizeDocks([self["transfer"]], [FOOT_HEIGHT], Qt.Orientation.Vertical)

    def _arrange(self) -> None:
        window = self._window
        for name, area in (
            ("data", Qt.DockWidgetArea.LeftDockWidgetArea),
            ("technique", Qt.DockWidgetArea.RightDockWidgetArea),
            ("transfer", Qt.DockWidgetArea.BottomDockWidgetArea),
        ):
            self[name].setFloating(False)
            window.addDockWidget(area, self[name])
            self[name].show()
        # one after the other: all at once would need more room than the window has
        self["ray"].setFloating(False)
        window.splitDockWidget(self["transfer"], self["ray"], Qt.Orientation.Horizontal)
        self["ray"].hide()
        for name, place in _PLACES:
            self[name].setFloating(False)
            window.tabifyDockWidget(self[place], self[name])
            self[name].hide()
