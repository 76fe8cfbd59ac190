"""Reports and convergence for the window: what is shown goes to ``volviz compare``, the answer comes back."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QTemporaryDir, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog

from volviz.errors import VolvizError
from volviz.model.scene import Scene
from volviz.model.transfer.formats import write_transfer_function
from volviz_ui.app_context import AppContext
from volviz_ui.compare.command_line import compare_arguments, function_name
from volviz_ui.compare.convergence_plot import Curve
from volviz_ui.session.command_process import CommandProcess

KINDS = "HTML (*.html);;JSON (*.json);;CSV (*.csv)"
CONVERGENCE_SIZE = (240, 180)
"""Images from which orders of convergence are fitted."""


class Reports(QObject):
    """Runs one comparison at a time in a process of its own; its button ends it again."""

    work_changed = Signal(object, str)
    """How far the work is, 0..1, and what is being done; None when nothing is."""
    written = Signal(str)
    """Name of the report that was written."""
    convergence_found = Signal(list, list)
    """A `Curve` of each view that has one, and a sentence on each that has none."""

    def __init__(self, context: AppContext) -> None:
        super().__init__(context.window)
        self._context = context
        self._report: Path | None = None
        self._folder: QTemporaryDir | None = None
        self.process = CommandProcess(self)
        self.process.progressed.connect(self.work_changed.emit)
        self.process.finished.connect(self._on_finished)
        self.process.failed.connect(self._on_failed)

    @property
    def is_running(self) -> bool:
        """Whether a report is being written, or convergence is being measured."""
        return self.process.is_running

    # ------------------------------------------------------------------ beginning

    def write_report(self) -> None:
        """Ask for a file and write the report of all views."""
        if not self._can_start():
            return
        start = str(Path(self._context.preferences.folder) / "comparison.html")
        path, _filter = QFileDialog.getSaveFileName(
            self._context.window, self.tr("Write a report of the comparison"), start, KINDS
        )
        if path:
            target = Path(path)
            self.save(target if target.suffix else target.with_suffix(".html"))

    def save(self, path: Path) -> bool:
        """Write the report of all views to a file, with the transfer function beside it."""
        self._report, self._folder = path, None
        return self._start(path, self._context.views.first.viewport.pixel_size, ())

    def converge(self) -> None:
        """Draw all views at several steps or bisections, and fit how their errors fall."""
        if not self._can_start():
            return
        folder = QTemporaryDir()
        self._report, self._folder = None, folder
        output = Path(folder.path()) / "convergence.json"
        self._start(output, CONVERGENCE_SIZE, ("--convergence", "--frames=0"))

    def _can_start(self) -> bool:
        scene = self._context.store.scene
        return not self.is_running and scene.layer is not None and len(scene.views) > 1

    def _start(self, output: Path, size: tuple[int, int], options: tuple[str, ...]) -> bool:
        scene: Scene = self._context.store.scene
        if scene.layer is None or scene.view.camera is None or len(scene.views) < 2:
            return False
        name = function_name(output)
        try:
            write_transfer_function(scene.layer.transfer_function, output.parent / name)
        except VolvizError as error:
            self._context.messages.show_error(self.tr("The report was not written"), error)
            return False
        self.work_changed.emit(0.0, "")
        self.process.start(compare_arguments(scene, size, name, output.name, options), output.parent)
        return True

    # ------------------------------------------------------------------ ending

    def cancel(self) -> None:
        """Give up what is under way; a report that is not finished leaves nothing behind."""
        self.process.cancel()
        self._drop()
        self.work_changed.emit(None, "")

    def _on_finished(self) -> None:
        folder, self._folder = self._folder, None
        self.work_changed.emit(None, "")
        if folder is None and self._report is not None:
            self.written.emit(self._report.name)
            return
        if folder is not None:
            text = (Path(folder.path()) / "convergence.json").read_text(encoding="utf-8")
            report = json.loads(text)
            self.convergence_found.emit(curves_of(report), report["without_curve"])

    def _on_failed(self, words: str) -> None:
        converging = self._folder is not None
        self._drop()
        self.work_changed.emit(None, "")
        title = (
            self.tr("Convergence was not measured") if converging else self.tr("The report was not written")
        )
        self._context.messages.show_error(title, VolvizError(words))

    def open_report(self) -> None:
        """Show the report in the browser."""
        if self._report is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._report.absolute())))

    def close(self) -> None:
        """The window closes."""
        if self.is_running:
            self.process.cancel()
            self._drop()

    def _drop(self) -> None:
        """Take away what was written for a comparison that has not been finished."""
        if self._folder is None and self._report is not None:
            (self._report.parent / function_name(self._report)).unlink(missing_ok=True)
        self._folder = self._report = None


def curves_of(report: dict[str, Any]) -> list[Curve]:
    """The convergence of a report (`volviz.compare.results`, as JSON) as curves; missing numbers are NaN."""
    return [
        Curve(
            str(row["name"]),
            tuple(float(d) for d in row["distances"]),
            tuple(float(e) for e in row["errors"]),
            math.nan if row["fitted"][0] is None else float(row["fitted"][0]),
            math.nan if row["slope"] is None else float(row["slope"]),
            float(row["finest"]),
            str(row["unit"]),
        )
        for row in report["convergence"]
    ]
