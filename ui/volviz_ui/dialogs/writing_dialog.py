"""What dialogs share that ask for a file and write it on a worker: progress, cancel, overwriting, errors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QMessageBox,
    QWidget,
)

from volviz_ui.dialogs.error import show_error
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.dialog_layout import lay_out
from volviz_ui.widgets.progress_bar import ProgressBar


class WritingDialog(QDialog):
    """Asks for a file, writes, and closes when that is done; Cancel stops the writing.

    Those that follow it fill `form`, choose the file in `ask_where`, and hand the work to `write`.

    Parameters
    ----------
    workers : Workers
        Who writes.
    title : str
        Of the dialog.
    failure : str
        What is told when nothing was written.
    """

    saved = Signal(str)
    """Path of the file that was written."""

    def __init__(self, workers: Workers, title: str, failure: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self._workers = workers
        self._failure = failure
        self._task: Task | None = None
        self.form = QFormLayout()
        self.form.setHorizontalSpacing(16)
        self.form.setVerticalSpacing(8)
        self.choices: list[QComboBox] = []
        self.format = self.add_choice(self.tr("Format"), self.tr("Which kind of file"))
        self.form.addRow(self.tr("Format"), self.format)
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

    def add_choice(self, name: str, tooltip: str) -> QComboBox:
        """A list that cannot be changed while a file is written."""
        choice = NoWheelComboBox(self)
        choice.setAccessibleName(name)
        choice.setToolTip(tooltip)
        self.choices.append(choice)
        return choice

    def lay_out(self, words: QLabel, width: int) -> None:
        """Form, words, progress and buttons, one below the other."""
        words.setWordWrap(True)
        lay_out(self, self.form, words, self.bar, self.buttons)
        self.setMinimumWidth(width)

    @property
    def is_writing(self) -> bool:
        """Whether a file is being written."""
        return self._task is not None

    def ask_where(self) -> None:
        """Ask for the file, then write it."""
        raise NotImplementedError

    def may_overwrite(self, path: str) -> bool:
        """Ask whether a file that is there may go."""
        question = self.tr("%1 exists already. Replace it?").replace("%1", Path(path).name)
        return QMessageBox.question(self, self.windowTitle(), question) == QMessageBox.StandardButton.Yes

    def write(self, path: str, work: Callable[[Task], Any], told: Callable[[Any], str]) -> None:
        """Have a file written; the dialog stays until that is done.

        Parameters
        ----------
        path : str
            The file.
        work : callable
            Runs on the worker.
        told : callable
            From what the work gives to a sentence for the user, empty for none.
        """
        self._show_writing(True)
        self._task = self._workers.start(work, label=self.tr("Writing %1").replace("%1", Path(path).name))
        self._task.progressed.connect(lambda fraction, _text: self.bar.show_fraction(fraction))
        self._task.succeeded.connect(lambda result: self._on_saved(path, told(result)))
        self._task.failed.connect(self._on_failed)

    def show_failure(self, error: BaseException) -> None:
        """Tell why nothing was written."""
        show_error(self, self._failure, error)

    def _show_writing(self, on: bool) -> None:
        self.bar.setVisible(on)
        self.bar.show_fraction(0.0)
        self.save_button.setEnabled(not on)
        for choice in self.choices:
            choice.setEnabled(not on)

    def _on_saved(self, path: str, note: str) -> None:
        self._task = None
        if note:
            QMessageBox.information(self, self.windowTitle(), note)
        self.saved.emit(path)
        self.accept()

    def _on_failed(self, error: BaseException) -> None:
        self._task = None
        self._show_writing(False)
        self.show_failure(error)

    def reject(self) -> None:
        """Stop writing when that is under way, else close."""
        if self._task is not None:
            self._task.cancel()
            self._task = None
            self._show_writing(False)
            return
        super().reject()
