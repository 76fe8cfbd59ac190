"""The menu bar and the tool bar, made of the table of commands."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QLabel, QMenu, QMenuBar, QSizePolicy, QToolBar, QToolButton, QWidget

from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Menu
from volviz_ui.commands.file import FileCommands
from volviz_ui.commands.table import CommandTable
from volviz_ui.commands.view import ViewCommands
from volviz_ui.dialogs.preferences import quality_choices
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.editors.technique_box import TechniqueBox
from volviz_ui.style.icons import set_icon


def fill_menu_bar(bar: QMenuBar, menus: Sequence[Menu], table: CommandTable) -> None:
    """Put menus into a menu bar."""
    for menu in menus:
        bar.addMenu(made_menu(menu, table, bar))


def made_menu(menu: Menu, table: CommandTable, parent: QWidget) -> QMenu:
    """A menu as a widget; one that changes is filled anew whenever it opens."""
    made = QMenu(menu.text, parent)
    made.setToolTipsVisible(True)
    if menu.icon:
        set_icon(made.menuAction(), menu.icon)
    if callable(menu.entries):
        made.aboutToShow.connect(lambda: _fill(made, menu, table))
    else:
        _fill(made, menu, table)
    return made


def _fill(made: QMenu, menu: Menu, table: CommandTable) -> None:
    made.clear()
    for entry in menu.now():
        if entry is None:
            made.addSeparator()
        elif isinstance(entry, Menu):
            made.addMenu(made_menu(entry, table, made))
        elif isinstance(entry, str):
            made.addAction(entry).setEnabled(False)
        else:
            made.addAction(table.action(entry, made))


class ToolBar(QToolBar):
    """What is needed most: opening, history, technique, quality, annotations, export."""

    def __init__(
        self, context: AppContext, table: CommandTable, files: FileCommands, views: ViewCommands
    ) -> None:
        super().__init__(context.window)
        self.setWindowTitle(self.tr("Tools"))
        self.setObjectName("tools")
        self.setMovable(False)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        self.setIconSize(QSize(20, 20))
        self._table = table
        self._add("file.open")
        samples = QToolButton(self)
        samples.setText(self.tr("Samples"))
        samples.setToolTip(self.tr("Volumes that come with the program"))
        set_icon(samples, "cube")
        samples.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        samples.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        samples.setMenu(made_menu(files.samples, table, samples))
        self.addWidget(samples)
        self.addSeparator()
        self._add("edit.undo", "edit.redo")
        self.addSeparator()
        self.technique = TechniqueBox(context.store, self)
        self.technique.setMinimumWidth(190)
        self._add_field(self.tr("Technique"), self.technique)
        self.quality = NoWheelComboBox(self)
        self.quality.setToolTip(self.tr("How much is given up while something moves"))
        self.quality.setAccessibleName(self.tr("Quality"))
        self.quality.setMinimumContentsLength(11)
        for value, label in quality_choices(self):
            self.quality.addItem(label, value)
        self._show_quality(context.preferences.quality)
        self.quality.activated.connect(lambda: views.set_quality(self.quality.currentData()))
        views.quality_changed.connect(self._show_quality)
        self._add_field(self.tr("Quality"), self.quality)
        space = QWidget(self)
        space.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.addWidget(space)
        self._add("compare.split")
        self.addSeparator()
        self._add("view.box", "view.axes", "view.reset_camera")
        self.addSeparator()
        self._add("file.copy_picture", "file.export_picture", "help.shortcuts")
        extension = self.findChild(QToolButton, "qt_toolbar_ext_button")
        if extension is not None:
            # Qt's own icon is hardly seen on the dark theme
            set_icon(extension, "caret-double-right")
            extension.setToolTip(self.tr("What the window has no room for"))

    def _add(self, *commands: str) -> None:
        self.addActions([self._table[ident] for ident in commands])

    def _add_field(self, words: str, field: QWidget) -> None:
        label = QLabel(words, self)
        label.setBuddy(field)
        label.setContentsMargins(8, 0, 4, 0)
        self.addWidget(label)
        self.addWidget(field)

    def _show_quality(self, quality: str) -> None:
        self.quality.setCurrentIndex(self.quality.findData(quality))
