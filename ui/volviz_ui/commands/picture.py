"""Pictures as files and on the clipboard, and how they are made in words, as a script or a command line."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QApplication, QFileDialog

from volviz.annotations.methods import methods_sentence
from volviz_ui.app_context import AppContext
from volviz_ui.commands.command import Command, has_volume
from volviz_ui.commands.session import file_stem
from volviz_ui.dialogs.export_image import ExportImageDialog
from volviz_ui.dialogs.job_progress import show_job
from volviz_ui.session.script import script_of
from volviz_ui.views.image_copy import ImageCopy
from volviz_ui.views.image_export import ImageExport
from volviz_ui.views.picture_parts import PictureRequest, caption_of, parts_of, size_on_screen

IMAGES = "PNG (*.png);;TIFF (*.tif *.tiff);;JPEG (*.jpg *.jpeg);;SVG (*.svg);;PDF (*.pdf)"


class PictureCommands(QObject):
    """Exports and copies for the window."""

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._context = context
        self._jobs: list[ImageExport | ImageCopy] = []

    def export_commands(self) -> list[Command]:
        """What belongs among the exports of a menu."""
        tr = self.tr
        return [
            Command(
                "file.export_picture", tr("&Export picture…"), tr("Draw the picture at any size into a file"),
                self.export_image, keys=("Ctrl+E",), icon="export", enabled=has_volume,
            ),
        ]  # fmt: skip

    def copy_commands(self) -> list[Command]:
        """What puts something on the clipboard."""
        tr = self.tr
        return [
            Command(
                "file.copy_picture", tr("&Copy picture"), tr("Put what the window shows on the clipboard"),
                self.copy_image, keys=("Ctrl+Shift+C",), icon="copy", enabled=has_volume,
            ),
            Command(
                "file.copy_script", tr("Copy as P&ython"), tr("Put a script that draws this picture on the clipboard"),
                self.copy_script, icon="code", enabled=has_volume,
            ),
            Command(
                "file.copy_methods", tr("Copy for the &methods section"),
                tr("Put a sentence on how this picture is made on the clipboard"), self.copy_methods,
                enabled=has_volume,
            ),
        ]  # fmt: skip

    # ------------------------------------------------------------------ files

    def export_image(self) -> ExportImageDialog | None:
        """Ask for view, size and contents, then for the file, and draw."""
        views, scene = self._context.views, self._context.documents.shown.scene
        if self._context.documents.volume is None:
            return None
        seen = [view_widget.view for view_widget in views.shown_view_widgets]
        choices: list[tuple[int | None, str]] = [(scene.active_index, self.tr("The active view"))]
        if len(seen) > 1:
            choices = [(None, self.tr("All views, as one picture"))]
            choices += [(view, f"{view + 1}  {caption_of(scene, view)}") for view in seen]
        dialog = ExportImageDialog(
            choices,
            lambda view: size_on_screen(views, view),
            views.active.annotations.contents,
            self._context.window,
        )
        dialog.accepted.connect(lambda: self._ask_where(dialog.request))
        dialog.methods_wanted.connect(lambda: self.copy_methods(dialog.request))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def _ask_where(self, request: PictureRequest) -> None:
        layer, preferences = self._context.store.scene.layer, self._context.preferences
        name = file_stem(layer.name) if layer is not None else "volviz"
        start = str(Path(preferences.folder_of("picture")) / f"{name}.png")
        path, _filter = QFileDialog.getSaveFileName(
            self._context.window, self.tr("Save the picture"), start, IMAGES
        )
        if path:
            preferences.set_folder_of("picture", path)
            self.save_image(path, request)

    def save_image(self, path: str, request: PictureRequest) -> ImageExport | None:
        """Draw the scene and save it, with progress and cancel, while the window goes on."""
        context, shown = self._context, self._context.documents.shown
        if shown.volume is None:
            return None
        parts = parts_of(context.views, shown.scene, request)
        widgets = [context.views.view_widgets[part.view] for part in parts]
        handles = [view_widget.controller.handle for view_widget in widgets]
        export = ImageExport(
            shown,
            path,
            request,
            parts,
            [view_widget.annotations.subject() for view_widget in widgets],
            [None if handle is None else handle.surface_colors for handle in handles],
            context.workers,
            self,
        )
        name = Path(export.path).name
        messages = context.messages
        export.saved.connect(lambda _path: messages.show_status(self.tr("Saved %1").replace("%1", name)))
        export.failed.connect(lambda error: messages.show_error(self.tr("The picture was not saved"), error))
        self._follow(export, self.tr("Export picture"), self.tr("Drawing %1…").replace("%1", name))
        return export

    def _follow(self, job: ImageExport | ImageCopy, title: str, words: str) -> None:
        """Start a job, show how far it is, and forget it when it has ended."""
        self._jobs.append(job)
        show_job(self._context.window, job, title, words)

        def forget() -> None:
            self._jobs.remove(job)
            job.deleteLater()

        job.ended.connect(forget)
        job.start()

    def close(self) -> None:
        """Give up what is being exported or copied, before the window goes."""
        for job in list(self._jobs):
            job.cancel()

    # ------------------------------------------------------------------ clipboard

    def copy_image(self) -> ImageCopy:
        """Put what is shown, all views of a comparison included, on the clipboard once it is complete."""
        copy = ImageCopy(self._context.views, self)
        copy.copied.connect(lambda: self._tell(self.tr("The picture is on the clipboard")))
        self._follow(copy, self.tr("Copy picture"), self.tr("Completing the picture…"))
        return copy

    def copy_script(self) -> None:
        """Put a script that draws the same on the clipboard."""
        script = script_of(self._context.store.scene, self._context.views.first.viewport.pixel_size)
        QApplication.clipboard().setText(script)
        self._tell(self.tr("The script is on the clipboard"))

    def copy_methods(self, request: PictureRequest | None = None) -> None:
        """Put a sentence on how the picture is made on the clipboard: of the active view, or of a request."""
        views = self._context.views
        view_widget = (
            views.active if request is None or request.view is None else views.view_widgets[request.view]
        )
        handle, size = view_widget.controller.handle, view_widget.viewport.pixel_size
        if handle is None:
            return
        sentence = methods_sentence(
            handle.resolved, view_widget.viewport.view_camera, size if request is None else request.size
        )
        QApplication.clipboard().setText(sentence)
        self._tell(self.tr("The sentence is on the clipboard"))

    def _tell(self, words: str) -> None:
        self._context.messages.show_status(words, 3000)
