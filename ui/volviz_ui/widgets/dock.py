"""Docks with a quiet title of our own: caption, float, close."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QDockWidget, QHBoxLayout, QLabel, QMainWindow, QToolButton, QWidget

from volviz_ui.style.icons import set_icon


class Dock(QDockWidget):
    """A dock around a panel.

    Parameters
    ----------
    name : str
        Object name, under which Qt remembers its place.
    title : str
        Caption.
    widget : QWidget
        The panel.
    tip : str
        What the panel is for.
    keys : tuple of str
        Keys that open it.
    """

    def __init__(
        self, name: str, title: str, widget: QWidget, parent: QMainWindow, *, tip: str, keys: tuple[str, ...]
    ) -> None:
        super().__init__(title, parent)
        self.tip, self.keys = tip, keys
        self.setObjectName(name)
        self.setWidget(widget)
        self.setTitleBarWidget(_Title(self, title))
        self.is_in_front = False
        """Whether it is seen, and not only the tab that leads to it."""
        self.visibilityChanged.connect(self._on_visibility_changed)
        self.toggleViewAction().triggered.connect(lambda on: on and self.bring_up())

    @property
    def is_open(self) -> bool:
        """Whether it is open, be it behind another one."""
        return self.toggleViewAction().isChecked()

    def bring_up(self) -> None:
        """Open it and bring it to the front; a panel that takes keys gets them."""
        self.show()
        self.raise_()
        if self.widget().focusProxy() is not None:
            self.widget().setFocus()

    def _on_visibility_changed(self, visible: bool) -> None:
        self.is_in_front = visible

    def toggle_floating(self) -> None:
        """Between docked and floating."""
        self.setFloating(not self.isFloating())


class _Title(QWidget):
    def __init__(self, dock: Dock, title: str) -> None:
        super().__init__(dock)
        self.setObjectName("dock_title")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        caption = QLabel(title.upper(), self)
        caption.setObjectName("dock_caption")
        font = caption.font()
        font.setPointSizeF(font.pointSizeF() * 0.86)
        font.setLetterSpacing(font.SpacingType.AbsoluteSpacing, 0.6)
        caption.setFont(font)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(12, 4, 6, 4)
        layout.setSpacing(2)
        layout.addWidget(caption, 1)
        for icon_name, tooltip, slot in (
            ("arrow-square-out", self.tr("Float or dock this panel"), dock.toggle_floating),
            ("x", self.tr("Close this panel (View menu brings it back)"), dock.close),
        ):
            button = QToolButton(self)
            button.setObjectName("dock_button")
            button.setIconSize(QSize(14, 14))
            button.setToolTip(tooltip)
            button.setAccessibleName(tooltip)
            button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            set_icon(button, icon_name, "quiet")
            button.clicked.connect(slot)
            layout.addWidget(button)
