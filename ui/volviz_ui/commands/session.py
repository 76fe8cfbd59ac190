"""Sessions in the window: open, save, and the offer to restore what a crash has left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QDateTime, QLocale, QObject, QStandardPaths
from PySide6.QtWidgets import QFileDialog, QMessageBox

from volviz.errors import VolvizError
from volviz.model.scene import Scene
from volviz.model.session import SUFFIX, save_session
from volviz.scene_volumes import load_scene
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Entry
from volviz_ui.session.autosave import Left, left_behind
from volviz_ui.session.loaded_scene import words_on_layers
from volviz_ui.session.opening import Opened
from volviz_ui.session.unsaved import UnsavedChanges

LAYER_WORDS_MS = 15000
"""How long it is said that something is not drawn."""


class SessionCommands(QObject):
    """Saves and restores the whole scene for the window."""

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._context = context
        self._folder: Path | None = None
        self._restoring: Path | None = None
        self._opening: Path | None = None
        self.unsaved = UnsavedChanges(context.store, self)
        context.documents.opened.connect(self._on_opened)
        context.documents.failed.connect(self._on_failed)
        self._filter = self.tr("VolViz sessions (*%1)").replace("%1", SUFFIX)

    # ------------------------------------------------------------------ opening

    def open_session(self) -> None:
        """Ask for a session file and open it."""
        path, _filter = QFileDialog.getOpenFileName(
            self._context.window, self.tr("Open a session"), self._context.preferences.folder_of("session"),
            self._filter,
        )  # fmt: skip
        if path:
            self._context.preferences.set_folder_of("session", path)
            self.unless_unsaved(partial(self.open_path, path))

    def open_path(self, path: str | Path) -> bool:
        """Open a session file, or a picture that carries one; False when it cannot be read (and that was reported)."""
        try:
            scene = load_scene(Path(path))
        except VolvizError as error:
            self._context.messages.show_error(
                self.tr("%1 was not opened").replace("%1", Path(path).name), error
            )
            return False
        missing = missing_file(scene)
        if missing:
            self._ask_where_it_is(scene, missing, Path(path))
        else:
            self._open_scene(scene, Path(path))
        return True

    def _open_scene(self, scene: Scene, path: Path) -> None:
        # what is saved next goes into the session file, never into a picture
        self._opening = path if path.name.lower().endswith(SUFFIX) else None
        self._context.documents.open_scene(scene)

    def _ask_where_it_is(self, scene: Scene, missing: str, path: Path) -> None:
        box = QMessageBox(self._context.window)
        box.setWindowTitle(self.tr("A volume is missing"))
        box.setText(self.tr("%1 is no longer where the session says.").replace("%1", Path(missing).name))
        box.setInformativeText(self.tr("It was in %1.").replace("%1", str(Path(missing).parent)))
        locate = box.addButton(self.tr("Locate…"), QMessageBox.ButtonRole.AcceptRole)
        box.addButton(QMessageBox.StandardButton.Cancel)
        box.setDefaultButton(locate)

        def decided() -> None:
            if box.clickedButton() is locate:
                self._locate(scene, missing, path)
            else:
                self._restoring = None
            box.deleteLater()

        box.finished.connect(decided)
        box.open()

    def _locate(self, scene: Scene, missing: str, path: Path) -> None:
        folder = str(self._context.preferences.folder)
        words = self.tr("Where is %1?").replace("%1", Path(missing).name)
        found, _filter = QFileDialog.getOpenFileName(self._context.window, words, folder)
        if not found:
            self._restoring = None
            return
        scene = relocated(scene, missing, found)
        again = missing_file(scene)
        if again:
            self._ask_where_it_is(scene, again, path)
        else:
            self._open_scene(scene, path)

    def _on_opened(self, opened: Opened) -> None:
        restored, self._restoring = self._restoring, None
        path, self._opening = self._opening, None
        if opened.scene is not None and restored is not None:
            # it is on the screen, but in no file of the user's
            restored.unlink(missing_ok=True)
        else:
            self.unsaved.keep(path if opened.scene is not None else None)
        words = "" if opened.scene is None else words_on_layers(opened.scene)
        if words:
            self._context.messages.show_status(words, LAYER_WORDS_MS)

    def _on_failed(self, _name: str, _error: object) -> None:
        self._restoring = self._opening = None

    # ------------------------------------------------------------------ saving

    def save_session(self) -> bool:
        """Save the scene in its session file; ask for one when it has none. Gives whether it was saved."""
        path = self.unsaved.path
        return self.save_session_as() if path is None else self.save_path(path)

    def save_session_as(self) -> bool:
        """Ask for a file and save the scene; gives whether it was saved."""
        layer = self._context.store.scene.layer
        if layer is None:
            return False
        preferences = self._context.preferences
        known = self.unsaved.path
        start = known or Path(preferences.folder_of("session")) / f"{file_stem(layer.name)}{SUFFIX}"
        path, _filter = QFileDialog.getSaveFileName(
            self._context.window, self.tr("Save the session"), str(start), self._filter
        )
        if not path:
            return False
        preferences.set_folder_of("session", path)
        return self.save_path(path if path.endswith(".json") else path + SUFFIX)

    def save_path(self, path: str | Path) -> bool:
        """Save the scene; False when it cannot be written (and that was reported)."""
        try:
            save_session(self._context.store.scene, path)
        except VolvizError as error:
            self._context.messages.show_error(self.tr("The session was not saved"), error)
            return False
        self.unsaved.keep(Path(path))
        self._context.messages.show_status(self.tr("Saved %1").replace("%1", Path(path).name), 5000)
        return True

    @property
    def must_ask(self) -> bool:
        """Whether unsaved changes must be asked about before they go."""
        return self.unsaved.there_are and self._context.preferences.asks_about_changes

    def unless_unsaved(self, go_on: Callable[[], object]) -> QMessageBox | None:
        """Go on at once, or ask what is to become of unsaved changes first.

        Parameters
        ----------
        go_on : callable
            Called when nothing is unsaved, and after "Save" and "Don't save"; not after "Cancel".
        """
        if not self.must_ask:
            go_on()
            return None
        layer = self._context.store.scene.layer
        box = QMessageBox(self._context.window)
        box.setWindowTitle("VolViz")
        box.setText(
            self.tr("Save what you changed about %1?").replace("%1", layer.name if layer else "VolViz")
        )
        box.setInformativeText(self.tr("A session file keeps colours, technique, cuts and views."))
        buttons = QMessageBox.StandardButton
        box.setStandardButtons(buttons.Save | buttons.Discard | buttons.Cancel)
        box.button(buttons.Discard).setText(self.tr("Don't save"))
        box.setDefaultButton(buttons.Save)

        def decided(answer: int) -> None:
            if answer == buttons.Discard or (answer == buttons.Save and self.save_session()):
                go_on()
            box.deleteLater()

        box.finished.connect(decided)
        box.open()
        return box

    # ------------------------------------------------------------------ after a crash

    def offer_restore(self, folder: Path) -> QMessageBox | None:
        """Offer the newest scene of a program that ended without closing; None when there is none.

        Its file stays until the scene is on the screen, or until it is thrown away: closing the question means later.
        """
        self._folder = folder
        found = left_behind(folder)
        if not found:
            return None
        left = found[0]
        box = QMessageBox(self._context.window)
        box.setWindowTitle("VolViz")
        box.setText(self.tr("VolViz did not end properly last time. Restore what was shown then?"))
        box.setInformativeText(self._words(left))
        restore = box.addButton(self.tr("Restore"), QMessageBox.ButtonRole.AcceptRole)
        later = box.addButton(self.tr("Later"), QMessageBox.ButtonRole.RejectRole)
        later.setToolTip(self.tr("File menu, Unsaved work"))
        discard = box.addButton(self.tr("Throw away"), QMessageBox.ButtonRole.DestructiveRole)
        box.setDefaultButton(restore)
        box.setEscapeButton(later)

        def decided() -> None:
            if box.clickedButton() is restore:
                self.restore(left.path)
            elif box.clickedButton() is discard:
                left.path.unlink(missing_ok=True)
            box.deleteLater()

        box.finished.connect(decided)
        box.open()
        return box

    def restore(self, path: Path) -> None:
        """Open what was left behind; its file goes when that has succeeded."""
        self._restoring = path
        if not self.open_path(path):
            self._restoring = None

    def left_entries(self) -> list[Entry]:
        """What was left behind, for a menu."""
        found = [] if self._folder is None else left_behind(self._folder)
        if not found:
            return [self.tr("Nothing was left behind by a crash")]
        return [
            *(
                Command(
                    f"file.restore.{left.path.name}", self._words(left).replace("&", "&&"),
                    self.tr("Open what was shown when the program ended"),
                    partial(self.unless_unsaved, partial(self.restore, left.path)),
                )
                for left in found
            ),
            None,
            Command(
                "file.restore.forget", self.tr("Throw all of it away"),
                self.tr("Delete what was kept after a crash"), partial(_delete, found),
            ),
        ]  # fmt: skip

    def _words(self, left: Left) -> str:
        when = self._context.window.locale().toString(QDateTime(left.when), QLocale.FormatType.ShortFormat)
        return f"{left.name or self.tr('Unknown volume')}, {when}"


def missing_file(scene: Scene) -> str:
    """Path of the first volume of a scene that is no longer there, empty when all are."""
    for layer in scene.layers:
        source = layer.key.ref.source
        if Path(source).is_absolute() and not Path(source).exists():
            return source
    return ""


def relocated(scene: Scene, missing: str, found: str) -> Scene:
    """The scene with a volume at another path; further missing ones are looked for beside it."""
    moved = {missing: found}
    for layer in scene.layers:
        source = layer.key.ref.source
        beside = Path(found).parent / Path(source).name
        if Path(source).is_absolute() and not Path(source).exists() and beside.exists():
            moved.setdefault(source, str(beside))
    layers = []
    for layer in scene.layers:
        ref = layer.key.ref
        source = moved.get(ref.source, ref.source)
        layers.append(replace(layer, volume=replace(ref, source=source)))
    return replace(scene, layers=tuple(layers))


def file_stem(name: str) -> str:
    """A name of a volume as that of a file."""
    kept = "".join(c if c.isalnum() or c in " -_()" else "_" for c in name).strip()
    return kept or "session"


def _delete(found: list[Left]) -> None:
    for left in found:
        left.path.unlink(missing_ok=True)


def autosave_folder() -> Path:
    """Where scenes are written for the case of a crash."""
    return Path(QStandardPaths.writableLocation(QStandardPaths.StandardLocation.AppDataLocation))
