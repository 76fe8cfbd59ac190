"""A command of ``volviz`` in a process of its own: the window stays alive, and cancelling is certain."""

from __future__ import annotations

import sys
from pathlib import Path

from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, Signal

from volviz.commands.progress import LINES, PROGRESS

END_MS = 3000


class CommandProcess(QObject):
    """Runs one command at a time."""

    progressed = Signal(float, str)
    finished = Signal()
    failed = Signal(str)
    """One sentence."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._process: QProcess | None = None
        self._errors = ""
        self._unread = ""

    @property
    def is_running(self) -> bool:
        """Whether a command is under way."""
        return self._process is not None

    def start(self, arguments: list[str], folder: Path) -> None:
        """Run ``volviz`` with these arguments in a folder."""
        self.cancel()
        process = QProcess(self)
        self._process, self._errors, self._unread = process, "", ""
        environment = QProcessEnvironment.systemEnvironment()
        environment.insert(PROGRESS, LINES)
        process.setProcessEnvironment(environment)
        process.setWorkingDirectory(str(folder))
        process.readyReadStandardError.connect(self._read)
        process.finished.connect(self._on_finished)
        process.errorOccurred.connect(self._on_error)
        process.start(sys.executable, ["-m", "volviz", *arguments])

    def cancel(self) -> None:
        """End it at once; nothing more is told of it."""
        process, self._process = self._process, None
        if process is not None:
            process.blockSignals(True)
            process.kill()
            process.waitForFinished(END_MS)
            process.deleteLater()

    def _read(self) -> None:
        if self._process is None:
            return
        self._unread += bytes(self._process.readAllStandardError().data()).decode(errors="replace")
        *lines, self._unread = self._unread.split("\n")
        for line in lines:
            fraction, _space, words = line.partition(" ")
            try:
                self.progressed.emit(float(fraction), words)
            except ValueError:
                self._errors = line or self._errors

    def _on_finished(self, code: int, status: QProcess.ExitStatus) -> None:
        self._read()
        process, self._process = self._process, None
        if process is not None:
            process.deleteLater()
        if code == 0 and status == QProcess.ExitStatus.NormalExit:
            self.finished.emit()
        else:
            said = (self._unread.strip() or self._errors).removeprefix("volviz: ")
            self.failed.emit(said or self.tr("The work ended without saying why."))

    def _on_error(self, error: QProcess.ProcessError) -> None:
        if error == QProcess.ProcessError.FailedToStart and self._process is not None:
            process, self._process = self._process, None
            process.deleteLater()
            self.failed.emit(self.tr("The work could not be started."))
