"""The dock that compares our isosurface with VTK's: metrics side by side, every difference explained."""

from __future__ import annotations

import json
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QCoreApplication, Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QDoubleSpinBox,
    QFileDialog,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSplitter,
    QTableWidget,
    QTableWidgetItem,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from volviz.custom_gl.scene_techniques import current_settings, current_technique
from volviz.model.auto_isovalue import auto_isovalue
from volviz.model.parameters import setting_values
from volviz.volume_data.volume import Volume
from volviz_ui.dialogs.error import show_error
from volviz_ui.editors.simple import NoWheelComboBox
from volviz_ui.session.documents import Documents
from volviz_ui.session.loaded_scene import LoadedScene, volume_of
from volviz_ui.session.workers import Task, Workers
from volviz_ui.widgets.binding import show_value
from volviz_ui.widgets.progress_bar import ProgressBar
from volviz_ui.widgets.small import quiet_label

if TYPE_CHECKING:
    from volviz.compare.crosscheck import CrosscheckReport

WORK = "crosscheck"
METHODS = ("lorensen", "topological", "tetrahedra")


class CrosscheckPanel(QWidget):
    """Runs the cross-check on a worker and shows its report.

    Parameters
    ----------
    documents : Documents
        What is compared: isovalue and method are those of the technique where it has them.
    workers : Workers
        Where the work is done.
    """

    def __init__(self, documents: Documents, workers: Workers, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._documents = documents
        self._workers = workers
        self._task: Task | None = None
        self.report: CrosscheckReport | None = None
        self._make_controls()
        self.table = QTableWidget(self)
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.table.setSelectionMode(QAbstractItemView.SelectionMode.ContiguousSelection)
        self.table.setToolTip(self.tr("Figures of the cleaned meshes, and the times of all"))
        self.table.setAccessibleName(self.tr("Figures of the meshes"))
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.words = QTextBrowser(self)
        self.words.setAccessibleName(self.tr("What the cross-check found"))
        self.words.setToolTip(self.tr("What differs, and why"))
        both = QSplitter(Qt.Orientation.Horizontal, self)
        both.addWidget(self.table)
        both.addWidget(self.words)
        both.setStretchFactor(0, 3)
        both.setStretchFactor(1, 2)
        both.setChildrenCollapsible(False)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(12, 8, 12, 8)
        layout.setSpacing(8)
        layout.addLayout(self._line)
        layout.addWidget(both, 1)
        show_value(documents, volume_of, self._forget)
        show_value(documents, _shown_surface, self._show_choice)

    def _make_controls(self) -> None:
        self.isovalue = QDoubleSpinBox(self)
        self.isovalue.setRange(-1e12, 1e12)
        self.isovalue.setDecimals(4)
        self.isovalue.setStepType(QDoubleSpinBox.StepType.AdaptiveDecimalStepType)
        self.isovalue.setMinimumWidth(110)
        self.isovalue.setToolTip(self.tr("Value of the surface, in data units; follows the technique's"))
        self.isovalue.setAccessibleName(self.tr("Isovalue"))
        self.method = NoWheelComboBox(self)
        self.method.setToolTip(self.tr("Our method; VTK has the first one only"))
        self.method.setAccessibleName(self.tr("Method"))
        for name in METHODS:
            self.method.addItem(name.capitalize(), name)
        self.run = QPushButton(self.tr("Compare with VTK"), self)
        self.run.setToolTip(self.tr("Extract by us, vtkMarchingCubes and vtkFlyingEdges3D, and compare"))
        self.run.clicked.connect(self.start)
        self.bar = ProgressBar(self)
        self.bar.setFixedWidth(120)
        self.bar.setAccessibleName(self.tr("Progress of the cross-check"))
        self.bar.setToolTip(self.tr("How far the cross-check is"))
        self.stop = QPushButton(self.tr("Cancel"), self)
        self.stop.setToolTip(self.tr("Give the cross-check up at its next step"))
        self.stop.clicked.connect(self.cancel)
        self.copy = QPushButton(self.tr("Copy"), self)
        self.copy.setToolTip(self.tr("Put the report on the clipboard as text"))
        self.copy.clicked.connect(self.copy_text)
        self.save = QPushButton(self.tr("Save…"), self)
        self.save.setToolTip(self.tr("Write the report to a file, as text or JSON"))
        self.save.clicked.connect(self.ask_where)
        self.state: QLabel = quiet_label("", self)
        self._line = QHBoxLayout()
        self._line.setSpacing(8)
        for label, field in ((self.tr("Isovalue"), self.isovalue), (self.tr("Method"), self.method)):
            words = QLabel(label, self)
            words.setBuddy(field)
            words.setToolTip(field.toolTip())
            self._line.addWidget(words)
            self._line.addWidget(field)
        for widget in (self.run, self.bar, self.stop):
            self._line.addWidget(widget)
        self._line.addWidget(self.state, 1)
        self._line.addWidget(self.copy)
        self._line.addWidget(self.save)

    # ------------------------------------------------------------------ what is compared

    def _forget(self, _volume: Volume | None) -> None:
        """The report is that of another volume."""
        self.cancel()
        self._show_report(None)
        self._show_running(False)
        self._show_choice(_shown_surface(self._documents.shown))

    def _show_choice(self, surface: tuple[float | None, str]) -> None:
        isovalue, method = surface
        if isovalue is not None:
            self.isovalue.setValue(isovalue)
        self.method.setCurrentIndex(self.method.findData(method))

    # ------------------------------------------------------------------ the work

    @property
    def is_running(self) -> bool:
        """Whether a comparison is under way."""
        return self._task is not None

    def start(self) -> None:
        """Compare, on a worker."""
        volume = self._documents.volume
        if volume is None or self._task is not None:
            return
        isovalue, method = self.isovalue.value(), str(self.method.currentData())

        def work(task: Task) -> Any:
            from volviz.compare.crosscheck import crosscheck

            return crosscheck(
                volume, isovalue, method, progress=task.report, cancel=lambda: task.is_cancelled
            )

        self._task = self._workers.start(work, label=self.tr("Cross-check"), key=WORK)
        self._task.progressed.connect(self._on_progressed)
        self._task.succeeded.connect(self._on_succeeded)
        self._task.failed.connect(self._on_failed)
        self._show_running(True)

    def cancel(self) -> None:
        """Give the comparison up; the last report stays."""
        if self._task is not None:
            self._task.cancel()
            self._task = None
            self._show_running(False)

    def _on_progressed(self, fraction: float, _text: str) -> None:
        self.bar.show_fraction(fraction)

    def _on_succeeded(self, report: CrosscheckReport) -> None:
        self._task = None
        self._show_running(False)
        self._show_report(report)

    def _on_failed(self, error: BaseException) -> None:
        self._task = None
        self._show_running(False)
        show_error(self, self.tr("The meshes were not compared"), error)

    def _show_running(self, on: bool) -> None:
        self.bar.setVisible(on)
        self.bar.show_fraction(0.0)
        self.stop.setVisible(on)
        self.run.setEnabled(not on and self._documents.volume is not None)

    # ------------------------------------------------------------------ the report

    def _show_report(self, report: CrosscheckReport | None) -> None:
        self.report = report
        for button in (self.copy, self.save):
            button.setEnabled(report is not None)
        self.table.clear()
        if report is None:
            self.table.setRowCount(0)
            self.table.setColumnCount(0)
            self.state.setText("")
            what = self.tr(
                "Compares our mesh with those of VTK: vertices, triangles, topology, distance, time. Every difference "
                "is explained by the case of its cells."
            )
            self.words.setHtml(f"<p>{escape(what)}</p>")
            return
        self.state.setText(
            self.tr("%1, isovalue %2, %3")
            .replace("%1", report.volume_name)
            .replace("%2", f"{report.isovalue:g}")
            .replace("%3", report.method)
        )
        columns = [title for title, _metrics in report.columns()]
        rows = table_rows(report)
        self.table.setColumnCount(len(columns))
        self.table.setRowCount(len(rows))
        self.table.setHorizontalHeaderLabels([title.replace(", ", ",\n") for title in columns])
        self.table.setVerticalHeaderLabels([label for label, _cells in rows])
        for y, (_label, cells) in enumerate(rows):
            for x, text in enumerate(cells):
                item = QTableWidgetItem(text)
                item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                self.table.setItem(y, x, item)
        self.words.setHtml(explanation(report))

    def copy_text(self) -> None:
        """Put the report on the clipboard."""
        if self.report is not None:
            QApplication.clipboard().setText(self.report.format())

    def ask_where(self) -> None:
        """Ask for a file and write the report."""
        path, _filter = QFileDialog.getSaveFileName(
            self, self.tr("Save the report"), "crosscheck.json", "JSON (*.json);;Text (*.txt)"
        )
        if path:
            self.save_report(path)

    def save_report(self, path: str) -> None:
        """Write the report: text to a file that ends in .txt, JSON to any other."""
        if self.report is None:
            return
        as_text = path.lower().endswith(".txt")
        text = self.report.format() if as_text else json.dumps(self.report.to_dict(), indent=1)
        try:
            Path(path).write_text(text, encoding="utf-8")
        except OSError as error:
            show_error(self, self.tr("The report was not saved"), error)


def _shown_surface(shown: LoadedScene) -> tuple[float | None, str]:
    """Isovalue (None without a volume) and method of the surface that the technique shows."""
    info, values = current_technique(shown.scene), setting_values(current_settings(shown.scene))
    value = values.get(info.isovalue_setting)
    if value is None and shown.volume is not None:
        value = auto_isovalue(shown.volume)
    own = info.extraction if info.kind == "image" else ""
    return value[0] if isinstance(value, tuple) else value, str(values.get("method", own)) or "lorensen"


def table_rows(report: CrosscheckReport) -> list[tuple[str, list[str]]]:
    """Label and cells of each line of the table."""
    metrics = [each for _title, each in report.columns()]
    tr = partial(QCoreApplication.translate, "CrosscheckPanel")
    rows = [
        (label, [format(getattr(each, name), style) for each in metrics])
        for label, name, style in (
            (tr("Vertices"), "vertices", ",d"),
            (tr("Triangles, cleaned"), "faces", ",d"),
            (tr("Area"), "area", ",.6g"),
            (tr("Volume"), "volume", ",.6g"),
            (tr("Euler characteristic"), "euler_characteristic", "d"),
            (tr("Boundary edges"), "boundary_edges", ",d"),
            (tr("Non-manifold edges"), "non_manifold_edges", ",d"),
            (tr("Parts"), "components", ",d"),
        )
    ]
    distances = [
        "–" if each.distance is None else f"{each.distance.hausdorff:.3g}" for each in report.comparisons
    ]
    rows.append((tr("Hausdorff distance to ours"), ["–", *distances, distances[-1]]))
    own = report.seconds["ours"]
    times = [report.seconds[title] for title, _metrics in report.columns()]
    rows.append((tr("Time, normals included"), [f"{1000 * t:.1f} ms" for t in times]))
    rows.append((tr("Time, ours = 1"), [f"{t / own:.2f}" for t in times]))
    return rows


def explanation(report: CrosscheckReport) -> str:
    """What there is to say, as HTML."""
    parts = [f"<p><b>{escape(report.verdict)}</b></p>"]
    for name, sentences in report.explanations():
        items = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
        parts.append(f"<p>{escape(name)}</p><ul style='margin-left: -24px'>{items}</ul>")
    return "".join(parts)
