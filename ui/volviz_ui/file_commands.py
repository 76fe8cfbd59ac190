"""What the File menu does: open, import, export, copy."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QApplication, QFileDialog, QProgressDialog

from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.model.scene import Scene
from volviz.model.session import SUFFIX as SESSION_SUFFIX
from volviz.model.volume import Volume
from volviz_ui.dialogs.error import show_error
from volviz_ui.dialogs.export_mesh import ExportMeshDialog
from volviz_ui.dialogs.export_picture import ExportPictureDialog
from volviz_ui.dialogs.raw_import import RawImportDialog, hints_from_name, is_raw
from volviz_ui.picture_export import PictureExport
from volviz_ui.script import script_of
from volviz_ui.surface import shows_mesh
from volviz_ui.views.scenery import background_picture

if TYPE_CHECKING:
    from volviz_ui.main_window import MainWindow

PICTURES = "PNG (*.png);;TIFF (*.tif *.tiff);;JPEG (*.jpg *.jpeg)"
STEPS = 1000
"""Of the bar that shows the progress of an export."""
QUICK_MS = 400
"""Exports that are done sooner show no progress."""


class FileCommands(QObject):
    """Opens and saves for the window."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._exports: list[PictureExport] = []

    def open_file(self) -> None:
        """Ask for a file and open it."""
        from volviz.io import file_dialog_filters

        path, _filter = QFileDialog.getOpenFileName(
            self._window,
            self.tr("Open a volume"),
            self._window.preferences.folder,
            ";;".join(file_dialog_filters()),
        )
        if path:
            self.open_path(path)

    def open_folder(self) -> None:
        """Ask for a folder of DICOM files and open it."""
        path = QFileDialog.getExistingDirectory(
            self._window, self.tr("Open a folder of DICOM files"), self._window.preferences.folder
        )
        if path:
            self.open_path(path)

    def import_raw(self) -> None:
        """Ask for a raw file, then for how to read it."""
        path, _filter = QFileDialog.getOpenFileName(
            self._window,
            self.tr("Import a raw file"),
            self._window.preferences.folder,
            self.tr("Raw files (*.raw *.raw.gz *.bin *.vol);;All files (*)"),
        )
        if path:
            self.ask_how_to_read(path)

    def open_path(self, path: str) -> None:
        """Open a file, folder or session; for a raw file whose name does not say enough, ask first."""
        self._window.preferences.folder = str(Path(path).parent)
        if path.endswith(SESSION_SUFFIX):
            self._window.session_commands.open_path(path)
        elif is_raw(path) and Path(path).is_file() and len(hints_from_name(path)) < 2:
            self.ask_how_to_read(path)
        else:
            self._window.documents.open(path)

    def ask_how_to_read(self, path: str) -> RawImportDialog:
        """Open the dialog for raw files; the file is opened when it is accepted."""
        dialog = RawImportDialog(path, self._window)
        dialog.accepted.connect(lambda: self._window.documents.open(path, **dialog.hints))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

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

    def export_picture(self) -> ExportPictureDialog | None:
        """Ask for the size, then for the file, and draw."""
        if self._window.documents.volume is None:
            return None
        dialog = ExportPictureDialog(self._window.viewport.pixel_size, self._window)
        dialog.accepted.connect(
            lambda: self._ask_where(dialog.picture_size, transparent=dialog.transparent.isChecked())
        )
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def _ask_where(self, size: tuple[int, int], *, transparent: bool) -> None:
        start = str(Path(self._window.preferences.folder) / "volviz.png")
        path, _filter = QFileDialog.getSaveFileName(
            self._window, self.tr("Save the picture"), start, PICTURES
        )
        if path:
            self.save_picture(path, size, transparent=transparent)

    def save_picture(self, path: str, size: tuple[int, int], *, transparent: bool) -> PictureExport | None:
        """Draw the scene at a size and save it, with progress and cancel, while the window goes on."""
        volume = self._window.documents.volume
        if volume is None:
            return None
        handle = self._window.views.active.display.handle
        export = PictureExport(
            self._window.store.scene,
            volume,
            path,
            size,
            transparent=transparent,
            workers=self._window.workers,
            surface_colors=None if handle is None else handle.surface_colors,
            parent=self,
        )
        name = Path(export.path).name
        dialog = QProgressDialog(self._window)
        dialog.setWindowTitle(self.tr("Export picture"))
        dialog.setLabelText(self.tr("Drawing %1…").replace("%1", name))
        dialog.setCancelButtonText(self.tr("Cancel"))
        dialog.setAccessibleName(self.tr("Progress of the export"))
        dialog.setRange(0, STEPS)
        dialog.setAutoClose(False)
        dialog.setAutoReset(False)
        dialog.setMinimumDuration(QUICK_MS)
        dialog.setValue(0)
        dialog.canceled.connect(export.cancel)
        export.progressed.connect(lambda part: dialog.setValue(round(part * STEPS)))
        export.saved.connect(
            lambda _path: self._window.status_line.showMessage(self.tr("Saved %1").replace("%1", name), 5000)
        )
        export.failed.connect(
            lambda error: show_error(self._window, self.tr("The picture was not saved"), error)
        )
        self._exports.append(export)

        def forget() -> None:
            self._exports.remove(export)
            dialog.canceled.disconnect(export.cancel)
            dialog.close()
            dialog.deleteLater()
            export.deleteLater()

        export.ended.connect(forget)
        export.start()
        return export

    def close(self) -> None:
        """Give up what is being exported, before the window goes."""
        for export in list(self._exports):
            export.cancel()

    def export_mesh(self) -> ExportMeshDialog | None:
        """Ask for format and file, and write the mesh that is shown; None where there is none."""
        facts = self._window.surface.facts
        if facts is None or not facts.metrics.faces or not shows_mesh(self._window.store.scene):
            return None
        dialog = ExportMeshDialog(facts, self._window.workers, self._window.preferences.folder, self._window)
        dialog.saved.connect(self._on_mesh_saved)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def _on_mesh_saved(self, path: str) -> None:
        self._window.preferences.folder = str(Path(path).parent)
        self._window.status_line.showMessage(self.tr("Saved %1").replace("%1", Path(path).name), 5000)

    def copy_picture(self) -> None:
        """Put what is shown, all views of a comparison included, on the clipboard."""
        views = self._window.views
        # knobs belong to the window, not to the picture
        shown, views.shows_handles = views.shows_handles, False
        views.complete()
        several = len(views.panes) > 1
        image = views.grab().toImage() if several else self._window.viewport.grabFramebuffer()
        QApplication.clipboard().setImage(image)
        views.shows_handles = shown
        self._window.status_line.showMessage(self.tr("The picture is on the clipboard"), 3000)

    def copy_script(self) -> None:
        """Put a script that draws the same on the clipboard."""
        script = script_of(self._window.store.scene, self._window.viewport.pixel_size)
        QApplication.clipboard().setText(script)
        self._window.status_line.showMessage(self.tr("The script is on the clipboard"), 3000)


def drawn_picture(scene: Scene, volume: Volume, size: tuple[int, int], *, transparent: bool) -> np.ndarray:
    """What the scene shows, drawn anew.

    Parameters
    ----------
    size : tuple of 2 ints
        Width and height in pixels.
    transparent : bool
        Without the background of the viewport.

    Returns
    -------
    ndarray of shape (H, W, 4), uint8
        Red, green, blue, straight alpha; row 0 at the top.
    """
    from volviz.renderer import render

    picture = render(
        volume,
        current_technique(scene).id,
        transfer_function=scene.layer.transfer_function if scene.layer else None,
        size=size,
        camera=scene.view.camera,
        dtype="float32",
        settings=current_settings(scene),
        light=scene.light,
        clipping=scene.clipping,
    )
    if not transparent:
        alpha = picture[..., 3:]
        behind = background_picture(scene.background, size)
        picture[..., :3] = picture[..., :3] * alpha + (1 - alpha) * behind
        picture[..., 3] = 1.0
    return np.rint(np.clip(picture, 0, 1) * 255).astype(np.uint8)
