"""Exporting the mesh in the image: format and file, written on a worker with progress and cancel."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QLabel,
    QMessageBox,
    QVBoxLayout,
    QWidget,
)

from volviz.meshes.files import FORMAT_NAMES, check_mesh_target, save_mesh
from volviz_ui.dialogs.error import show_error
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.session.mesh_summary import MeshSummary
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.progress_bar import ProgressBar
from volviz_ui.widgets.small import quiet_label

NAME = "surface"


class ExportMeshDialog(QDialog):
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

    saved = Signal(str)
    """Path of the file that was written."""

    def __init__(
        self, summary: MeshSummary, workers: Workers, folder: str, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Export mesh"))
        self._summary = summary
        self._workers = workers
        self._folder = folder
        self._task: Task | None = None
        self.format = NoWheelComboBox(self)
        self.format.setToolTip(self.tr("Which kind of file"))
        self.format.setAccessibleName(self.tr("Format"))
        for ending, name in FORMAT_NAMES.items():
            self.format.addItem(f"{name} ({ending})", ending)
        low, high = summary.polydata.points.min(axis=0), summary.polydata.points.max(axis=0)
        size = " × ".join(f"{length:.4g}" for length in high - low)
        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.setVerticalSpacing(8)
        form.addRow(self.tr("Format"), self.format)
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
            form.addRow(label, value)
        hint: QLabel = quiet_label(
            self.tr(
                "The mesh is written as it is shown, filters included, in world coordinates (left, posterior, "
                "superior). Crop box and clip planes do not cut it."
            )
        )
        hint.setWordWrap(True)
        self.bar = ProgressBar(self)
        self.bar.setAccessibleName(self.tr("Progress"))
        keeps = self.bar.sizePolicy()
        keeps.setRetainSizeWhenHidden(True)
        self.bar.setSizePolicy(keeps)
        self.bar.hide()
        self.buttons = QDialogButtonBox(self)
        self.save_button = self.buttons.addButton(self.tr("Save as…"), QDialogButtonBox.ButtonRole.AcceptRole)
        self.save_button.setToolTip(self.tr("Choose a file"))
        cancel = self.buttons.addButton(QDialogButtonBox.StandardButton.Cancel)
        cancel.setToolTip(self.tr("Stop writing, or close"))
        self.buttons.accepted.connect(self.ask_where)
        self.buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 20, 24, 16)
        layout.setSpacing(12)
        layout.addLayout(form)
        layout.addWidget(hint)
        layout.addWidget(self.bar)
        layout.addWidget(self.buttons)
        self.setMinimumWidth(420)

    @property
    def is_writing(self) -> bool:
        """Whether a file is being written."""
        return self._task is not None

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
            if Path(path).exists() and not self._may_overwrite(path):
                return
        self.save(path)

    def _may_overwrite(self, path: str) -> bool:
        question = self.tr("%1 exists already. Replace it?").replace("%1", Path(path).name)
        answer = QMessageBox.question(self, self.windowTitle(), question)
        return answer == QMessageBox.StandardButton.Yes

    def save(self, path: str) -> None:
        """Write the mesh on a worker; the dialog stays until that is done."""
        if self._task is not None:
            return
        try:
            check_mesh_target(path)
        except Exception as error:  # noqa: BLE001 - told in the dialog's own words
            show_error(self, self.tr("The mesh was not saved"), error)
            return
        mesh = self._summary.polydata
        self._show_writing(True)
        self._task = self._workers.start(
            lambda task: save_mesh(
                mesh, path, progress=task.report, cancel=lambda: task.is_cancelled
            ),
            label=self.tr("Writing %1").replace("%1", Path(path).name),
        )  # fmt: skip
        self._task.progressed.connect(lambda fraction, _text: self.bar.show_fraction(fraction))
        self._task.succeeded.connect(lambda note: self._on_saved(path, note))
        self._task.failed.connect(self._on_failed)

    def _show_writing(self, on: bool) -> None:
        self.bar.setVisible(on)
        self.bar.show_fraction(0.0)
        self.save_button.setEnabled(not on)
        self.format.setEnabled(not on)

    def _on_saved(self, path: str, note: str) -> None:
        self._task = None
        if note:
            QMessageBox.information(self, self.windowTitle(), note)
        self.saved.emit(path)
        self.accept()

    def _on_failed(self, error: BaseException) -> None:
        self._task = None
        self._show_writing(False)
        show_error(self, self.tr("The mesh was not saved"), error)

    def reject(self) -> None:
        """Stop writing when that is under way, else close."""
        if self._task is not None:
            self._task.cancel()
            self._task = None
            self._show_writing(False)
            return
        super().reject()
