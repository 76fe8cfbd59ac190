"""The File menu: open, import, export, copy, quit."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QFileDialog

from volviz.scene_volumes import holds_scene
from volviz.volume_data.array_source import ArraySource
from volviz.volume_data.references import SAMPLE_PREFIX, VolumeKey, is_address
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, Entry, Menu, has_volume
from volviz_ui.commands.picture import PictureCommands
from volviz_ui.commands.session import SessionCommands
from volviz_ui.dialogs.choose_entry import ChooseEntryDialog
from volviz_ui.dialogs.export_mesh import ExportMeshDialog
from volviz_ui.dialogs.open_address import OpenAddressDialog
from volviz_ui.dialogs.raw_import import RawImportDialog, is_raw, says_all
from volviz_ui.dialogs.save_volume import SaveVolumeDialog
from volviz_ui.dialogs.understood import CORRECTED, UnderstoodDialog
from volviz_ui.library_words import translated
from volviz_ui.session.mesh_summary import shows_mesh
from volviz_ui.session.opening import SeveralImages, title_of


class FileCommands(QObject):
    """Opens and saves for the window."""

    def __init__(self, context: AppContext, sessions: SessionCommands, pictures: PictureCommands) -> None:
        super().__init__(context.window)
        self._context = context
        self._sessions, self._pictures = sessions, pictures
        context.documents.choice_needed.connect(self.choose_entry)

    def menu(self) -> Menu:
        """The table of its commands."""
        standard = QKeySequence.StandardKey
        tr = self.tr
        self.recent = Menu(tr("Open &recent"), self._recent, "clock-counter-clockwise")
        self.samples = Menu(tr("&Samples"), self._samples, "cube")
        return Menu(
            tr("&File"),
            [
                Command(
                    "file.open", tr("&Open…"), tr("Open a volume from a file"), self.open_file,
                    keys=(standard.Open,), icon="folder-open",
                ),
                Command(
                    "file.open_folder", tr("Open &folder…"),
                    tr("Open a folder: a DICOM series, a Zarr store, numbered pictures"), self.open_folder,
                    keys=("Ctrl+Shift+O",), icon="folder",
                ),
                Command(
                    "file.open_address", tr("Open from &URL…"), tr("Open a file or a Zarr store on the network"),
                    self.ask_for_address, keys=("Ctrl+L",), icon="globe",
                ),
                Command(
                    "file.add_layer", tr("Add &layer…"), tr("Show another file in the same picture"), self.add_layer,
                    keys=("Ctrl+Shift+A",), icon="stack", enabled=has_volume,
                ),
                self.recent,
                self.samples,
                Command(
                    "file.import_raw", tr("&Import raw file…"), tr("Open a file of bare values; say how to read it"),
                    self.import_raw, icon="file",
                ),
                Command(
                    "file.understood", tr("&What was understood…"),
                    tr("Axes, spacing and units of the file, to be corrected where they are wrong"),
                    self.show_understood, enabled=has_volume,
                ),
                None,
                Command(
                    "file.open_session", tr("Open &session…"),
                    tr("Restore a whole scene: volume, colours, technique, camera"), self._sessions.open_session,
                ),
                Command(
                    "file.save_session", tr("Sa&ve session"), tr("Save the whole scene, to go on another day"),
                    self._sessions.save_session, keys=(standard.Save,), icon="floppy-disk", enabled=has_volume,
                ),
                Command(
                    "file.save_session_as", tr("Save session &as…"), tr("Save the whole scene in another file"),
                    self._sessions.save_session_as, keys=("Ctrl+Shift+S",), enabled=has_volume,
                ),
                Menu(tr("&Unsaved work"), self._sessions.left_entries),
                None,
                Command(
                    "file.save_volume", tr("Save vo&lume…"),
                    tr("Write the volume, or a part of it, to a file of another format"), self.save_volume,
                    icon="floppy-disk", enabled=has_volume,
                ),
                *self._pictures.export_commands(),
                Command(
                    "file.export_mesh", tr("Export &mesh…"),
                    tr("Write the mesh that marching cubes or tetrahedra show to a file"), self.export_mesh,
                    keys=("Ctrl+Shift+E",), icon="export",
                    enabled=lambda state: state.triangles > 0 and shows_mesh(state.scene),
                ),
                *self._pictures.copy_commands(),
                None,
                Command(
                    "file.quit", tr("&Quit"), tr("Close the window"), self._context.window.close, keys=(standard.Quit,)
                ),
            ],
        )  # fmt: skip

    def _recent(self) -> list[Entry]:
        preferences, tr = self._context.preferences, self.tr
        keys = preferences.recent
        if not keys:
            return [tr("Nothing opened yet")]
        entries: list[Entry] = [
            Command(
                f"file.recent.{key.ref.source}",
                _literal(title_of(key.ref)),
                key.ref.source,
                partial(self._open_again, key),
            )
            for key in keys
        ]
        forget = tr("Forget which files were opened")
        return [
            *entries,
            None,
            Command("file.recent.forget", tr("Clear this list"), forget, preferences.forget_recent),
        ]

    def _samples(self) -> list[Command]:
        from volviz.io.samples import samples

        return [
            Command(
                f"file.sample.{sample.id}", _literal(translated(sample.label)),
                f"{translated(sample.description)}\n{sample.licence}", partial(self._open, SAMPLE_PREFIX + sample.id),
            )
            for sample in samples()
        ]  # fmt: skip

    def _open_again(self, key: VolumeKey) -> None:
        hints = dict(key.ref.hints)
        self._open(key.ref.source, channel=key.channel, time=key.time, **hints)

    def _open(self, source: str, **how: Any) -> None:
        """Show another volume, once nothing unsaved is in its way."""
        self._sessions.unless_unsaved(partial(self._context.documents.open, source, **how))

    # ------------------------------------------------------------------ opening

    def open_file(self) -> None:
        """Ask for a file and open it."""
        from volviz.io import file_dialog_filters

        path, _filter = QFileDialog.getOpenFileName(
            self._context.window,
            self.tr("Open a volume"),
            self._context.preferences.folder,
            ";;".join(file_dialog_filters()),
        )
        if path:
            self.open_path(path)

    def add_layer(self) -> None:
        """Ask for a file and show it beside what is there."""
        from volviz.io import file_dialog_filters

        path, _filter = QFileDialog.getOpenFileName(
            self._context.window,
            self.tr("Add a layer"),
            self._context.preferences.folder,
            ";;".join(file_dialog_filters()),
        )
        if path:
            self._context.preferences.folder = str(Path(path).parent)
            self._context.documents.add(path)

    def open_folder(self) -> None:
        """Ask for a folder and open it: DICOM files, a Zarr store, numbered pictures."""
        path = QFileDialog.getExistingDirectory(
            self._context.window, self.tr("Open a folder"), self._context.preferences.folder
        )
        if path:
            self.open_path(path)

    def ask_for_address(self) -> OpenAddressDialog:
        """Ask for a URL and open it."""
        dialog = OpenAddressDialog(self._context.window)
        dialog.accepted.connect(lambda: self._context.documents.open(dialog.address))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def choose_entry(self, several: SeveralImages) -> ChooseEntryDialog:
        """Ask which of the images of a file is meant, and go on opening it."""
        key, documents = several.key, self._context.documents
        dialog = ChooseEntryDialog(title_of(key.ref), several.entries, self._context.window)

        def go_on() -> None:
            if dialog.entry is None:
                return
            hints = {**dict(key.ref.hints), "series": dialog.entry.name}
            if several.adds:
                documents.add(key.ref.source, **hints)
            else:
                documents.open(key.ref.source, channel=key.channel, time=key.time, **hints)

        dialog.accepted.connect(go_on)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def import_raw(self) -> None:
        """Ask for a raw file, then for how to read it."""
        path, _filter = QFileDialog.getOpenFileName(
            self._context.window,
            self.tr("Import a raw file"),
            self._context.preferences.folder,
            self.tr("Raw files (*.raw *.raw.gz *.bin *.vol);;All files (*)"),
        )
        if path:
            self.ask_how_to_read(path)

    def open_path(self, path: str) -> None:
        """Open a file, folder, URL or session; for a raw file whose name does not say enough, ask first."""
        if is_address(path):
            self._context.documents.open(path)
            return
        self._context.preferences.folder = str(Path(path).parent)
        if holds_scene(Path(path)):
            self._sessions.unless_unsaved(partial(self._sessions.open_path, path))
        elif is_raw(path) and Path(path).is_file() and not says_all(path):
            self.ask_how_to_read(path)
        else:
            self._open(path)

    def show_understood(self) -> UnderstoodDialog | None:
        """Show axes, spacing and units of the active layer's file; they can be corrected."""
        documents, preferences = self._context.documents, self._context.preferences
        layer, volume = documents.shown.scene.layer, documents.volume
        if layer is None or volume is None:
            return None
        ref = layer.key.ref
        dialog = UnderstoodDialog(
            volume, dict(ref.hints), remembers=bool(preferences.correction(ref)), parent=self._context.window
        )

        def correct(hints: dict[str, Any], remember: bool) -> None:
            preferences.set_correction(ref, hints if remember else {})
            documents.correct(hints, CORRECTED)

        dialog.corrected.connect(correct)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def ask_how_to_read(self, path: str) -> RawImportDialog:
        """Open the dialog for raw files; the file is opened when it is accepted."""
        dialog = RawImportDialog(path, self._context.workers, self._context.window)
        dialog.accepted.connect(lambda: self._open(path, **dialog.hints))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def add_dropped(self, paths: list[str]) -> None:
        """Show what was dropped with Shift beside what is there."""
        if paths:
            self._context.documents.add(paths[0])

    def open_dropped(self, paths: list[str]) -> None:
        """Open what was dropped: one file or folder; of several files of one folder, the folder."""
        if (
            len(paths) > 1
            and len({str(Path(path).parent) for path in paths}) == 1
            and Path(paths[0]).is_file()
        ):
            suffixes = {Path(path).suffix.lower() for path in paths}
            if suffixes <= {".dcm", ".ima", ""}:
                self.open_path(str(Path(paths[0]).parent))
                return
        if paths:
            self.open_path(paths[0])

    def save_volume(self) -> SaveVolumeDialog | None:
        """Ask for format, part and file, and write the volume; None where there is none."""
        documents = self._context.documents
        volume, source, layer = documents.volume, documents.source, documents.shown.scene.layer
        if volume is None or layer is None:
            return None
        dialog = SaveVolumeDialog(
            source or ArraySource(volume), volume, layer.channel, layer.time, documents.shown.scene.clipping.crop,
            self._context.workers, self._context.preferences.folder_of("volume"), self._context.window,
        )  # fmt: skip
        dialog.saved.connect(partial(self._on_file_saved, "volume"))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def export_mesh(self) -> ExportMeshDialog | None:
        """Ask for format and file, and write the mesh that is shown; None where there is none."""
        summary = self._context.surface.summary
        if summary is None or not summary.metrics.faces or not shows_mesh(self._context.store.scene):
            return None
        folder = self._context.preferences.folder_of("mesh")
        dialog = ExportMeshDialog(summary, self._context.workers, folder, self._context.window)
        dialog.saved.connect(partial(self._on_file_saved, "mesh"))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def _on_file_saved(self, what: str, path: str) -> None:
        self._context.preferences.set_folder_of(what, path)
        self._context.messages.show_status(self.tr("Saved %1").replace("%1", Path(path).name), 5000)


def _literal(name: str) -> str:
    """A name for a menu: no letter of it is a mark."""
    return name.replace("&", "&&")
