"""Sessions in the window: open, save, and the offer to restore what a crash has left."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QStandardPaths
from PySide6.QtWidgets import QFileDialog, QMessageBox

from volviz.custom_gl.registry import techniques
from volviz.errors import VolvizError
from volviz.model.session import SUFFIX, load_session, save_session
from volviz_ui.app_context import AppContext
from volviz_ui.session.autosave import left_behind
from volviz_ui.session.loaded_scene import words_on_layers
from volviz_ui.session.opening import Opened

LAYER_WORDS_MS = 15000
"""How long it is said that something is not drawn."""


class SessionCommands(QObject):
    """Saves and restores the whole scene for the window."""

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._context = context
        context.documents.opened.connect(self._on_opened)
        self._filter = self.tr("VolViz sessions (*%1)").replace("%1", SUFFIX)

    def open_session(self) -> None:
        """Ask for a session file and open it."""
        path, _filter = QFileDialog.getOpenFileName(
            self._context.window, self.tr("Open a session"), self._context.preferences.folder, self._filter
        )
        if path:
            self.open_path(path)

    def open_path(self, path: str | Path) -> bool:
        """Open a session file; False when it cannot be read (and that was reported)."""
        try:
            scene = load_session(path, settings_of)
        except VolvizError as error:
            self._context.messages.show_error(
                self.tr("%1 was not opened").replace("%1", Path(path).name), error
            )
            return False
        self._context.documents.open_scene(scene)
        return True

    def _on_opened(self, opened: Opened) -> None:
        words = "" if opened.scene is None else words_on_layers(opened.scene)
        if words:
            self._context.messages.show_status(words, LAYER_WORDS_MS)

    def save_session(self) -> None:
        """Ask for a file and save the scene."""
        if self._context.store.scene.layer is None:
            return
        start = str(Path(self._context.preferences.folder) / f"session{SUFFIX}")
        path, _filter = QFileDialog.getSaveFileName(
            self._context.window, self.tr("Save the session"), start, self._filter
        )
        if path:
            self.save_path(path if path.endswith(".json") else path + SUFFIX)

    def save_path(self, path: str | Path) -> bool:
        """Save the scene; False when it cannot be written (and that was reported)."""
        try:
            save_session(self._context.store.scene, path)
        except VolvizError as error:
            self._context.messages.show_error(self.tr("The session was not saved"), error)
            return False
        self._context.messages.show_status(self.tr("Saved %1").replace("%1", Path(path).name), 5000)
        return True

    def offer_restore(self, folder: Path) -> QMessageBox | None:
        """Offer the scene of a program that ended without closing; None when there is none."""
        path = left_behind(folder)
        if path is None:
            return None
        box = QMessageBox(self._context.window)
        box.setWindowTitle("VolViz")
        box.setText(self.tr("VolViz did not end properly last time. Restore what was shown then?"))
        restore = box.addButton(self.tr("Restore"), QMessageBox.ButtonRole.AcceptRole)
        box.addButton(self.tr("Discard"), QMessageBox.ButtonRole.RejectRole)
        box.setDefaultButton(restore)

        def decided() -> None:
            if box.clickedButton() is restore:
                self.open_path(path)
            path.unlink(missing_ok=True)
            box.deleteLater()

        box.finished.connect(decided)
        box.open()
        return box


def settings_of(technique: str) -> type[Any] | None:
    """Settings class of a technique, None when there is no such technique."""
    info = techniques().get(technique)
    return None if info is None else info.settings


def autosave_folder() -> Path:
    """Where scenes are written for the case of a crash."""
    return Path(QStandardPaths.writableLocation(QStandardPaths.StandardLocation.AppDataLocation))
