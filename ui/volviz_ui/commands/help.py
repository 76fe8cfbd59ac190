"""The Help menu: find a command, keys and mouse, about."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject

from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu
from volviz_ui.commands.palette import CommandPalette
from volviz_ui.commands.shortcuts import ShortcutsDialog
from volviz_ui.commands.table import CommandTable
from volviz_ui.dialogs.about import AboutDialog


class HelpCommands(QObject):
    """Finds commands, and says what this program is."""

    def __init__(self, context: AppContext, table: CommandTable) -> None:
        super().__init__(context.window)
        self._context = context
        self._table = table

    def menu(self) -> Menu:
        """The table of its commands."""
        tr = self.tr
        return Menu(
            tr("&Help"),
            [
                Command(
                    "help.palette", tr("&Find a command…"), tr("All commands, techniques, samples and presets by name"),
                    self.show_palette, keys=("Ctrl+Shift+P",), icon="magnifying-glass",
                ),
                Command(
                    "help.shortcuts", tr("&Shortcuts"), tr("Keys and mouse"), self.show_shortcuts, keys=("?", "F1"),
                    icon="keyboard",
                ),
                Command("help.about", tr("&About VolViz"), tr("Version and licence"), self.show_about, icon="info"),
            ],
        )  # fmt: skip

    def show_palette(self) -> CommandPalette:
        """Open the command palette."""
        palette = CommandPalette(self._table, self._context.preferences, self._context.window)
        palette.open()
        return palette

    def show_shortcuts(self) -> ShortcutsDialog:
        """Open the page of shortcuts."""
        # what would be taken back just now belongs to the menu
        no_history = replace(self._table.state, undo=None, redo=None)
        dialog = ShortcutsDialog(self._table.walk(), no_history, self._context.window)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def show_about(self) -> AboutDialog:
        """Say what this program is."""
        dialog = AboutDialog(self._opengl(), self._context.window)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def _opengl(self) -> str:
        window = self._context.views.first.viewport.render_window
        if window is None:
            return ""
        lines = window.ReportCapabilities().splitlines()
        found = [line.split(":", 1)[1].strip() for line in lines if line.startswith("OpenGL renderer")]
        return found[0] if found else ""
