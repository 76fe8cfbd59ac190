"""The Edit menu: undo, redo, preferences."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject
from PySide6.QtGui import QKeySequence

from volviz.volume_data.budgets import set_budgets
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Menu, State
from volviz_ui.commands.view import ViewCommands
from volviz_ui.dialogs.preferences import BUDGETS, PreferencesDialog


class EditCommands(QObject):
    """Goes back and forward in the history, and shows the preferences."""

    def __init__(self, context: AppContext, views: ViewCommands) -> None:
        super().__init__(context.window)
        self._context = context
        self._views = views

    def menu(self) -> Menu:
        """The table of its commands."""
        tr, documents = self.tr, self._context.documents
        return Menu(
            tr("&Edit"),
            [
                Command(
                    "edit.undo", self._undo_text, tr("Take back the last change"), documents.undo,
                    keys=(QKeySequence.StandardKey.Undo,), icon="arrow-u-up-left",
                    enabled=lambda state: state.undo is not None,
                ),
                Command(
                    "edit.redo", self._redo_text, tr("Do it again"), documents.redo, keys=("Ctrl+Y", "Ctrl+Shift+Z"),
                    icon="arrow-u-up-right", enabled=lambda state: state.redo is not None,
                ),
                None,
                Command(
                    "edit.preferences", tr("&Preferences…"), tr("Theme, quality and memory"), self.show_preferences,
                    keys=("Ctrl+,",), icon="gear",
                ),
            ],
        )  # fmt: skip

    def _undo_text(self, state: State) -> str:
        return _with_label(self.tr("&Undo"), state.undo)

    def _redo_text(self, state: State) -> str:
        return _with_label(self.tr("&Redo"), state.redo)

    def show_preferences(self) -> PreferencesDialog:
        """Open the preferences."""
        preferences = self._context.preferences
        dialog = PreferencesDialog(
            self._context.theme.choice,
            preferences.quality,
            asks=preferences.asks_about_changes,
            budgets={what: preferences.budget(what) for what in BUDGETS},
            parent=self._context.window,
        )
        dialog.asking_chosen.connect(lambda on: setattr(preferences, "asks_about_changes", on))
        dialog.theme_chosen.connect(self.set_theme)
        dialog.quality_chosen.connect(self._views.set_quality)
        dialog.budget_chosen.connect(self.set_budget)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def set_budget(self, what: str, count: int | None) -> None:
        """Allow a volume so many bytes of "memory" or "texture", None as the program sees fit."""
        self._context.preferences.set_budget(what, count)
        set_budgets(**{what: count})

    def set_theme(self, choice: Any) -> None:
        """Light, dark, or as the system."""
        self._context.preferences.theme = choice
        self._context.theme.choice = choice


def _with_label(words: str, label: str | None) -> str:
    return words if label is None else f"{words} “{label}”"
