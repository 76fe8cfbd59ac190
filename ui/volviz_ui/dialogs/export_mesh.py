"""Exporting the mesh in the image: format and file, written on a worker with progress and cancel."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QLabel, QWidget

from volviz.meshes.files import FORMAT_NAMES, check_mesh_target, save_mesh
from volviz_ui.dialogs.writing_dialog import WritingDialog
from volviz_ui.session.mesh_summary import MeshSummary
from volviz_ui.session.workers import Workers
from volviz_ui.widgets.small import quiet_label

NAME = "surface"


class ExportMeshDialog(WritingDialog):
    """Asks for the format and the file, writes, and closes when that is done.

    Parameters
    ----------
    summary : MeshSummary
        What is written.
    workers : Workers
        Who writes it.
    folder : str
        Where the choice of a file begins.
    """

    def __init__(
        self, summary: MeshSummary, workers: Workers, folder: str, parent: QWidget | None = None
    ) -> None:
        super().__init__(workers, self.tr("Export mesh"), self.tr("The mesh was not saved"), parent)
        self._summary = summary
        self._folder = folder
        for ending, name in FORMAT_NAMES.items():
            self.format.addItem(f"{name} ({ending})", ending)
        low, high = summary.polydata.points.min(axis=0), summary.polydata.points.max(axis=0)
        size = " × ".join(f"{length:.4g}" for length in high - low)
        for label, words, tooltip in (
            (self.tr("Triangles"), f"{summary.metrics.faces:,}".replace(",", " "), self.tr("As shown")),
            (
                self.tr("Extent"),
                f"{size} {summary.length_unit}",
                self.tr("Length of the mesh along x, y, z of the world"),
            ),
        ):
            value = QLabel(words, self)
            value.setToolTip(tooltip)
            self.form.addRow(label, value)
        hint: QLabel = quiet_label(
            self.tr(
                "The mesh is written as it is shown, filters included, in world coordinates (left, posterior, "
                "superior). Crop box and clip planes do not cut it."
            )
        )
        self.lay_out(hint, 420)

    def ask_where(self) -> None:
        """Ask for the file, then write it."""
        ending = self.format.currentData()
        path, _filter = QFileDialog.getSaveFileName(
            self,
            self.tr("Save the mesh"),
            str(Path(self._folder) / (NAME + ending)),
            f"{FORMAT_NAMES[ending]} (*{ending})",
        )
        if not path:
            return
        if Path(path).suffix.lower() not in FORMAT_NAMES:
            path += ending
            # the dialog asked about the name without the ending
            if Path(path).exists() and not self.may_overwrite(path):
                return
        self.save(path)

    def save(self, path: str) -> None:
        """Write the mesh on a worker; the dialog stays until that is done."""
        if self._task is not None:
            return
        try:
            check_mesh_target(path)
        except Exception as error:  # noqa: BLE001 - told in the dialog's own words
            self.show_failure(error)
            return
        mesh = self._summary.polydata
        self.write(
            path,
            lambda task: save_mesh(mesh, path, progress=task.report, cancel=lambda: task.is_cancelled),
            told=lambda note: note or "",
        )
